//! `hc mixed-volume`.

use crate::{input, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::Run;
use hc::poly::{Polynomial, counted};
use hc::ranks::Ranks;
use hc::start::MixedError;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// The mixed volume of a system: how many solutions without zero coordinates it has for generic
/// coefficients.
///
/// Interrupted, it gives the volume of the cells found so far, marked as partial, with exit
/// status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system: plain text with one equation a line, PHCpack's format, or TOML; - for standard
    /// input.
    file: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Accepted everywhere; mixed volumes draw no random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    #[command(flatten)]
    pub(crate) ranks: mpirun::Sharing,
}

#[derive(Serialize)]
struct Output {
    /// Where partial: a lower bound.
    mixed_volume: u64,
    cells: u64,
    seed: u64,
    seconds: f64,
    partial: bool,
}

/// Searches, with the other ranks if there are any; rank 0 alone prints, and writes files.
pub(crate) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let files = Files::new().reads(Some(&arguments.file)).writes("--json", arguments.json.as_deref());
    input::check(&files, ranks)?;
    let system = input::system(&arguments.file)?;
    let polynomials = system.expand(&Default::default()).map_err(|error| Failure::in_file(&arguments.file, error))?;
    let supports: Vec<Vec<Vec<i32>>> = polynomials.iter().map(Polynomial::support).collect();
    let unknowns = system.variables().len();
    let start = Instant::now();
    let monitor = watch::interruptible()?;
    let run = Run::new().watched(&monitor).on_ranks(ranks);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || run.mixed_volume(unknowns, &supports))?;
    let (mixed_volume, cells, partial) = match found {
        Ok(Some(found)) => (found.volume, found.cells as u64, false),
        // Rank 0 has the volume.
        Ok(None) => return Ok(()),
        Err(MixedError::Cancelled) => {
            let so_far = monitor.progress();
            (so_far.counted, so_far.done, true)
        }
        Err(MixedError::Ranks(error)) => return Err(Failure::unusable(error)),
        Err(error) => return Err(Failure::in_file(&arguments.file, error)),
    };
    let seconds = start.elapsed().as_secs_f64();
    output::summary(arguments.json.as_deref(), || {
        let least = if partial { "partial result: at least " } else { "" };
        format!("{least}mixed volume {mixed_volume}, {}, {seconds:.3} s\n", counted(cells, "mixed cell"))
    })?;
    if let Some(out) = &arguments.json {
        output::json(out, &Output { mixed_volume, cells, seed: arguments.seed, seconds, partial })?;
    }
    if partial { Err(Failure::Interrupted) } else { Ok(()) }
}
