//! `hc monodromy`.

use crate::checkpoint::{self, Recording};
use crate::{family, input, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::family::Stopped;
use hc::poly::counted;
use hc::ranks::Ranks;
use hc::{FamilyError, MonodromyOptions, Run};
use std::path::PathBuf;

/// Finds all solutions of a family for one generic parameter point, from a single one.
///
/// Interrupted, it writes the solutions found so far, with "stopped": "interrupted" and exit
/// status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family: plain text with a line `parameters: a b` and one equation a line, or TOML; - for
    /// standard input.
    #[arg(required_unless_present = "status")]
    family: Option<PathBuf>,
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
    #[arg(long, required_unless_present = "status")]
    output: Option<PathBuf>,
    #[command(flatten)]
    checkpoint: Recording,
    #[command(flatten)]
    pub(crate) ranks: mpirun::Sharing,
}

/// Searches, with the other ranks if there are any; rank 0 alone prints, and writes files.
pub(crate) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let is_lead = ranks.is_none_or(Ranks::is_lead);
    if let Some(directory) = arguments.checkpoint.status() {
        return if is_lead { checkpoint::status(directory) } else { Ok(()) };
    }
    let output = Recording::needed(&arguments.output, "the fibre (--output)")?;
    let files = Files::new().reads(arguments.family.as_deref()).reads(arguments.seed_pair.as_deref());
    input::check(&files.writes("--output", Some(output)), ranks)?;
    let path = Recording::needed(&arguments.family, "a family")?;
    let family = family::read(path)?;
    let start = match &arguments.seed_pair {
        Some(path) => family::fibre(&family, path)?,
        None => family.find_pair(arguments.seed).map_err(|error| match error {
            FamilyError::NoPair => Failure::Undetermined(format!("{error} with --seed-pair")),
            error => Failure::in_file(path, error),
        })?,
    };
    let options = MonodromyOptions::new().seed(arguments.seed).trace_test(!arguments.no_trace);
    let monitor = watch::interruptible()?;
    let checkpoint = if is_lead { arguments.checkpoint.open()? } else { None };
    let run = Run::new().watched(&monitor).recorded(checkpoint.as_ref()).on_ranks(ranks);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || run.complete(&family, &start, &options))?;
    // Rank 0 has the fibre.
    let Some(found) = found.map_err(|error| family::failure(path, error))? else { return Ok(()) };
    let (count, file) = (found.fibre.len(), found.start_file());
    output::text(output, &file.to_json())?;
    let trace = match (found.trace, file.trace_test) {
        (_, Some(deviation)) => format!(", trace test {deviation:.1e}"),
        (Some(_), None) => ", trace test without a result (paths were lost, or led to other solutions)".to_owned(),
        (None, None) => String::new(),
    };
    let stopped = &file.stopped;
    let name = if family.name().is_empty() { input::name(path) } else { family.name().to_owned() };
    eprintln!(
        "{name}: {} after {} and {}; stopped: {stopped}{trace}",
        counted(count, "solution"),
        counted(found.loops, "loop"),
        counted(found.paths, "path")
    );
    if found.stopped == Stopped::Cancelled {
        return Err(arguments.checkpoint.interrupted());
    }
    match family.roots() {
        Some(roots) if roots != count => {
            Err(Failure::Undetermined(format!("{} found, the family states {roots}", counted(count, "solution"))))
        }
        None if !found.stopped.is_complete() => Err(Failure::Undetermined(
            "neither a known number of roots nor the trace test shows that these are all".to_string(),
        )),
        _ => Ok(()),
    }
}
