//! `tdoa experiment noise`.

use crate::trials::noise::noise_trial;
use tdoa::minimal::Solver;

use super::chart::{Labels, Series, curves};
use super::common::{Common, Size, normal};
use super::statistics::short;
use super::table::Table;
use crate::quantile::{median, quantile};
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Solves noisy random networks and sets the errors against the noise, without and with refinement
/// (the lower row of the paper's figure 1).
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "6r/4s,7r/3s,5r/4s,5r/5s,6r/3s,4r/5s,4r/6s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Standard deviations of the noise, in units of the standard deviation of the positions.
    #[arg(long, default_value = "1e-6,1e-5,1e-4,1e-3,1e-2,1e-1", value_delimiter = ',')]
    noise: Vec<f64>,
    /// Number of networks a configuration and noise.
    #[arg(long, default_value_t = 1000)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

const HEADER: &str = "configuration,noise,seed,position_raw,offset_raw,position_refined,offset_refined";

/// The measured errors.
const ERRORS: [&str; 4] = ["position_raw", "position_refined", "offset_raw", "offset_refined"];

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let common = &arguments.common;
    let mut trials: Vec<(Size, f64, u64)> = Vec::new();
    for &size in &arguments.configuration {
        for &noise in &arguments.noise {
            trials.extend(common.seeds(arguments.instances).map(|seed| (size, noise, seed)));
        }
    }
    let keys: Vec<String> = trials.iter().map(|(size, noise, seed)| format!("{size},{noise:e},{seed}")).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(Solver::new, |solver, k| {
        let (size, noise, seed) = trials[k];
        let trial = noise_trial(solver, &normal(size, noise, seed)?, noise).map_err(Failure::unusable)?;
        let ([a, b], [c, d]) = (trial.raw, trial.refined);
        Ok(format!("{a:.3e},{b:.3e},{c:.3e},{d:.3e}"))
    })?;
    let Some(rows) = rows else { return Ok(()) };
    let mut summary = String::from("configuration,noise,instances,without_candidate");
    for error in ERRORS {
        summary += &format!(",{error}_median,{error}_90");
    }
    summary += "\n";
    let each = arguments.instances as usize;
    for (g, &size) in arguments.configuration.iter().enumerate() {
        let mut points = [const { Vec::new() }; 4];
        for (l, &noise) in arguments.noise.iter().enumerate() {
            let first = (g * arguments.noise.len() + l) * each;
            let of = |error: &str| rows.numbers(error, first..first + each);
            let none = of("position_refined").iter().filter(|error| error.is_infinite()).count();
            summary += &format!("{size},{noise:e},{each},{none}");
            for error in ERRORS {
                let all = of(error);
                summary += &format!(",{},{}", short(median(&all)), short(quantile(&all, 0.9)));
            }
            summary += "\n";
            let drawn =
                [("position_raw", 0.5), ("position_refined", 0.5), ("position_raw", 0.9), ("position_refined", 0.9)];
            for (points, (error, share)) in points.iter_mut().zip(drawn) {
                points.push((noise, quantile(&of(error), share)));
            }
        }
        let names = ["median", "median, refined", "90 %", "90 %, refined"];
        let series: Vec<Series> =
            names.into_iter().zip(points).map(|(name, points)| Series { name: name.into(), points }).collect();
        let labels = Labels {
            title: format!("{size}, {each} networks a point"),
            x: "standard deviation of the noise".into(),
            y: "relative position error".into(),
        };
        common.write(&format!("{}.svg", size.file()), &curves(&labels, &series))?;
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
