//! `hc monodromy`.

use crate::checkpoint::{self, Recording};
use crate::{family, input, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::family::{MonodromyGroup, StartFile, Stopped};
use hc::poly::counted;
use hc::ranks::Ranks;
use hc::{FamilyError, Monodromy, MonodromyOptions, Run};
use std::path::PathBuf;

/// Sizes that a summary lists.
const LISTED: usize = 20;

/// Finds all solutions of a family for one generic parameter point, from a single one.
///
/// Loops in the parameters join the solutions of an orbit. Other orbits are found by a start system for the same
/// parameters, where that takes no more paths than the loops. Exit status 1 if other orbits are not excluded: neither
/// by the start system nor by a stated number of roots.
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
    /// Stays on the orbit of the first pair: finds the solutions that loops join to it, and no others.
    #[arg(long)]
    only_component: bool,
    /// Leaves out the trace test; if there is no known number of roots, and the start system is too large, the result
    /// is then no more than what was found.
    #[arg(long)]
    no_trace: bool,
    /// Loops along which all solutions are followed in the end: their permutations, and what these tell of the
    /// monodromy group, are in the JSON.
    #[arg(long, default_value_t = 0, value_name = "LOOPS")]
    group: u16,
    /// Lists one solution of each orbit under the family's `symmetry`, and says for how many each stands.
    #[arg(long, conflicts_with = "group")]
    up_to_symmetry: bool,
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
    if arguments.up_to_symmetry && family.symmetry().is_empty() {
        return Err(family::failure(path, FamilyError::NoSymmetry));
    }
    let start = match &arguments.seed_pair {
        Some(path) => family::fibre(&family, path)?.0,
        None => family.find_pair(arguments.seed).map_err(|error| match error {
            FamilyError::NoPair => Failure::Undetermined(format!("{error} with --seed-pair")),
            error => family::failure(path, error),
        })?,
    };
    let options = MonodromyOptions::new()
        .seed(arguments.seed)
        .trace_test(!arguments.no_trace)
        .only_component(arguments.only_component)
        .group(arguments.group.into());
    let monitor = watch::interruptible()?;
    let checkpoint = if is_lead { arguments.checkpoint.open()? } else { None };
    let run = Run::new().watched(&monitor).recorded(checkpoint.as_ref()).on_ranks(ranks);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || run.complete(&family, &start, &options))?;
    // Rank 0 has the fibre.
    let found = found.map_err(|error| match (error, &arguments.seed_pair) {
        (
            error
            @ (FamilyError::FirstSolution { .. } | FamilyError::FirstSingular { .. } | FamilyError::Misses { .. }),
            Some(pair),
        ) => Failure::in_file(pair, error),
        (error, _) => family::failure(path, error),
    });
    let Some(found) = found? else { return Ok(()) };
    let file = found.start_file();
    let file = if arguments.up_to_symmetry {
        family.up_to_symmetry(&file).map_err(|error| family::failure(path, error))?
    } else {
        file
    };
    output::text(output, &file.to_json())?;
    let name = if family.name().is_empty() { input::name(path) } else { family.name().to_owned() };
    eprintln!("{name}: {}", summary(&found, &file));
    eprint!("{}", family::besides(&found.multiple));
    if let Some(group) = &found.group {
        eprintln!("{}", group_in_words(group));
    }
    if found.stopped == Stopped::Cancelled {
        return Err(arguments.checkpoint.interrupted());
    }
    judged(&found, family.roots().filter(|_| !arguments.only_component))
}

/// What was found, in a line.
fn summary(found: &Monodromy, file: &StartFile) -> String {
    let (count, orbits) = (found.fibre.len(), found.orbits.len());
    let sizes: Vec<String> = found.orbits.iter().take(LISTED).map(usize::to_string).collect();
    let more = if orbits > LISTED { ", ..." } else { "" };
    let of_size = if orbits == 1 { "size" } else { "sizes" };
    let listed = match file.represents.len() {
        0 => String::new(),
        listed => format!(" ({listed} up to symmetry)"),
    };
    let trace = match (found.trace, file.trace_test) {
        (_, Some(deviation)) => format!(", trace test {deviation:.1e}"),
        (Some(_), None) => ", trace test without a result (paths were lost, or led to other solutions)".to_owned(),
        (None, None) => String::new(),
    };
    format!(
        "{}{listed} after {} and {}; {} of {of_size} {}{more}; stopped: {}{trace}; other orbits: {}",
        counted(count, "solution"),
        counted(found.loops, "loop"),
        counted(found.paths, "path"),
        if orbits == 1 { "1 orbit".to_owned() } else { format!("at most {orbits} orbits") },
        sizes.join(", "),
        found.stopped,
        match found.stopped.others() {
            "start system" => "excluded by a start system",
            "roots" => "excluded by the number of roots",
            others => others,
        }
    )
}

/// What is known of the monodromy group, in a line.
fn group_in_words(group: &MonodromyGroup) -> String {
    let has_blocks = group.blocks.iter().flatten().any(|systems| !systems.is_empty());
    let kind = match (group.symmetric, has_blocks) {
        (true, _) => "all permutations of the solutions",
        (false, true) => "at least what these generate, which permutes blocks",
        (false, false) => "at least what these generate",
    };
    format!(
        "monodromy group, from {} of {}: {} other than the identity; {kind}",
        group.whole,
        counted(group.loops, "loop"),
        counted(group.generators.len(), "permutation")
    )
}

/// An error unless it is known that nothing that was asked for is missing.
fn judged(found: &Monodromy, roots: Option<usize>) -> Result<(), Failure> {
    let count = found.fibre.len();
    match (roots, found.stopped) {
        (Some(roots), _) if roots != count => {
            Err(Failure::Undetermined(format!("{} found, the family states {roots}", counted(count, "solution"))))
        }
        (Some(_), _) | (None, Stopped::ComponentWhole) => Ok(()),
        (None, stopped) if stopped.is_complete() => Ok(()),
        (None, Stopped::OrbitsWhole) => Err(Failure::Undetermined(
            "these orbits are whole, but others are not excluded: a start system has too many paths, has lost some, or \
             does not exist; state the number of `roots`, if it is known, or ask for this orbit alone (--only-component)"
                .to_owned(),
        )),
        (None, _) => Err(Failure::Undetermined(
            "neither a known number of roots nor the trace test shows that these are all".to_owned(),
        )),
    }
}
