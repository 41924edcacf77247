//! `hc solve`.

use crate::{certify, input};
use hc::solve::{Direction, Solution, SolveError, SolveOptions, Solved, Start, solve};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// All isolated regular solutions of a square system, by polyhedral homotopy.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system, in PHCpack's format.
    file: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Seed of the generic coefficients.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Start system: auto takes the one with fewer paths, polyhedral unless its mixed cells cannot be computed.
    #[arg(long, value_enum, default_value_t = StartChoice::Auto)]
    start: StartChoice,
    /// More paths than this are refused.
    #[arg(long, default_value_t = 1 << 24)]
    max_paths: u64,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Prove that the solutions exist and are distinct, by interval arithmetic. Singular solutions cannot be certified; exit
    /// status 1 if some regular one is not.
    #[arg(long)]
    certify: bool,
    /// Leave out solutions with zero coordinates.
    #[arg(long)]
    torus_only: bool,
}

#[derive(Clone, Copy, clap::ValueEnum)]
enum StartChoice {
    Auto,
    Polyhedral,
    TotalDegree,
}

impl From<StartChoice> for Start {
    fn from(choice: StartChoice) -> Start {
        match choice {
            StartChoice::Auto => Start::Auto,
            StartChoice::Polyhedral => Start::Polyhedral,
            StartChoice::TotalDegree => Start::TotalDegree,
        }
    }
}

#[derive(Serialize)]
struct Output<'a> {
    variables: &'a [String],
    start: Start,
    mixed_volume: Option<u64>,
    seed: u64,
    seconds: f64,
    paths: hc::fibre::PathCounts,
    excess: usize,
    on_components: usize,
    component_points: &'a [Vec<[f64; 2]>],
    directions: &'a [Direction],
    start_systems: u32,
    solutions: &'a [Solution],
}

pub(crate) fn run(arguments: &Arguments) -> Result<bool, String> {
    let start = Instant::now();
    let (system, polynomials) = input::system(&arguments.file)?;
    if arguments.certify && system.len() != system.variables().len() {
        let file = arguments.file.display();
        return Err(format!(
            "{file}: only systems of as many equations as unknowns can be certified; leave out --certify"
        ));
    }
    let mut options = SolveOptions::default();
    options.seed = arguments.seed;
    options.start = arguments.start.into();
    options.max_paths = arguments.max_paths;
    options.torus_only = arguments.torus_only;
    let mut found = input::on_threads(arguments.threads, || solve(&polynomials, &options))?
        .map_err(|error| refusal(arguments, &error, system.variables()))?;
    if arguments.certify {
        input::on_threads(arguments.threads, || certify::fill(&system, &mut found.solutions))??;
    }
    let output = Output {
        variables: system.variables(),
        start: found.start,
        mixed_volume: found.mixed_volume,
        seed: arguments.seed,
        seconds: start.elapsed().as_secs_f64(),
        paths: found.paths,
        excess: found.excess,
        on_components: found.on_components,
        component_points: &found.component_points,
        directions: &found.directions,
        start_systems: found.start_systems,
        solutions: &found.solutions,
    };
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print!("{}", summary(&found, output.seconds));
        if arguments.certify {
            let certified = found.solutions.iter().filter(|s| s.certified == Some(true)).count();
            println!("{certified} solutions certified");
        }
    }
    if let Some(out) = &arguments.json {
        input::write_json(out, &output)?;
    }
    // A list that may not be whole is not presented as a success.
    let uncertified = found.solutions.iter().any(|s| s.certified == Some(false) && !s.singular);
    Ok(!found.solutions.is_empty() && found.paths.failed == 0 && !uncertified)
}

/// One screen at most.
fn summary(found: &Solved, seconds: f64) -> String {
    let paths = &found.paths;
    let real = found.solutions.iter().filter(|s| s.real).count();
    let mut text = format!("{} isolated solutions, {real} real, {seconds:.3} s\n", found.solutions.len());
    let mut multiplicities: BTreeMap<usize, usize> = BTreeMap::new();
    found.solutions.iter().filter(|s| s.singular).for_each(|s| *multiplicities.entry(s.multiplicity).or_default() += 1);
    for (multiplicity, count) in multiplicities {
        text += &format!("  {count} of them singular, of multiplicity {multiplicity}\n");
    }
    text += &format!(
        "{} paths ({}): {} finite, {} at infinity, {} failed, {} tracked again\n",
        paths.tracked,
        start_name(found),
        paths.finite,
        paths.at_infinity,
        paths.failed,
        paths.retracked
    );
    if found.on_components > 0 {
        text += &format!(
            "there are solution sets of positive dimension: {} paths end on them, at {} points\n",
            found.on_components,
            found.component_points.len()
        );
    }
    if found.excess > 0 {
        text += &format!(
            "{} finite ends are left out: they do not solve all equations, or lie outside the torus\n",
            found.excess
        );
    }
    if found.start_systems > 1 {
        text += &format!("{} start systems were used, since paths were lost\n", found.start_systems);
    }
    if paths.failed > 0 {
        text += &format!("the list may be incomplete: it is not known where {} paths end\n", paths.failed);
    }
    text
}

fn start_name(found: &Solved) -> &'static str {
    match found.start {
        Start::TotalDegree => "total degree",
        _ => "polyhedral",
    }
}

/// Why the system is not solved, with the names of the unknowns where their number is the reason.
fn refusal(arguments: &Arguments, error: &SolveError, variables: &[String]) -> String {
    let file = arguments.file.display();
    match error {
        SolveError::Underdetermined { equations, .. } => format!(
            "{file}: {equations} equations in {} unknowns ({}) have no isolated solutions; add equations, or numbers for some of the unknowns",
            variables.len(),
            variables.join(", ")
        ),
        other => format!("{file}: {other}"),
    }
}
