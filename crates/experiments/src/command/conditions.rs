//! `tdoa experiment conditions`: networks as deployments bring them, beside the truth, the
//! Cramer-Rao bound and the oracle.

use crate::quantile::median;
use crate::trials::calibration::{Trial, judge, oracle};
use tdoa::{
    CalibrateOptions, Layout, ReceiverClocks, ReceiverDelays, ReceiverFault, SimulateOptions, calibrate, simulate,
};

use super::book::Rows;
use super::common::{Common, thread_seconds};
use super::statistics::short;
use super::table::Table;
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Calibrates networks that nobody hears whole, with gross errors in few measurements, and with
/// receivers that have errors of their own.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Names of conditions (their beginnings are enough); all if not given.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// Number of networks of each.
    #[arg(long, default_value_t = 100)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

/// One kind of network and how it is calibrated.
struct Condition {
    name: String,
    simulate: SimulateOptions,
    known_sigma: bool,
    /// Factor on the deviation that the calibration is told.
    told: f64,
    delays: ReceiverDelays,
    clocks: ReceiverClocks,
    /// Part of the warning that this condition should raise.
    warning: &'static str,
}

impl Condition {
    fn new(name: &str, receivers: usize, transmitters: usize) -> Self {
        let mut simulate = SimulateOptions::default();
        (simulate.receivers, simulate.transmitters, simulate.noise) = (receivers, transmitters, 0.01);
        Condition {
            name: name.into(),
            simulate,
            known_sigma: false,
            told: 1.0,
            delays: ReceiverDelays::None,
            clocks: ReceiverClocks::Common,
            warning: "seem",
        }
    }

    fn all() -> Vec<Condition> {
        let mut all = Vec::new();
        for (name, receivers, transmitters, layout) in [
            ("chain 60r over 1 km", 60, 300, Layout::Chain { extent: [1000.0, 50.0] }),
            ("chain 30r over 500 m", 30, 150, Layout::Chain { extent: [500.0, 50.0] }),
            ("grid 8 x 8 over 1 km", 64, 400, Layout::Grid { extent: [1000.0, 1000.0] }),
        ] {
            let mut condition = Condition::new(name, receivers, transmitters);
            condition.simulate.layout = layout;
            condition.simulate.hearing = Some(8);
            (condition.simulate.noise, condition.simulate.outliers, condition.simulate.outlier_size) =
                (0.1, 0.02, 100.0);
            condition.warning = "in parts only";
            all.push(condition);
        }
        for (receivers, transmitters, outliers) in
            [(6, 5, 0.0), (6, 5, 0.033), (6, 6, 0.0), (6, 6, 0.056), (7, 5, 0.0), (7, 5, 0.057), (8, 8, 0.1)]
        {
            for known_sigma in [true, false] {
                let known = if known_sigma { "known" } else { "unknown" };
                let name = format!("outliers {outliers} of {receivers}r/{transmitters}s sigma {known}");
                let mut condition = Condition::new(&name, receivers, transmitters);
                (condition.simulate.outliers, condition.known_sigma) = (outliers, known_sigma);
                all.push(condition);
            }
        }
        for (name, fault) in [
            ("clean", None),
            ("delay 0.3 m", Some(ReceiverFault::Delay(0.3))),
            ("drift 0.5 m", Some(ReceiverFault::Drift(0.5))),
            ("move 1 m", Some(ReceiverFault::Move(1.0))),
        ] {
            for (handling, delays) in [("none", ReceiverDelays::None), ("auto", ReceiverDelays::Auto)] {
                let mut condition = Condition::new(&format!("receiver {name}, delays {handling}"), 10, 20);
                (condition.simulate.fault, condition.delays) = (fault, delays);
                all.push(condition);
            }
        }
        for (handling, clocks) in [("common", ReceiverClocks::Common), ("offset", ReceiverClocks::Offset)] {
            let mut condition = Condition::new(&format!("receivers unsynchronised by 2 m, clocks {handling}"), 10, 20);
            (condition.simulate.delays, condition.clocks) = (2.0, clocks);
            all.push(condition);
        }
        for told in [1.0, 0.67, 0.5, 0.2] {
            let mut condition = Condition::new(&format!("sigma told {told} times"), 10, 20);
            (condition.known_sigma, condition.told, condition.warning) = (true, told, "as large as the given");
            all.push(condition);
        }
        all
    }

    fn row(&self, seed: u64) -> Result<String, Failure> {
        let mut simulated = self.simulate.clone();
        simulated.seed = seed;
        let simulation = simulate(&simulated).map_err(Failure::unusable)?;
        let mut options = CalibrateOptions::default();
        options.seed = seed;
        options.sigma = Some(self.told * simulated.noise).filter(|_| self.known_sigma);
        options.receiver_delays = self.delays;
        options.clocks.receivers = self.clocks;
        let started = thread_seconds();
        let found = calibrate(&simulation.pseudoranges, &options);
        let seconds = thread_seconds() - started;
        let warnings = found.as_ref().map_or(&[][..], |found| &found.warnings);
        let warned = warnings.iter().any(|warning| warning.contains(self.warning));
        let trial = judge(&simulation, simulated.noise, seed, seconds, &found);
        let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
        let ideal = oracle(&simulation.pseudoranges, &truth, &options);
        let ideal = judge(&simulation, simulated.noise, seed, 0.0, &ideal);
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| format!("{value:.4e}"));
        let Trial { bound, covered, ellipses, unique, .. } = trial;
        Ok(format!(
            "{},{},{},{unique},{warned},{},{},{bound:.4e},{covered},{ellipses},{seconds:.4}",
            trial.success(),
            ideal.success(),
            trial.among_alternatives(),
            number(trial.receiver_rms),
            number(ideal.receiver_rms),
        ))
    }
}

const HEADER: &str = "condition,seed,success,oracle,among_alternatives,unique,warned,receiver_rms,oracle_rms,bound,covered,ellipses,\
                      processor_seconds";

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    if arguments.instances == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    let common = &arguments.common;
    let mut conditions = Condition::all();
    let named = |name: &str| arguments.only.is_empty() || arguments.only.iter().any(|only| name.starts_with(only));
    conditions.retain(|condition| named(&condition.name));
    let cells: Vec<(&Condition, u64)> = conditions
        .iter()
        .flat_map(|condition| common.seeds(arguments.instances).map(move |seed| (condition, seed)))
        .collect();
    let key = |condition: &Condition| condition.name.replace(',', ";");
    let keys: Vec<String> = cells.iter().map(|(condition, seed)| format!("{},{seed}", key(condition))).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(|| (), |(), k| cells[k].0.row(cells[k].1))?;
    let Some(rows) = rows else { return Ok(()) };
    report(common, &rows, &conditions, arguments.instances as usize)
}

fn report(common: &Common, rows: &Rows, conditions: &[Condition], each: usize) -> Result<(), Failure> {
    let mut summary = String::from(
        "condition,networks,success,oracle,among_alternatives,unique,unique_and_wrong,warned,rms_median,bound_median,coverage_95,\
         processor_seconds_median\n",
    );
    for (g, condition) in conditions.iter().enumerate() {
        let of = |column: &str| rows.numbers(column, g * each..(g + 1) * each);
        let share = |all: &[f64]| all.iter().sum::<f64>() / each as f64;
        let (among, unique) = (of("among_alternatives"), of("unique"));
        let wrong: Vec<f64> = unique.iter().zip(&among).map(|(u, a)| u * (1.0 - a)).collect();
        let cells = [
            condition.name.replace(',', ";"),
            each.to_string(),
            short(share(&of("success"))),
            short(share(&of("oracle"))),
            short(share(&among)),
            short(share(&unique)),
            short(share(&wrong)),
            short(share(&of("warned"))),
            short(median(&of("receiver_rms"))),
            short(median(&of("bound"))),
            short(of("covered").iter().sum::<f64>() / of("ellipses").iter().sum::<f64>()),
            short(median(&of("processor_seconds"))),
        ];
        summary += &(cells.join(",") + "\n");
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
