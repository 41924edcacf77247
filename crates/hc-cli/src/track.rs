//! `hc track`.

use crate::family::Problem;
use crate::input::{self, Number};
use crate::report::Report;
use crate::{certify, watch};
use cli::{Failure, output};
use hc::fibre::Fibre;
use hc::poly::ComplexInterval;
use hc::solve::{SolveOptions, Solved, solve_member};
use num_complex::Complex64;
use serde::Deserialize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Tracks a stored fibre of a family to one or several parameter points.
///
/// Interrupted, it gives the targets done so far, the last of them marked as partial, with exit status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family (TOML).
    family: PathBuf,
    /// Its fibre, as `hc monodromy` writes it.
    #[arg(long)]
    start: PathBuf,
    /// JSON {"parameters": [number or [re, im], ...]}, or a list of such.
    #[arg(long)]
    target: PathBuf,
    /// Prove that the solutions exist and are distinct, by interval arithmetic, for the parameters as they are in double precision.
    /// Exit status 1 if some regular one is not certified.
    #[arg(long)]
    certify: bool,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Accepted everywhere; tracking draws no random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// File for the solutions (JSON); - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let problem = Problem::read(&arguments.family)?;
    let fibre = problem.fibre(&arguments.start)?;
    let (targets, single) = targets(arguments, fibre.parameters.len())?;
    let monitor = watch::interruptible()?;
    let mut options = SolveOptions::default();
    options.set_monitor(monitor.clone());
    let current = AtomicU64::new(0);
    let count = targets.len() as u64;
    let describe = |p: hc::monitor::Progress| {
        let (position, length, words) = watch::stages(p);
        match count {
            1 => (position, length, words),
            _ => (current.load(Ordering::Relaxed), count, format!("targets; {position} of {length} {words}")),
        }
    };
    let solved = watch::watched(arguments.threads, &monitor, describe, || {
        let mut solved = Vec::new();
        for target in &targets {
            solved.push(member(&problem, &fibre, target, &options, arguments.certify)?);
            current.fetch_add(1, Ordering::Relaxed);
            if monitor.is_cancelled() {
                break;
            }
        }
        Ok(solved)
    })?;
    let solved: Vec<(Solved, f64)> = solved.map_err(|e: String| Failure::in_file(&arguments.family, e))?;
    let variables = problem.family.system.variables();
    let reports: Vec<Report<'_>> =
        solved.iter().map(|(found, seconds)| Report::new(variables, found, arguments.seed, *seconds)).collect();
    if let Some(path) = &arguments.json {
        match &reports[..] {
            [report] if single => output::json(path, report)?,
            reports => output::json(path, &reports)?,
        }
    }
    output::summary(arguments.json.as_deref(), || summary(&reports))?;
    if solved.len() < targets.len() || solved.iter().any(|(found, _)| found.interrupted) {
        return Err(Failure::Interrupted);
    }
    let failed: usize = solved.iter().map(|(found, _)| found.paths.failed).sum();
    if failed > 0 {
        return Err(Failure::Undetermined(format!("{failed} paths were lost: the lists are not whole")));
    }
    let uncertified: usize = reports.iter().map(Report::uncertified).sum();
    if uncertified > 0 {
        return Err(Failure::Undetermined(format!("{uncertified} regular solutions are not certified")));
    }
    Ok(())
}

/// The targets, and whether the file is a single one rather than a list.
fn targets(arguments: &Arguments, parameters: usize) -> Result<(Vec<Vec<Complex64>>, bool), Failure> {
    let file = &arguments.target;
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
        return Err(Failure::in_file(file, format!("target {}: {parameters} finite parameters are needed", k + 1)));
    }
    Ok((targets, single))
}

/// Solves one member, and says how many seconds that took.
fn member(
    problem: &Problem,
    fibre: &Fibre,
    target: &[Complex64],
    options: &SolveOptions,
    certified: bool,
) -> Result<(Solved, f64), String> {
    let started = Instant::now();
    let family = &problem.family.system;
    let mut found = solve_member(family, &problem.compiled.system, fibre, target, options);
    if certified {
        let parameters: Vec<ComplexInterval> = target.iter().map(|&p| ComplexInterval::point(p)).collect();
        certify::fill(family, &parameters, &mut found.solutions)?;
    }
    Ok((found, started.elapsed().as_secs_f64()))
}

fn summary(reports: &[Report<'_>]) -> String {
    let each = reports.iter().enumerate();
    each.map(|(k, report)| format!("target {}: {}{}", k + 1, report.summary(), report.listing())).collect()
}
