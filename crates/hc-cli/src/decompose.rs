//! `hc decompose`.

use crate::report::Report;
use crate::{input, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::{Run, SolveOptions};
use std::path::PathBuf;
use std::time::Instant;

/// All solutions of a system, isolated ones and components of positive dimension with their degrees,
/// multiplicities and witness points.
///
/// Ten points of a component are shown; --json has all. Exit status 1 if something may be missing.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system: plain text with one equation a line, PHCpack's format, or TOML; - for standard
    /// input.
    file: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Paths at most in all dimensions together; those that need more are not searched.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    max_paths: u64,
    /// Seed of the hyperplanes and of the generic coefficients.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    Files::new().reads(Some(&arguments.file)).writes("--json", arguments.json.as_deref()).check()?;
    let begun = Instant::now();
    let system = input::system(&arguments.file)?;
    let monitor = watch::interruptible()?;
    let options = SolveOptions::new().seed(arguments.seed).max_paths(arguments.max_paths);
    let run = Run::new().watched(&monitor);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || run.decompose(&system, &options))?;
    let found = found.map_err(|error| Failure::in_file(&arguments.file, error))?;
    let seconds = begun.elapsed().as_secs_f64();
    output::summary(arguments.json.as_deref(), || format!("{found}{seconds:.3} s\n"))?;
    if let Some(out) = &arguments.json {
        output::json(out, &Report { variables: &found.variables, seed: arguments.seed, seconds, found: &found })?;
    }
    if found.partial {
        return Err(Failure::Interrupted);
    }
    if found.failed > 0 {
        return Err(Failure::Undetermined(format!(
            "something may be missing; paths, witness points and dimensions that are not accounted for: {}",
            found.failed
        )));
    }
    if found.components.iter().any(|c| !c.irreducible) {
        return Err(Failure::Undetermined("some components are not shown to be irreducible".to_owned()));
    }
    Ok(())
}
