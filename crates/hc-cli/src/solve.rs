//! `hc solve`.

use crate::checkpoint::{self, Recording};
use crate::report::Report;
use crate::{input, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::poly::counted;
use hc::ranks::Ranks;
use hc::{Run, SolveError, SolveOptions, Start};
use std::path::PathBuf;
use std::time::Instant;

/// All isolated solutions of a system, by homotopy continuation.
///
/// Interrupted, it gives the solutions found so far, marked as a partial result, with exit
/// status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system: plain text with one equation a line, PHCpack's format, or TOML; - for standard
    /// input.
    #[arg(required_unless_present = "status")]
    file: Option<PathBuf>,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Seed of the generic coefficients.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Start system: auto takes the one with the fewest paths, polyhedral unless its mixed cells
    /// cannot be computed, but tries another first that has hardly more paths and one stage less.
    #[arg(long, value_enum, default_value_t = StartChoice::Auto)]
    start: StartChoice,
    /// Groups of unknowns for the multihomogeneous start system, such as `x,y;z`: names with
    /// commas, groups with semicolons.
    #[arg(long, value_name = "GROUPS")]
    groups: Option<String>,
    /// More paths than this are refused.
    #[arg(long, default_value_t = 1 << 24)]
    max_paths: u64,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Prove that the solutions exist and are distinct, by interval arithmetic. Singular solutions
    /// cannot be certified; exit status 1 if some regular one is not.
    #[arg(long)]
    certify: bool,
    /// Leave out solutions with zero coordinates.
    #[arg(long)]
    torus_only: bool,
    #[command(flatten)]
    checkpoint: Recording,
    #[command(flatten)]
    pub(crate) ranks: mpirun::Sharing,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum StartChoice {
    Auto,
    Polyhedral,
    Multihomogeneous,
    TotalDegree,
}

impl From<StartChoice> for Start {
    fn from(choice: StartChoice) -> Start {
        match choice {
            StartChoice::Auto => Start::Auto,
            StartChoice::Polyhedral => Start::Polyhedral,
            StartChoice::Multihomogeneous => Start::Multihomogeneous,
            StartChoice::TotalDegree => Start::TotalDegree,
        }
    }
}

/// Solves, with the other ranks if there are any; rank 0 alone prints, and writes files.
pub(crate) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let is_lead = ranks.is_none_or(Ranks::is_lead);
    if let Some(directory) = arguments.checkpoint.status() {
        return if is_lead { checkpoint::status(directory) } else { Ok(()) };
    }
    let files = Files::new().reads(arguments.file.as_deref()).writes("--json", arguments.json.as_deref());
    input::check(&files, ranks)?;
    let begun = Instant::now();
    let file = Recording::needed(&arguments.file, "a system")?;
    let system = input::system(file)?;
    if arguments.certify && system.len() != system.variables().len() {
        let message = "only systems of as many equations as unknowns can be certified; leave out --certify";
        return Err(Failure::in_file(file, message));
    }
    let monitor = watch::interruptible()?;
    let options = SolveOptions::new()
        .seed(arguments.seed)
        .start(arguments.start.into())
        .groups(groups(arguments, system.variables()).map_err(|message| Failure::in_file(file, message))?)
        .max_paths(arguments.max_paths)
        .torus_only(arguments.torus_only)
        .certify(arguments.certify);
    let checkpoint = if is_lead { arguments.checkpoint.open()? } else { None };
    let run = Run::new().watched(&monitor).recorded(checkpoint.as_ref()).on_ranks(ranks);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || run.solve(&system, &options))?;
    let found = found.map_err(|error| match error {
        SolveError::Checkpoint(error) => Failure::unusable(error),
        SolveError::Ranks(error) => Failure::unusable(error),
        error => Failure::in_file(file, error),
    })?;
    // Rank 0 has the solutions.
    let Some(found) = found else { return Ok(()) };
    let seconds = begun.elapsed().as_secs_f64();
    output::summary(arguments.json.as_deref(), || format!("{found}{seconds:.3} s\n"))?;
    if let Some(out) = &arguments.json {
        output::json(out, &Report { variables: &found.variables, seed: arguments.seed, seconds, found: &found })?;
    }
    // A list that may not be whole is not presented as a success.
    if found.interrupted {
        return Err(arguments.checkpoint.interrupted());
    }
    if found.paths.failed > 0 {
        return Err(Failure::Undetermined(format!("lost: {}", counted(found.paths.failed, "path"))));
    }
    if found.uncertified() > 0 {
        return Err(Failure::Undetermined(format!(
            "not certified: {}",
            counted(found.uncertified(), "regular solution")
        )));
    }
    if found.is_empty() {
        return Err(Failure::Undetermined("no isolated solutions".to_owned()));
    }
    Ok(())
}

/// The indices of the unknowns in each of the groups that were given.
fn groups(arguments: &Arguments, variables: &[String]) -> Result<Vec<Vec<usize>>, String> {
    let Some(text) = &arguments.groups else {
        return match arguments.start {
            StartChoice::Multihomogeneous => {
                Err(format!("say which unknowns form groups, for instance --groups \"{}\"", variables.join(";")))
            }
            _ => Ok(Vec::new()),
        };
    };
    let index = |name: &str| {
        let found = variables.iter().position(|v| v == name.trim());
        found.ok_or_else(|| format!("no unknown `{}` for --groups; there are {}", name.trim(), variables.join(", ")))
    };
    text.split(';').map(|group| group.split(',').map(index).collect()).collect()
}
