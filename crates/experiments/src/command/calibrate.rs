//! `tdoa experiment calibrate` and `coverage`: the calibration on simulated networks beside the
//! truth and the Cramer-Rao bound.

use crate::trials::calibration::{Trial, judge};
use tdoa::Monitor;
use tdoa::calibrate::{Calibrates, Dimension, MinimalHypotheses, calibrate_with};
use tdoa::{CalibrateOptions, Layout, SimulateOptions, Simulation, simulate};

use super::book::Rows;
use super::common::{Common, Size, thread_seconds};
use super::statistics::{mean, short};
use super::table::Table;
use crate::quantile::{median, quantile};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Where the search gets its starts from.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub(super) enum Method {
    /// Random networks and exactly solved subsets, as in `tdoa calibrate`.
    Portfolio,
    /// Random networks alone.
    Restarts,
    /// Exactly solved subsets alone.
    Minimal,
}

impl Method {
    fn name(self) -> &'static str {
        match self {
            Method::Portfolio => "portfolio",
            Method::Restarts => "restarts",
            Method::Minimal => "minimal",
        }
    }
}

/// Calibrates random networks in a room of 10 m by 10 m, in space of 10 m by 8 m by 3 m, and compares
/// the errors with the Cramer-Rao bound.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "6r/10s,8r/12s,10r/20s,25r/20s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Coordinates of a position: 2 or 3.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimensions: u8,
    /// Number of networks of each kind.
    #[arg(long, default_value_t = 500)]
    instances: u64,
    /// Standard deviations of the noise, metres.
    #[arg(long, default_value = "0.01", value_delimiter = ',')]
    noise: Vec<f64>,
    /// Shares of outliers.
    #[arg(long, default_value = "0,0.1,0.3", value_delimiter = ',')]
    outliers: Vec<f64>,
    /// Share of missing measurements.
    #[arg(long, default_value_t = 0.1)]
    missing: f64,
    /// Tells the calibration the standard deviation of the noise.
    #[arg(long)]
    known_sigma: bool,
    /// Where the search gets its starts from.
    #[arg(long, value_enum, default_value = "portfolio", value_delimiter = ',')]
    method: Vec<Method>,
    /// Exactly as many starts of the search: one number for all kinds of networks, or one for each
    /// (by configuration, noise, outliers); as many as `tdoa calibrate` makes if not given.
    #[arg(long, value_delimiter = ',')]
    starts: Vec<usize>,
    #[command(flatten)]
    common: Common,
}

/// Compares the errors of many calibrations with the Cramer-Rao bound, and counts how often the 95
/// % ellipses hold the truth.
#[derive(clap::Args)]
pub(super) struct CoverageArguments {
    /// The configurations.
    #[arg(long, default_value = "8r/12s,10r/20s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Number of networks a configuration.
    #[arg(long, default_value_t = 2000)]
    instances: u64,
    /// Standard deviation of the noise, metres.
    #[arg(long, default_value_t = 0.01)]
    noise: f64,
    /// Tells the calibration the standard deviation of the noise.
    #[arg(long)]
    known_sigma: bool,
    #[command(flatten)]
    common: Common,
}

/// One kind of trial.
#[derive(Clone, Copy)]
struct Case {
    method: Method,
    starts: Option<usize>,
    size: Size,
    dimensions: u8,
    noise: f64,
    outliers: f64,
    missing: f64,
    known_sigma: bool,
}

const HEADER: &str = "method,starts,configuration,dimensions,noise,outliers,missing,known_sigma,seed,determined,success,\
                      among_alternatives,unique,receiver_rms,bound,sigma,covered,ellipses,redundancy,starts_made,processor_seconds";

/// The room in space, metres.
const ROOM: [f64; 3] = [10.0, 8.0, 3.0];

impl Case {
    /// The columns before the seed.
    fn key(&self) -> String {
        let starts = self.starts.map_or("default".into(), |starts| starts.to_string());
        let Case { method, size, dimensions, noise, outliers, missing, known_sigma, .. } = self;
        format!("{},{starts},{size},{dimensions},{noise},{outliers},{missing},{known_sigma}", method.name())
    }

    fn simulate<const D: usize>(&self, layout: Layout<D>, seed: u64) -> Result<Simulation<D>, Failure> {
        let mut options = SimulateOptions::new();
        (options.receivers, options.transmitters) = (self.size.receivers, self.size.transmitters);
        options.layout = layout;
        options.noise = self.noise;
        options.outliers = self.outliers;
        options.missing = self.missing;
        options.seed = seed;
        simulate(&options).map_err(Failure::unusable)
    }

    fn trial(&self, seed: u64) -> Result<Trial, Failure> {
        match self.dimensions {
            3 => self.judged(&self.simulate(Layout::Room { extent: ROOM }, seed)?, seed),
            _ => self.judged(&self.simulate(SimulateOptions::default().layout, seed)?, seed),
        }
    }

    fn judged<const D: usize>(&self, simulation: &Simulation<D>, seed: u64) -> Result<Trial, Failure>
    where
        Dimension<D>: Calibrates<D>,
    {
        let mut options = CalibrateOptions::new();
        options.seed = seed;
        options.sigma = Some(self.noise).filter(|_| self.known_sigma);
        if let Some(starts) = self.starts {
            (options.search.min_starts, options.search.max_starts) = (starts, starts);
        }
        let exact = MinimalHypotheses::new();
        let mut sources: Vec<&dyn tdoa::Hypotheses<D>> = Vec::new();
        match self.method {
            Method::Portfolio => {}
            Method::Restarts => options.search.minimal_subsets = 0,
            Method::Minimal => {
                options.search.restarts = false;
                sources.push(&exact);
            }
        }
        let started = thread_seconds();
        let found = calibrate_with(&simulation.pseudoranges, &options, &sources, &Monitor::default());
        Ok(judge(simulation, self.noise, seed, thread_seconds() - started, &found))
    }
}

/// Runs networks of every case and gives the rows, case by case, to rank 0.
fn trials(common: &Common, cases: &[Case], instances: u64, ranks: Option<&Ranks<'_>>) -> Result<Option<Rows>, Failure> {
    if instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let all: Vec<(Case, u64)> =
        cases.iter().flat_map(|&case| common.seeds(instances).map(move |seed| (case, seed))).collect();
    let keys: Vec<String> = all.iter().map(|(case, seed)| format!("{},{seed}", case.key())).collect();
    Table::new(common, "trials.csv", HEADER, &keys, ranks).resume(
        || (),
        |(), k| {
            let (case, seed) = all[k];
            let t = case.trial(seed)?;
            let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4e}"));
            Ok(format!(
                "{},{},{},{},{},{:.4e},{},{},{},{},{},{:.4}",
                t.bound.is_finite(),
                t.success(),
                t.among_alternatives(),
                t.unique,
                number(t.receiver_rms),
                t.bound,
                number(t.sigma),
                t.covered,
                t.ellipses,
                t.redundancy,
                t.starts,
                t.seconds
            ))
        },
    )
}

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let mut cases = Vec::new();
    let kinds = arguments.configuration.len() * arguments.noise.len() * arguments.outliers.len();
    if !matches!(arguments.starts.len(), 0 | 1) && arguments.starts.len() != kinds {
        let given = arguments.starts.len();
        return Err(Failure::Unusable(format!(
            "--starts must be one number, or {kinds} for {kinds} kinds of networks, not {given}"
        )));
    }
    for &method in &arguments.method {
        let mut starts = arguments.starts.iter().copied().cycle();
        for &size in &arguments.configuration {
            for &noise in &arguments.noise {
                for &outliers in &arguments.outliers {
                    let (missing, known_sigma, starts) = (arguments.missing, arguments.known_sigma, starts.next());
                    let dimensions = arguments.dimensions;
                    cases.push(Case { method, starts, size, dimensions, noise, outliers, missing, known_sigma });
                }
            }
        }
    }
    let common = &arguments.common;
    let Some(rows) = trials(common, &cases, arguments.instances, ranks)? else { return Ok(()) };
    report(common, &rows, &cases, arguments.instances as usize)
}

pub(super) fn run_coverage(arguments: &CoverageArguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let case = |&size: &Size| Case {
        method: Method::Portfolio,
        starts: None,
        size,
        dimensions: 2,
        noise: arguments.noise,
        outliers: 0.0,
        missing: 0.1,
        known_sigma: arguments.known_sigma,
    };
    let cases: Vec<Case> = arguments.configuration.iter().map(case).collect();
    let Some(rows) = trials(&arguments.common, &cases, arguments.instances, ranks)? else { return Ok(()) };
    report(&arguments.common, &rows, &cases, arguments.instances as usize)
}

fn report(common: &Common, rows: &Rows, cases: &[Case], each: usize) -> Result<(), Failure> {
    let mut summary = String::from(
        "method,starts,configuration,dimensions,noise,outliers,missing,known_sigma,networks,undetermined,success,among_alternatives,\
         unique,unique_and_wrong,rms_over_bound,coverage_95,redundancy,processor_seconds_median,processor_seconds_90\n",
    );
    for (g, case) in cases.iter().enumerate() {
        let of = |column: &str| rows.numbers(column, g * each..(g + 1) * each);
        let (determined, success, among, unique) =
            (of("determined"), of("success"), of("among_alternatives"), of("unique"));
        // Networks that even the inliers alone do not determine are counted apart, not as successes
        // or failures.
        let count = determined.iter().sum::<f64>();
        let share = |all: &[f64]| all.iter().zip(&determined).map(|(a, d)| a * d).sum::<f64>() / count;
        let wrong: Vec<f64> = unique.iter().zip(&among).map(|(u, a)| u * (1.0 - a)).collect();
        // Relative to the bound of each network, so that networks of poor geometry do not drown the
        // others.
        let good = |k: &usize| success[*k] * determined[*k] > 0.0;
        let (rms, bound, redundancy) = (of("receiver_rms"), of("bound"), of("redundancy"));
        let squares: Vec<f64> = (0..each).filter(good).map(|k| (rms[k] / bound[k]).powi(2)).collect();
        let held = |column: &str| {
            let all = of(column);
            (0..each).filter(good).map(|k| all[k]).sum::<f64>()
        };
        let seconds = of("processor_seconds");
        let cells = [
            case.key(),
            each.to_string(),
            (each as f64 - count).to_string(),
            short(share(&success)),
            short(share(&among)),
            short(share(&unique)),
            short(share(&wrong)),
            short(mean(&squares).sqrt()),
            short(held("covered") / held("ellipses")),
            short(mean(&(0..each).filter(good).map(|k| redundancy[k]).collect::<Vec<_>>())),
            short(median(&seconds)),
            short(quantile(&seconds, 0.9)),
        ];
        summary += &(cells.join(",") + "\n");
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
