//! `hc track`.

use crate::checkpoint::{self, Recording};
use crate::input::{self, Number};
use crate::report::Report;
use crate::{family, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::family::TargetLimits;
use hc::poly::counted;
use hc::ranks::Ranks;
use hc::{FamilyError, Run, Solutions, SolveOptions};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Targets that a summary lists one by one, and warnings that it shows.
const LISTED: usize = 10;

/// Tracks a stored fibre of a family to one or several parameter points.
///
/// Interrupted, it gives the targets done so far, the last of them marked as partial, with exit
/// status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family: plain text with a line `parameters: a b`, or TOML; - for standard input.
    #[arg(required_unless_present = "status")]
    family: Option<PathBuf>,
    /// Its fibre, as `hc monodromy` writes it.
    #[arg(long, required_unless_present = "status")]
    start: Option<PathBuf>,
    /// JSON {"parameters": [number or [re, im], ...]}, or a list of such.
    #[arg(long, required_unless_present = "status")]
    target: Option<PathBuf>,
    /// Prove that the solutions exist and are distinct, by interval arithmetic, for the parameters
    /// as they are in double precision. Exit status 1 if some regular one is not certified.
    #[arg(long)]
    certify: bool,
    /// Lists one solution of each orbit under the family's `symmetry`, a real one if there is one, and says for how many
    /// each stands.
    #[arg(long)]
    up_to_symmetry: bool,
    /// Paths that are tracked again for a target, at most, in multiples of the paths of its first pass. What is lost
    /// then is said, with exit status 1. With 2 and more detours are tried first.
    #[arg(long, default_value_t = TargetLimits::default().again, value_name = "MULTIPLE", allow_negative_numbers = true)]
    again: f64,
    /// Seconds for each target; paths that have not begun by then are left, which is said, with exit status 1. The
    /// result then depends on the machine. No limit if not given.
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    time_limit: Option<f64>,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Accepted everywhere; tracking draws no random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// File for the solutions (JSON); - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
    #[command(flatten)]
    checkpoint: Recording,
    #[command(flatten)]
    pub(crate) ranks: mpirun::Sharing,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Targets {
    One(Target),
    Many(Vec<Target>),
}

#[derive(Deserialize)]
struct Target {
    parameters: Vec<Number>,
}

/// What the JSON has for a target.
#[derive(Serialize)]
struct Tracked<'a> {
    #[serde(flatten)]
    found: &'a Solutions,
    /// For how many solutions each stands, where one of each orbit is listed; empty if all are.
    represents: &'a [usize],
    /// The multiplicities of solutions that are multiple for all parameters, where the start file names such: no path
    /// leads to them.
    untracked: &'a [usize],
}

/// Tracks, with the other ranks if there are any; rank 0 alone prints, and writes files.
pub(crate) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let is_lead = ranks.is_none_or(Ranks::is_lead);
    if let Some(directory) = arguments.checkpoint.status() {
        return if is_lead { checkpoint::status(directory) } else { Ok(()) };
    }
    let files = Files::new().reads(arguments.family.as_deref()).reads(arguments.start.as_deref());
    let files = files.reads(arguments.target.as_deref()).writes("--json", arguments.json.as_deref());
    input::check(&files, ranks)?;
    let begun = Instant::now();
    let file = Recording::needed(&arguments.family, "a family")?;
    let family = family::read(file)?;
    let (fibre, multiple) = family::fibre(&family, Recording::needed(&arguments.start, "its fibre")?)?;
    let target = Recording::needed(&arguments.target, "targets")?;
    let (targets, single) = targets(target, fibre.parameters.len())?;
    let monitor = watch::interruptible()?;
    let done = AtomicU64::new(0);
    let count = targets.len() as u64;
    let describe = |p: hc::Progress| {
        let (position, length, words) = watch::stages(p);
        if count == 1 { (position, length, words) } else { (done.load(Ordering::Relaxed), count, "targets".to_owned()) }
    };
    let options = SolveOptions::new().seed(arguments.seed).certify(arguments.certify);
    let mut limits = TargetLimits::default();
    (limits.again, limits.seconds) = (arguments.again, arguments.time_limit);
    let checkpoint = if is_lead { arguments.checkpoint.open()? } else { None };
    let run = Run::new().watched(&monitor).recorded(checkpoint.as_ref()).on_ranks(ranks);
    let solved = watch::watched(arguments.threads, &monitor, describe, || {
        let tracking = run.track(&family, &fibre, &targets).options(&options).limits(&limits);
        tracking.up_to_symmetry(arguments.up_to_symmetry).transform(|_, found| {
            done.fetch_add(1, Ordering::Relaxed);
            (found, begun.elapsed().as_secs_f64())
        })
    })?;
    let solved: Vec<(Solutions, f64)> = solved.map_err(|error| match (error, &arguments.start) {
        (error @ FamilyError::Misses { .. }, Some(start)) => Failure::in_file(start, error),
        (error, _) => family::failure(file, error),
    })?;
    if !is_lead {
        return Ok(());
    }
    let seed = arguments.seed;
    let untracked: Vec<usize> = multiple.iter().map(|m| m.multiplicity).collect();
    let tracked = |found| Tracked { found, represents: &found.represents, untracked: &untracked };
    let found: Vec<Tracked<'_>> = solved.iter().map(|(found, _)| tracked(found)).collect();
    let reports: Vec<Report<'_, Tracked<'_>>> = (found.iter().zip(&solved))
        .map(|(found, (_, seconds))| Report { variables: &found.found.variables, seed, seconds: *seconds, found })
        .collect();
    if let Some(path) = &arguments.json {
        match &reports[..] {
            [report] if single => output::json(path, report)?,
            reports => output::json_list(path, reports)?,
        }
    }
    output::summary(arguments.json.as_deref(), || {
        summary(&solved, begun.elapsed().as_secs_f64()) + &family::besides(&multiple)
    })?;
    if solved.len() < targets.len() || solved.iter().any(|(found, _)| found.interrupted) {
        return Err(arguments.checkpoint.interrupted());
    }
    let failed: usize = solved.iter().map(|(found, _)| found.paths.failed).sum();
    if failed > 0 {
        return Err(Failure::Undetermined(format!("the lists are not whole; lost: {}", counted(failed, "path"))));
    }
    let uncertified: usize = solved.iter().map(|(found, _)| found.uncertified()).sum();
    if uncertified > 0 {
        return Err(Failure::Undetermined(format!("not certified: {}", counted(uncertified, "regular solution"))));
    }
    Ok(())
}

/// The targets, and whether the file is a single one rather than a list.
pub(crate) fn targets(file: &Path, parameters: usize) -> Result<(Vec<Vec<Complex64>>, bool), Failure> {
    let targets: Targets = serde_json::from_str(&input::text(file)?).map_err(|e| {
        Failure::in_file(file, format!("{e}; expected {{\"parameters\": [number or [re, im], ...]}} or a list of such"))
    })?;
    let (targets, single) = match targets {
        Targets::One(target) => (vec![target], true),
        Targets::Many(targets) => (targets, false),
    };
    let targets: Vec<Vec<Complex64>> =
        targets.into_iter().map(|t| t.parameters.into_iter().map(Complex64::from).collect()).collect();
    let unusable = |target: &Vec<Complex64>| target.len() != parameters || target.iter().any(|z| !z.is_finite());
    if let Some(k) = targets.iter().position(unusable) {
        return Err(Failure::in_file(
            file,
            format!("target {}: {} needed", k + 1, counted(parameters, "finite parameter")),
        ));
    }
    Ok((targets, single))
}

/// A few targets one by one, many in numbers.
fn summary(solved: &[(Solutions, f64)], seconds: f64) -> String {
    if solved.len() <= LISTED {
        let each = solved.iter().enumerate();
        return each.map(|(k, (found, seconds))| format!("target {}: {found}{seconds:.3} s\n", k + 1)).collect();
    }
    let sum = |count: &dyn Fn(&Solutions) -> usize| -> usize { solved.iter().map(|(found, _)| count(found)).sum() };
    let (listed, real) = (sum(&|found| found.represents.len()), sum(&|found| found.n_real()));
    let real = match listed {
        0 => format!("{real} real"),
        listed => format!("{listed} up to symmetry, {real} of these real"),
    };
    let mut text = format!(
        "{} targets: {}, {}; {}: {} finite, {} at infinity, {} failed, {} tracked again; {seconds:.3} s\n",
        solved.len(),
        counted(sum(&Solutions::count), "isolated solution"),
        real,
        counted(sum(&|found| found.paths.tracked), "path"),
        sum(&|found| found.paths.finite),
        sum(&|found| found.paths.at_infinity),
        sum(&|found| found.paths.failed),
        sum(&|found| found.paths.retracked)
    );
    let mut numbers: BTreeMap<usize, usize> = BTreeMap::new();
    for (found, _) in solved {
        *numbers.entry(found.n_real()).or_default() += 1;
    }
    for (real, targets) in numbers {
        text += &format!("  {} with {}\n", counted(targets, "target"), counted(real, "real solution"));
    }
    let doubtful = solved.iter().enumerate().filter(|(_, (found, _))| !found.warnings().is_empty());
    for (k, (found, _)) in doubtful.clone().take(LISTED) {
        for warning in found.warnings() {
            text += &format!("warning: target {}: {warning}\n", k + 1);
        }
    }
    let more = doubtful.count().saturating_sub(LISTED);
    if more > 0 {
        text += &format!("warnings of {}\n", counted(more, "more target"));
    }
    text
}
