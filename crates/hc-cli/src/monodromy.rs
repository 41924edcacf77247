//! `hc monodromy`.

use crate::family::Problem;
use cli::{Failure, output};
use hc::monodromy::{MonodromyOptions, Stop, monodromy};
use hc::pair::find_pair;
use hc::start_file::StartFile;
use hc::trace::trace_test;
use std::path::PathBuf;

/// Finds all solutions of a family for one generic parameter point, from a single one.
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
    /// File for the fibre (JSON); - for standard output.
    #[arg(long)]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let problem = Problem::read(&arguments.family)?;
    let accept = |p: &[num_complex::Complex64], x: &[num_complex::Complex64]| problem.accepts(p, x);
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
    let found = monodromy(&problem.system, &start, accept, &options);
    let count = found.fibre.len();
    let mut stopped = match found.stop {
        Stop::RootsReached => "roots reached",
        _ => "no progress",
    };
    let mut deviation = None;
    if !arguments.no_trace && stopped != "roots reached" {
        let test = trace_test(&problem.family.system, &found.fibre, &options)
            .map_err(|e| Failure::in_file(&arguments.family, e))?;
        deviation = Some(test.deviation);
        if test.passed(count) {
            stopped = "trace";
        }
    }
    let text = StartFile::new(&found.fibre, deviation, stopped).to_json();
    match arguments.output.to_str() {
        Some("-") => output::print(&text)?,
        _ => output::write(&arguments.output, text.as_bytes())?,
    }
    let trace = deviation.map_or(String::new(), |d| format!(", trace test {d:.1e}"));
    eprintln!(
        "{}: {count} solutions after {} loops and {} paths; stopped: {stopped}{trace}",
        problem.family.name, found.loops, found.paths
    );
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
