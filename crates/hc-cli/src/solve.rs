//! `hc solve`.

use crate::input;
use hc::solve::{Solution, SolveOptions, solve};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// All isolated regular solutions of a square system, by polyhedral homotopy.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system, in PHCpack's format.
    file: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Seed of the generic coefficients.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Leave out solutions with zero coordinates.
    #[arg(long)]
    torus_only: bool,
}

#[derive(Serialize)]
struct Output<'a> {
    variables: &'a [String],
    mixed_volume: u64,
    seed: u64,
    seconds: f64,
    paths: hc::fibre::PathCounts,
    singular_ends: usize,
    solutions: Vec<Entry<'a>>,
}

/// A regular solution: its multiplicity and winding number are one.
#[derive(Serialize)]
struct Entry<'a> {
    #[serde(flatten)]
    solution: &'a Solution,
    multiplicity: u32,
    winding_number: u32,
    singular: bool,
    /// Certification was not asked for.
    certified: Option<bool>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<bool, String> {
    let start = Instant::now();
    let (system, polynomials) = input::system(&arguments.file)?;
    let mut options = SolveOptions::default();
    options.seed = arguments.seed;
    options.torus_only = arguments.torus_only;
    let found = input::on_threads(arguments.threads, || solve(&polynomials, &options))?
        .map_err(|e| format!("{}: {e}", arguments.file.display()))?;
    let entry = |solution| Entry { solution, multiplicity: 1, winding_number: 1, singular: false, certified: None };
    let output = Output {
        variables: system.variables(),
        mixed_volume: found.mixed_volume,
        seed: arguments.seed,
        seconds: start.elapsed().as_secs_f64(),
        paths: found.paths,
        singular_ends: found.singular_ends,
        solutions: found.solutions.iter().map(entry).collect(),
    };
    if arguments.json.as_deref() != Some(Path::new("-")) {
        let paths = &output.paths;
        let real = found.solutions.iter().filter(|s| s.real).count();
        println!("{} regular solutions, {real} real, {:.3} s", found.solutions.len(), output.seconds);
        println!(
            "{} paths: {} finite, {} at infinity, {} failed ({} of them end at singular points), {} tracked again",
            paths.tracked, paths.finite, paths.at_infinity, paths.failed, output.singular_ends, paths.retracked
        );
        if paths.failed > 0 {
            println!("the list may be incomplete: {} paths did not end at regular solutions or infinity", paths.failed);
        }
    }
    if let Some(out) = &arguments.json {
        input::write_json(out, &output)?;
    }
    // A list that may not be whole is not presented as a success.
    Ok(!found.solutions.is_empty() && found.paths.failed == 0)
}
