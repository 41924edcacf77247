//! `tdoa experiment speed`.

use std::fmt::Write;
use std::time::Instant;

use rayon::iter::{IndexedParallelIterator, IntoParallelIterator, ParallelIterator};
use tdoa::Pseudoranges;
use tdoa::minimal::{MinimalError, MinimalOptions, Solver};

use super::common::{Common, Size, normal};
use super::statistics::short;
use crate::quantile::{median, quantile};
use cli::{Failure, output};

/// Takes the time of the exact solvers on clean random networks, on one thread and on all, and
/// counts what their paths need.
///
/// Times are by the wall: nothing else should run. A run that was stopped starts anew.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "6r/3s,5r/4s,4r/5s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Number of networks of each configuration (positions and offsets standard normal, no noise).
    #[arg(long, default_value_t = 300)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let common = &arguments.common;
    let mut summary = String::from(
        "configuration,instances,paths,steps_a_path,rejected_a_path,jacobians_a_path,milliseconds_median,milliseconds_99,\
         microseconds_a_path,solves_a_second,threads,solves_a_second_on_all\n",
    );
    for &size in &arguments.configuration {
        let networks = common.seeds(arguments.instances).map(|seed| Ok(normal::<2>(size, 0.0, seed)?.pseudoranges));
        let networks = networks.collect::<Result<Vec<Pseudoranges>, Failure>>()?;
        let (one, counts) = on_one(&networks)?;
        let (threads, all) = cli::on_threads(common.threads, || {
            let threads = rayon::current_num_threads();
            on_all(&networks, threads).map(|seconds| (threads, seconds))
        })??;
        let milliseconds: Vec<f64> = one.iter().map(|seconds| 1e3 * seconds).collect();
        let seconds: f64 = one.iter().sum();
        let a_path = |count: usize| short(count as f64 / counts.paths.max(1) as f64);
        // Writing to a string does not fail.
        let _ = writeln!(
            summary,
            "{size},{},{},{},{},{},{},{},{},{},{threads},{}",
            networks.len(),
            counts.paths,
            a_path(counts.accepted),
            a_path(counts.rejected),
            a_path(counts.jacobians),
            short(median(&milliseconds)),
            short(quantile(&milliseconds, 0.99)),
            short(1e6 * seconds / counts.paths.max(1) as f64),
            short(networks.len() as f64 / seconds),
            short(networks.len() as f64 / all),
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}

/// What the paths of all networks needed.
#[derive(Default)]
struct Counts {
    paths: usize,
    accepted: usize,
    rejected: usize,
    jacobians: usize,
}

/// Seconds of each solve on one thread.
fn on_one(networks: &[Pseudoranges]) -> Result<(Vec<f64>, Counts), Failure> {
    let (mut solver, options) = (warm(networks)?, MinimalOptions::default());
    let mut counts = Counts::default();
    let mut seconds = Vec::with_capacity(networks.len());
    for network in networks {
        let started = Instant::now();
        solver.solve(network, &options).map_err(Failure::unusable)?;
        seconds.push(started.elapsed().as_secs_f64());
        counts.paths += solver.records().len();
        for record in solver.records() {
            counts.accepted += record.accepted;
            counts.rejected += record.rejected;
            counts.jacobians += record.jacobians;
        }
    }
    Ok((seconds, counts))
}

/// Seconds for all networks, each thread with a solver of its own.
fn on_all(networks: &[Pseudoranges], threads: usize) -> Result<f64, Failure> {
    let solvers = (0..threads).map(|_| warm(networks)).collect::<Result<Vec<Solver>, Failure>>()?;
    let options = MinimalOptions::default();
    let started = Instant::now();
    let work = solvers.into_par_iter().enumerate().map(|(thread, mut solver)| {
        for network in networks.iter().skip(thread).step_by(threads) {
            solver.solve(network, &options)?;
        }
        Ok(())
    });
    work.collect::<Result<(), MinimalError>>().map_err(Failure::unusable)?;
    Ok(started.elapsed().as_secs_f64())
}

/// A solver that has its start solutions and its memory.
fn warm(networks: &[Pseudoranges]) -> Result<Solver, Failure> {
    let mut solver = Solver::new();
    if let Some(first) = networks.first() {
        solver.solve(first, &MinimalOptions::default()).map_err(Failure::unusable)?;
    }
    Ok(solver)
}
