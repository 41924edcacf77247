//! `hc monodromy`.

use crate::{family, watch};
use cli::{Failure, output};
use hc::family::{StartFile, Stop};
use hc::{FamilyError, MonodromyOptions};
use std::path::PathBuf;

/// Finds all solutions of a family for one generic parameter point, from a single one.
///
/// Interrupted, it writes the solutions found so far, with "stopped": "interrupted" and exit
/// status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family (TOML).
    family: PathBuf,
    /// A first pair (JSON with "parameters" and one entry in "solutions"); found by Newton's method
    /// if not given.
    #[arg(long)]
    seed_pair: Option<PathBuf>,
    /// Leaves out the trace test; without a known number of roots the result is then no more than
    /// what was found.
    #[arg(long)]
    no_trace: bool,
    /// Seed of the loops.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// File for the fibre (JSON); - for standard output.
    #[arg(long)]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    output::check(&[("--output", Some(&arguments.output))])?;
    let path = &arguments.family;
    let family = family::read(path)?;
    let start = match &arguments.seed_pair {
        Some(path) => family::fibre(&family, path)?,
        None => family.find_pair(arguments.seed).map_err(|error| match error {
            FamilyError::NoPair => Failure::Undetermined(format!("{error} with --seed-pair")),
            error => Failure::in_file(path, error),
        })?,
    };
    let options = MonodromyOptions::new().seed(arguments.seed);
    let monitor = watch::interruptible()?;
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || {
        let found = family.complete(&start, &options, &monitor)?;
        let wanted = !arguments.no_trace && !matches!(found.stop, Stop::RootsReached | Stop::Cancelled);
        let test = wanted.then(|| family.trace_test(&found.fibre, &options, &monitor)).transpose()?;
        Ok((found, test))
    })?;
    let (found, test) = found.map_err(|error: FamilyError| Failure::in_file(path, error))?;
    // What an interrupted test says is no deviation.
    let test = test.filter(|_| !monitor.is_cancelled());
    let count = found.fibre.len();
    let deviation = test.and_then(|test| test.result(count));
    let stopped = match found.stop {
        Stop::RootsReached => "roots reached",
        _ if monitor.is_cancelled() => "interrupted",
        _ if test.is_some_and(|test| test.passed(count)) => "trace",
        _ => "no progress",
    };
    let text = StartFile::new(&found.fibre, deviation, stopped).to_json();
    output::text(&arguments.output, &text)?;
    let trace = match (test, deviation) {
        (_, Some(deviation)) => format!(", trace test {deviation:.1e}"),
        (Some(_), None) => ", trace test without a result (paths were lost, or led to other solutions)".to_owned(),
        (None, None) => String::new(),
    };
    eprintln!(
        "{}: {count} solutions after {} loops and {} paths; stopped: {stopped}{trace}",
        family.name(),
        found.loops,
        found.paths
    );
    if stopped == "interrupted" {
        return Err(Failure::Interrupted);
    }
    match family.roots() {
        Some(roots) if roots != count => {
            Err(Failure::Undetermined(format!("{count} solutions were found, the family states {roots}")))
        }
        None if stopped == "no progress" => Err(Failure::Undetermined(
            "neither a known number of roots nor the trace test shows that these are all".to_string(),
        )),
        _ => Ok(()),
    }
}
