//! `hc track`.

use crate::family::{Failure, Problem, read_text, write};
use crate::monodromy::fits;
use hc::fibre::{FibreOptions, PathCounts, track_fibre};
use hc::refine::Refiner;
use hc::start_file::StartFile;
use hc::tracker::PathEnd;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Instant;

/// Imaginary parts up to this share of the point count as zero.
const REAL: f64 = 1e-8;

/// Tracks a stored fibre of a family to one or several parameter points.
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

#[derive(Deserialize, Clone, Copy)]
#[serde(untagged)]
enum Number {
    Real(f64),
    Complex([f64; 2]),
}

impl From<Number> for Complex64 {
    fn from(number: Number) -> Complex64 {
        match number {
            Number::Real(re) => Complex64::new(re, 0.0),
            Number::Complex([re, im]) => Complex64::new(re, im),
        }
    }
}

/// The JSON of one target.
#[derive(Serialize)]
struct Report<'a> {
    variables: &'a [String],
    seed: u64,
    seconds: f64,
    paths: PathCounts,
    solutions: Vec<Solution>,
}

#[derive(Serialize)]
struct Solution {
    value: Vec<[f64; 2]>,
    multiplicity: usize,
    winding_number: usize,
    singular: bool,
    real: bool,
    residual: f64,
    condition: f64,
    certified: Option<bool>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let problem = Problem::read(&arguments.family)?;
    let start = &arguments.start;
    let file = StartFile::from_json(&read_text(start)?).map_err(|e| Failure::unusable(start, e))?;
    let fibre = file.fibre().map_err(|e| Failure::unusable(start, e))?;
    fits(&problem, &fibre).map_err(|e| Failure::unusable(start, e))?;
    let targets: Targets = serde_json::from_str(&read_text(&arguments.target)?)
        .map_err(|e| Failure::unusable(&arguments.target, format!("{e}; expected {{\"parameters\": [...]}}")))?;
    let (targets, single) = match targets {
        Targets::One(target) => (vec![target], true),
        Targets::Many(targets) => (targets, false),
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.unwrap_or(0))
        .build()
        .map_err(|e| Failure::Unusable(format!("threads cannot be started: {e}")))?;
    let mut refiner = Refiner::new(&problem.system);
    let mut reports = Vec::new();
    for (k, target) in targets.iter().enumerate() {
        let target: Vec<Complex64> = target.parameters.iter().map(|&n| n.into()).collect();
        if target.len() != fibre.parameters.len() || target.iter().any(|z| !z.is_finite()) {
            return Err(Failure::unusable(
                &arguments.target,
                format!("target {}: {} finite parameters are needed", k + 1, fibre.parameters.len()),
            ));
        }
        let started = Instant::now();
        let (ends, paths) = pool.install(|| track_fibre(&problem.system, &fibre, &target, &FibreOptions::default()));
        let regular = ends.iter().filter(|(r, _)| r.end == PathEnd::Success);
        let solutions = regular.map(|(_, x)| solution(&mut refiner, &target, x)).collect();
        let seconds = started.elapsed().as_secs_f64();
        let variables = problem.family.system.variables();
        reports.push(Report { variables, seed: arguments.seed, seconds, paths, solutions });
    }
    let to_text = |value: Result<String, serde_json::Error>| value.map_err(|e| Failure::Unusable(e.to_string()));
    if let Some(path) = &arguments.json {
        let text = match &reports[..] {
            [report] if single => to_text(serde_json::to_string_pretty(report))?,
            reports => to_text(serde_json::to_string_pretty(reports))?,
        };
        write(path, &(text + "\n"))?;
    }
    if arguments.json.as_ref().is_none_or(|path| path.as_os_str() != "-") {
        let mut text = String::new();
        for (k, report) in reports.iter().enumerate() {
            text += &summary(k, report);
        }
        write(std::path::Path::new("-"), &text)?;
    }
    let failed: usize = reports.iter().map(|r| r.paths.failed).sum();
    if failed > 0 {
        return Err(Failure::Incomplete(format!(
            "{failed} paths were lost or end at singular solutions: the lists are not whole"
        )));
    }
    Ok(())
}

fn solution(refiner: &mut Refiner<'_, hc::poly::Interpreter>, target: &[Complex64], x: &[Complex64]) -> Solution {
    let refined = refiner.refine(target, x);
    let size = refined.point.iter().map(|z| z.norm()).fold(0.0, f64::max);
    Solution {
        real: refined.point.iter().all(|z| z.im.abs() <= REAL * size),
        value: refined.point.iter().map(|z| [z.re, z.im]).collect(),
        multiplicity: 1,
        winding_number: 1,
        singular: false,
        residual: refined.residual,
        condition: refined.condition,
        certified: None,
    }
}

fn summary(k: usize, report: &Report<'_>) -> String {
    let real: Vec<&Solution> = report.solutions.iter().filter(|s| s.real).collect();
    let p = &report.paths;
    let mut text = format!(
        "target {}: {} paths: {} finite, {} at infinity, {} failed, {} tracked again; {} real solutions, {:.3} s\n",
        k + 1,
        p.tracked,
        p.finite,
        p.at_infinity,
        p.failed,
        p.retracked,
        real.len(),
        report.seconds
    );
    for s in real.iter().take(20) {
        let values: Vec<String> =
            report.variables.iter().zip(&s.value).map(|(name, v)| format!("{name} = {:.12}", v[0])).collect();
        text += &format!("  {}\n", values.join(", "));
    }
    text
}
