//! `hc certify`, and `--certify` of `hc solve`.

use crate::{input, points, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::Run;
use hc::certify::{Certificate, Certificates, CertifyOptions, Obstacle, Reality};
use hc::poly::{ComplexInterval, counted};
use num_complex::Complex64;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Proves that solutions exist, are distinct and are real: Krawczyk's test in interval arithmetic.
///
/// What is proved is about the system as written: decimals in the file are exact numbers. Exit
/// status 1 if some point could not be certified.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system: plain text with one equation a line, PHCpack's format, or TOML; - for standard
    /// input.
    system: PathBuf,
    /// The solutions: what `hc solve --json` writes, a list of points [[number or [re, im], ...],
    /// ...], a list of solutions in PHCpack's format, such as `phc -b` appends to its output, or
    /// plain text; - for standard input.
    ///
    /// Plain text has one point a line: a number for each unknown, in their order, with blanks or
    /// commas between them, such as `1.5 -2e-3 1.5+2i -i`. A number has no blanks in it; its
    /// imaginary part ends in i or j. A line `variables: y x` before the points gives another order,
    /// # begins a comment.
    solutions: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Accepted everywhere; certification draws no random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

#[derive(Serialize)]
struct Output<'a> {
    variables: &'a [String],
    seed: u64,
    seconds: f64,
    n_points: usize,
    n_certified: usize,
    n_distinct: usize,
    n_real: usize,
    /// Whether the work was stopped before every point was tried.
    partial: bool,
    /// Pairs of points proved neither the same solution nor different ones.
    unseparated: &'a [[usize; 2]],
    solutions: Vec<Point>,
}

/// What is proved of a point.
#[derive(Default, Serialize)]
struct Point {
    /// The middle of the box, or the point as given where there is none.
    value: Vec<[f64; 2]>,
    certified: bool,
    /// Null where nothing is proved.
    is_real: Option<bool>,
    /// Bounds of the real and of the imaginary part of each coordinate; exactly one solution lies
    /// within.
    #[serde(rename = "box")]
    enclosure: Option<Vec<[[f64; 2]; 2]>>,
    /// Index, from 0, of an earlier point that stands for the same solution.
    duplicate_of: Option<usize>,
    /// Why there is no certificate.
    reason: Option<String>,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let files = Files::new().reads(Some(&arguments.system)).reads(Some(&arguments.solutions));
    files.writes("--json", arguments.json.as_deref()).check()?;
    let start = Instant::now();
    let file = &arguments.system;
    let system = input::system(file)?;
    let points = points::read(&arguments.solutions, &system)?;
    let monitor = watch::interruptible()?;
    let (run, options) = (Run::new().watched(&monitor), CertifyOptions::default());
    let prove = || run.certify(&system, &[], &points, &options);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, prove)?
        .map_err(|error| Failure::in_file(file, error))?;
    let solutions = found.points.iter().zip(&found.duplicate_of).zip(&points);
    let report = Output {
        variables: system.variables(),
        seed: arguments.seed,
        seconds: start.elapsed().as_secs_f64(),
        n_points: points.len(),
        n_certified: found.n_certified(),
        n_distinct: found.n_distinct(),
        n_real: found.n_real(),
        partial: found.interrupted(),
        unseparated: &found.unseparated,
        solutions: solutions.map(|((result, &duplicate), point)| entry(result, duplicate, point)).collect(),
    };
    output::summary(arguments.json.as_deref(), || summary(&found))?;
    if let Some(out) = &arguments.json {
        output::json(out, &report)?;
    }
    if found.interrupted() {
        return Err(Failure::Interrupted);
    }
    if found.complete() {
        return Ok(());
    }
    let without = points.len() - found.n_certified();
    let pairs = counted(found.unseparated.len(), "pair");
    let message = format!("{} without certificate, {pairs} not told apart", counted(without, "point"));
    Err(Failure::Undetermined(message))
}

fn entry(result: &Result<Certificate, Obstacle>, duplicate_of: Option<usize>, point: &[Complex64]) -> Point {
    let pairs = |x: &[Complex64]| x.iter().map(|z| [z.re, z.im]).collect();
    let bounds = |z: &ComplexInterval| [[z.re.low, z.re.high], [z.im.low, z.im.high]];
    match result {
        Ok(certificate) => Point {
            value: pairs(&certificate.value),
            certified: true,
            is_real: match certificate.reality {
                Reality::Real => Some(true),
                Reality::NotReal => Some(false),
                Reality::Undecided => None,
            },
            enclosure: Some(certificate.enclosure.iter().map(bounds).collect()),
            duplicate_of,
            reason: None,
        },
        Err(obstacle) => Point { value: pairs(point), reason: Some(obstacle.to_string()), ..Point::default() },
    }
}

fn summary(found: &Certificates) -> String {
    let points = found.points.len();
    let mut text = format!(
        "{} of {} certified: {}, {} of them proved real\n",
        found.n_certified(),
        counted(points, "point"),
        counted(found.n_distinct(), "distinct solution"),
        found.n_real()
    );
    let failures = found.points.iter().enumerate().filter_map(|(k, p)| Some((k, p.as_ref().err()?)));
    for (k, obstacle) in failures.clone().take(10) {
        text += &format!("point {}: {obstacle}\n", k + 1);
    }
    let more = failures.count().saturating_sub(10);
    if more > 0 {
        text += &format!("{} without certificate\n", counted(more, "more point"));
    }
    for [a, b] in &found.unseparated {
        text += &format!("points {} and {}: neither proved equal nor different\n", a + 1, b + 1);
    }
    text
}
