//! `tdoa experiment dimension`.

use super::common::{Common, Size, thread_seconds};
use super::statistics::short;
use super::table::Table;
use crate::quantile::{median, quantile};
use cli::{Failure, output};
use hc::ranks::Ranks;
use tdoa::calibrate::{Calibrated, calibrate_either};
use tdoa::{CalibrateOptions, Layout, Pseudoranges, SimulateOptions, simulate};

/// Calibrates networks in the plane and in rooms, of whose dimension nothing is said, and counts where
/// they end.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "8r/12s,10r/20s,12r/40s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Heights of the room of 10 m by 8 m, metres; 0 is the plane.
    #[arg(long, default_value = "0,3", value_delimiter = ',')]
    height: Vec<f64>,
    /// Shares of outliers.
    #[arg(long, default_value = "0,0.05", value_delimiter = ',')]
    outliers: Vec<f64>,
    /// Number of networks of each kind.
    #[arg(long, default_value_t = 167)]
    instances: u64,
    /// Standard deviation of the noise, metres.
    #[arg(long, default_value_t = 0.01)]
    noise: f64,
    #[command(flatten)]
    common: Common,
}

/// One kind of network.
#[derive(Clone, Copy)]
struct Case {
    size: Size,
    height: f64,
    outliers: f64,
    noise: f64,
}

const HEADER: &str = "configuration,height,outliers,noise,seed,calibrated,space,gain,needed,processor_seconds";

impl Case {
    /// The columns before the seed.
    fn key(&self) -> String {
        let Case { size, height, outliers, noise } = self;
        format!("{size},{height},{outliers},{noise}")
    }

    fn measured(&self, seed: u64) -> Result<Pseudoranges, Failure> {
        if self.height == 0.0 {
            return self.simulate([10.0, 8.0], seed);
        }
        self.simulate([10.0, 8.0, self.height], seed)
    }

    fn simulate<const D: usize>(&self, extent: [f64; D], seed: u64) -> Result<Pseudoranges, Failure> {
        let mut options = SimulateOptions::<D>::new();
        (options.receivers, options.transmitters) = (self.size.receivers, self.size.transmitters);
        (options.layout, options.noise, options.outliers) = (Layout::Room { extent }, self.noise, self.outliers);
        options.seed = seed;
        Ok(simulate(&options).map_err(Failure::unusable)?.pseudoranges)
    }

    fn row(&self, seed: u64) -> Result<String, Failure> {
        let measured = self.measured(seed)?;
        let mut options = CalibrateOptions::new();
        options.seed = seed;
        let started = thread_seconds();
        let found = calibrate_either(&measured, &options, &Default::default());
        let seconds = thread_seconds() - started;
        let (space, test) = match &found {
            Ok(Calibrated::Plane(found)) => (false, found.dimension_test),
            Ok(Calibrated::Space(found)) => (true, found.dimension_test),
            // No network is a failure of the run, not of the experiment.
            Err(_) => return Ok(format!("false,false,,,{seconds:.4}")),
        };
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.5e}"));
        let gain = test.and_then(|test| test.gain);
        let needed = test.and_then(|test| test.needed);
        Ok(format!("true,{space},{},{},{seconds:.4}", number(gain), number(needed)))
    }
}

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if arguments.instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let common = &arguments.common;
    let mut cases = Vec::new();
    for &size in &arguments.configuration {
        for &height in &arguments.height {
            let noise = arguments.noise;
            cases.extend(arguments.outliers.iter().map(|&outliers| Case { size, height, outliers, noise }));
        }
    }
    let all: Vec<(Case, u64)> =
        cases.iter().flat_map(|&case| common.seeds(arguments.instances).map(move |seed| (case, seed))).collect();
    let keys: Vec<String> = all.iter().map(|(case, seed)| format!("{},{seed}", case.key())).collect();
    let rows = Table::new(common, "trials.csv", HEADER, &keys, ranks).resume(|| (), |(), k| all[k].0.row(all[k].1))?;
    let Some(rows) = rows else { return Ok(()) };
    let mut summary = String::from(
        "configuration,height,outliers,noise,networks,in_the_plane,in_space,not_calibrated,gain_over_needed_1,gain_over_needed_50,\
         gain_over_needed_99,processor_seconds_median\n",
    );
    let each = arguments.instances as usize;
    for (g, case) in cases.iter().enumerate() {
        let of = |column: &str| rows.numbers(column, g * each..(g + 1) * each);
        let count = |column: &str| of(column).iter().filter(|is| **is == 1.0).count();
        let (calibrated, space) = (count("calibrated"), count("space"));
        let ratios = of("gain").into_iter().zip(of("needed")).map(|(gain, needed)| gain / needed);
        let ratios: Vec<f64> = ratios.filter(|ratio| !ratio.is_nan()).collect();
        summary += &format!(
            "{},{each},{},{space},{},{},{},{},{}\n",
            case.key(),
            calibrated - space,
            each - calibrated,
            short(quantile(&ratios, 0.01)),
            short(median(&ratios)),
            short(quantile(&ratios, 0.99)),
            short(median(&of("processor_seconds"))),
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
