//! `hc mixed-volume`.

use crate::input;
use hc::poly::Polynomial;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The mixed volume of a system: how many solutions without zero coordinates it has for generic coefficients.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system, in PHCpack's format.
    file: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
}

#[derive(Serialize)]
struct Output {
    mixed_volume: u64,
    cells: usize,
    seconds: f64,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), String> {
    let (system, polynomials) = input::system(&arguments.file)?;
    let supports: Vec<Vec<Vec<i32>>> = polynomials.iter().map(Polynomial::support).collect();
    let unknowns = system.variables().len();
    let start = Instant::now();
    let found = input::on_threads(arguments.threads, || hc::start::mixed_volume(unknowns, &supports))?
        .map_err(|e| format!("{}: {e}", arguments.file.display()))?;
    let seconds = start.elapsed().as_secs_f64();
    let output = Output { mixed_volume: found.volume, cells: found.cells, seconds };
    if arguments.json.as_deref() != Some(Path::new("-")) {
        println!("mixed volume {}, {} mixed cells, {seconds:.3} s", output.mixed_volume, output.cells);
    }
    arguments.json.as_deref().map_or(Ok(()), |out| input::write_json(out, &output))
}
