//! `hc monodromy`.

use crate::family::Problem;
use crate::watch;
use cli::{Failure, output};
use hc::monodromy::{MonodromyOptions, Stop, monodromy};
use hc::pair::find_pair;
use hc::start_file::StartFile;
use hc::trace::trace_test;
use std::path::PathBuf;

/// Finds all solutions of a family for one generic parameter point, from a single one.
///
/// Interrupted, it writes the solutions found so far, with "stopped": "interrupted" and exit status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family (TOML).
    family: PathBuf,
    /// A first pair (JSON with "parameters" and one entry in "solutions"); found by Newton's method if not given.
    #[arg(long)]
    seed_pair: Option<PathBuf>,
    /// Leaves out the trace test; without a known number of roots the result is then no more than what was found.
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
    let problem = Problem::read(&arguments.family)?;
    let accept = |p: &[num_complex::Complex64], x: &[num_complex::Complex64]| problem.compiled.accepts(p, x);
    let start = match &arguments.seed_pair {
        Some(path) => problem.fibre(path)?,
        None => find_pair(&problem.family.system, accept, arguments.seed)
            .map_err(|e| Failure::in_file(&arguments.family, e))?
            .ok_or_else(|| {
                Failure::Undetermined(
                    "no regular solution was found for any parameters; give one with --seed-pair".to_string(),
                )
            })?,
    };
    let mut options = MonodromyOptions::default();
    options.seed = arguments.seed;
    options.roots = problem.family.roots;
    let monitor = watch::interruptible()?;
    options.set_monitor(monitor.clone());
    let (found, test) = watch::watched(arguments.threads, &monitor, watch::stages, || {
        let found = monodromy(&problem.compiled.system, &start, accept, &options);
        let wanted = !arguments.no_trace && !matches!(found.stop, Stop::RootsReached | Stop::Cancelled);
        let test = wanted.then(|| trace_test(&problem.family.system, &found.fibre, &options));
        (found, test)
    })?;
    let count = found.fibre.len();
    let test = match test {
        // What an interrupted test says is no deviation.
        Some(test) if !monitor.is_cancelled() => Some(test.map_err(|e| Failure::in_file(&arguments.family, e))?),
        _ => None,
    };
    let deviation = test.as_ref().map(|test| test.deviation);
    let stopped = match found.stop {
        Stop::RootsReached => "roots reached",
        _ if monitor.is_cancelled() => "interrupted",
        _ if test.is_some_and(|test| test.passed(count)) => "trace",
        _ => "no progress",
    };
    let text = StartFile::new(&found.fibre, deviation, stopped).to_json();
    output::text(&arguments.output, &text)?;
    let trace = deviation.map_or(String::new(), |d| format!(", trace test {d:.1e}"));
    eprintln!(
        "{}: {count} solutions after {} loops and {} paths; stopped: {stopped}{trace}",
        problem.family.name, found.loops, found.paths
    );
    if stopped == "interrupted" {
        return Err(Failure::Interrupted);
    }
    match problem.family.roots {
        Some(roots) if roots != count => {
            Err(Failure::Undetermined(format!("{count} solutions were found, the family states {roots}")))
        }
        None if stopped == "no progress" => Err(Failure::Undetermined(
            "neither a known number of roots nor the trace test shows that these are all".to_string(),
        )),
        _ => Ok(()),
    }
}
