//! `tdoa experiment`.

mod checks;
mod clean;
mod hard;

use std::path::PathBuf;

use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use tdoa::experiment::{Trial, trial};
use tdoa::{CalibrateOptions, SimulateOptions, simulate};

use crate::{Failure, output};

/// Repeats an experiment on simulated data and writes its numbers as CSV.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(clap::Subcommand)]
enum Kind {
    Calibrate(CalibrateArguments),
    Clean(clean::Arguments),
    /// Proves by interval arithmetic that all roots that the minimal solvers report exist and are distinct.
    Proofs(checks::Arguments),
    /// Compares the stored start of the minimal solvers with a polyhedral one.
    Routes(checks::Arguments),
    /// Measures what the options for callers in a hurry save and lose.
    Hurry(checks::Arguments),
    Hard(hard::Arguments),
}

/// Calibrates random networks in a room of 10 m by 10 m and compares the errors with the Cramer-Rao bound.
#[derive(clap::Args)]
struct CalibrateArguments {
    /// Size of the networks.
    #[arg(long, default_value = "8r/12s")]
    configuration: String,
    /// Number of networks.
    #[arg(long, default_value_t = 500)]
    instances: u64,
    /// Standard deviation of the noise, metres.
    #[arg(long, default_value_t = 0.01)]
    noise: f64,
    /// Share of outliers.
    #[arg(long, default_value_t = 0.0)]
    outliers: f64,
    /// Share of missing measurements.
    #[arg(long, default_value_t = 0.1)]
    missing: f64,
    /// Tells the calibration the standard deviation of the noise.
    #[arg(long)]
    known_sigma: bool,
    /// First seed; the networks have this and the following ones.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. Only the seconds depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Directory for trials.csv and summary.csv; made if it is not there.
    #[arg(long)]
    output: PathBuf,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let arguments = match &arguments.kind {
        Kind::Clean(arguments) => return clean::run(arguments),
        Kind::Hard(arguments) => return hard::run(arguments),
        Kind::Proofs(arguments) => return checks::proofs(arguments),
        Kind::Routes(arguments) => return checks::routes(arguments),
        Kind::Hurry(arguments) => return checks::hurry(arguments),
        Kind::Calibrate(arguments) => arguments,
    };
    let sizes = arguments.configuration.split_once("r/");
    let sizes = sizes.and_then(|(m, n)| Some((m.parse().ok()?, n.strip_suffix('s')?.parse().ok()?)));
    let Some((receivers, transmitters)) = sizes else {
        return Err(Failure::Unusable(format!(
            "--configuration must be such as 8r/12s, not {:?}",
            arguments.configuration
        )));
    };
    let one = |seed: u64| -> Result<Trial, Failure> {
        let mut options = SimulateOptions::default();
        options.receivers = receivers;
        options.transmitters = transmitters;
        options.noise = arguments.noise;
        options.outliers = arguments.outliers;
        options.missing = arguments.missing;
        options.seed = seed;
        let simulation = simulate(&options).map_err(Failure::unusable)?;
        let mut options = CalibrateOptions::default();
        options.seed = seed;
        options.sigma = Some(arguments.noise).filter(|_| arguments.known_sigma);
        Ok(trial(&simulation, arguments.noise, seed, &options))
    };
    let seeds = arguments.seed..arguments.seed.saturating_add(arguments.instances);
    let trials: Vec<Trial> =
        crate::on_threads(arguments.threads, || seeds.into_par_iter().map(one).collect::<Result<_, _>>())??;
    let summary = summary(arguments, &trials);
    let directory = &arguments.output;
    std::fs::create_dir_all(directory)
        .map_err(|error| Failure::Unusable(format!("{}: cannot be made ({error})", directory.display())))?;
    output::write(&directory.join("trials.csv"), table(&trials).as_bytes())?;
    output::write(&directory.join("summary.csv"), summary.as_bytes())?;
    output::print(&summary)
}

fn table(trials: &[Trial]) -> String {
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.6e}"));
    let mut text =
        "seed,success,receiver_rms,bound,unique,best_of_alternatives,sigma,covered,ellipses,starts,seconds\n"
            .to_string();
    for t in trials {
        text += &format!(
            "{},{},{},{:.6e},{},{},{},{},{},{},{:.4}\n",
            t.seed,
            t.success(),
            number(t.receiver_rms),
            t.bound,
            t.unique,
            number(t.best_of_alternatives),
            number(t.sigma),
            t.covered,
            t.ellipses,
            t.starts,
            t.seconds
        );
    }
    text
}

fn summary(arguments: &CalibrateArguments, trials: &[Trial]) -> String {
    let count = trials.len().max(1) as f64;
    let share = |test: &dyn Fn(&Trial) -> bool| trials.iter().filter(|t| test(t)).count() as f64 / count;
    let successes: Vec<&Trial> = trials.iter().filter(|t| t.success()).collect();
    let squares = |value: &dyn Fn(&Trial) -> f64| successes.iter().map(|t| value(t).powi(2)).sum::<f64>();
    // Relative to the bound of each network, so that networks of poor geometry do not drown the others.
    let ratio = squares(&|t| t.receiver_rms.unwrap_or(0.0) / t.bound) / successes.len().max(1) as f64;
    let covered: usize = successes.iter().map(|t| t.covered).sum();
    let ellipses: usize = successes.iter().map(|t| t.ellipses).sum();
    let mut times: Vec<f64> = trials.iter().map(|t| t.seconds).collect();
    times.sort_by(f64::total_cmp);
    format!(
        "configuration,networks,noise,outliers,missing,success,among_alternatives,unique,unique_and_wrong,rms_over_bound,\
         coverage_95,median_seconds\n{},{},{},{},{},{:.4},{:.4},{:.4},{:.4},{:.4},{:.4},{:.4}\n",
        arguments.configuration,
        trials.len(),
        arguments.noise,
        arguments.outliers,
        arguments.missing,
        share(&|t| t.success()),
        share(&Trial::among_alternatives),
        share(&|t| t.unique),
        share(&|t| t.unique && !t.among_alternatives()),
        ratio.sqrt(),
        covered as f64 / ellipses.max(1) as f64,
        times.get(times.len() / 2).copied().unwrap_or(0.0),
    )
}
