//! `tdoa experiment growth`.

use std::time::Instant;

use crate::trials::calibration::{Trial, trial};
use tdoa::{CalibrateOptions, SimulateOptions, simulate};

use super::common::{Common, Size};
use super::table::Table;
use cli::{Failure, output};

/// Calibrates larger and larger networks with gaps and outliers, one after the other, and takes
/// time and memory.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations, smallest first: memory is the largest so far.
    #[arg(long, default_value = "10r/20s,20r/50s,30r/100s,50r/300s,100r/1000s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Share of missing measurements.
    #[arg(long, default_value_t = 0.3)]
    missing: f64,
    /// Share of outliers.
    #[arg(long, default_value_t = 0.1)]
    outliers: f64,
    #[command(flatten)]
    common: Common,
}

const HEADER: &str = "configuration,missing,outliers,seed,threads,seconds,peak_megabytes,success,rms_over_bound";

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let common = &arguments.common;
    let key = |size: &Size| format!("{size},{},{},{}", arguments.missing, arguments.outliers, common.seed);
    let keys: Vec<String> = arguments.configuration.iter().map(key).collect();
    // One after the other: each network has all threads, and memory is that of the largest so far.
    for last in 0..keys.len() {
        let table = Table::new(common, "trials.csv", HEADER, &keys[..=last], None).one_by_one();
        table.resume(|| (), |(), k| one(arguments, k))?;
    }
    let table = std::fs::read_to_string(common.file("trials.csv")?).map_err(Failure::unusable)?;
    common.write("summary.csv", &table)?;
    output::print(&table)
}

/// The row of one network.
fn one(arguments: &Arguments, k: usize) -> Result<String, Failure> {
    let common = &arguments.common;
    let size = arguments.configuration[k];
    let mut options = SimulateOptions::default();
    (options.receivers, options.transmitters) = (size.receivers, size.transmitters);
    options.noise = 0.01;
    (options.missing, options.outliers, options.seed) = (arguments.missing, arguments.outliers, common.seed);
    let simulation = simulate(&options).map_err(Failure::unusable)?;
    let mut calibrate = CalibrateOptions::default();
    calibrate.seed = common.seed;
    let started = Instant::now();
    let (threads, t): (usize, Trial) = cli::on_threads(common.threads, || {
        (rayon::current_num_threads(), trial(&simulation, 0.01, common.seed, &calibrate))
    })?;
    let seconds = started.elapsed().as_secs_f64();
    let memory = peak_megabytes().map_or_else(String::new, |megabytes| format!("{megabytes:.0}"));
    let ratio = t.receiver_rms.map_or_else(String::new, |rms| format!("{:.3}", rms / t.bound));
    Ok(format!("{threads},{seconds:.2},{memory},{},{ratio}", t.success()))
}

/// The most memory that this process has had so far, where the system tells (Linux).
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().trim_end_matches("kB").trim().parse::<f64>().ok()? / 1024.0)
}
