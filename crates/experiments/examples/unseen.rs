//! Networks whose errors a calibration may not see: one receiver late by little, receivers without a
//! common clock, gross errors that leave few measurements over, errors that only lengthen. Told are
//! networks that are wrong and called unique, beside what the same calibration makes of them that
//! starts at the truth. `clean` has no such errors and `gross` one gross error in twenty measurements:
//! false alarms and, by the time of the whole run, what a calibration takes. Tables go to the output,
//! single networks that are wrong to the error output (`--each`: all of them).
//!
//!     cargo run --release -p experiments --example unseen -- late 18 5000
//!     cargo run --release -p experiments --example unseen -- all 100 60000 > results/unseen.md

use experiments::trials::calibration::{Trial, judge, oracle};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use tdoa::accuracy::{cramer_rao_with_clocks, cramer_rao_with_delays};
use tdoa::{
    CalibrateOptions, Calibration, Errors, ReceiverClocks, ReceiverDelays, ReceiverFault, SimulateOptions, Simulation,
};
use tdoa::{calibrate, simulate};

const NOISE: f64 = 0.01;

/// Networks of each row of `clean`, whose calibrations are cheap, for one of the other rows.
const CHEAP: u64 = 4;

const KINDS: [(&str, &str); 6] = [
    ("clean", "No errors beside noise"),
    ("gross", "Gross errors in 5 % of the measurements"),
    ("late", "One receiver late"),
    ("clocks", "Receivers without a common clock, `--receiver-clocks offset`"),
    ("rivals", "Gross errors that leave few measurements over"),
    ("detours", "Late measurements: detours, exponential with a mean of 0.5 m"),
];

/// A calibration judged, the calibration, and one from the truth judged.
type Run = (Trial, Option<Calibration>, Trial);

/// Networks and how they are calibrated.
#[derive(Clone)]
struct Case {
    name: String,
    simulate: SimulateOptions,
    calibrate: CalibrateOptions,
}

impl Case {
    fn new(name: impl Into<String>, receivers: usize, transmitters: usize) -> Case {
        let mut simulate = SimulateOptions::default();
        (simulate.receivers, simulate.transmitters, simulate.noise) = (receivers, transmitters, NOISE);
        Case { name: name.into(), simulate, calibrate: CalibrateOptions::default() }
    }

    fn all(kind: &str) -> Vec<Case> {
        let mut all = Vec::new();
        match kind {
            "late" => {
                for (size, outliers) in [(0.05, 0.0), (0.1, 0.0), (0.3, 0.0), (0.3, 0.05)] {
                    for delays in [ReceiverDelays::None, ReceiverDelays::Auto] {
                        let name = format!("8r/20s, {size} m late, {outliers} gross errors, {delays:?}");
                        let mut case = Case::new(name, 8, 20);
                        case.simulate.fault = Some(ReceiverFault::Delay(size));
                        case.simulate.outliers = outliers;
                        case.calibrate.receiver_delays = delays;
                        all.push(case);
                    }
                }
            }
            "clocks" => {
                for sigma in [Some(NOISE), None] {
                    for (transmitters, delays) in [(30, 0.1), (30, 1.0), (30, 5.0), (20, 2.0)] {
                        let name = format!("10r/{transmitters}s, clocks {delays} m apart, sigma {sigma:?}");
                        let mut case = Case::new(name, 10, transmitters);
                        case.simulate.delays = delays;
                        (case.calibrate.clocks.receivers, case.calibrate.sigma) = (ReceiverClocks::Offset, sigma);
                        all.push(case);
                    }
                }
            }
            "rivals" => {
                for (receivers, transmitters, wrong) in [(7, 5, 2), (6, 5, 1), (6, 6, 2)] {
                    for sigma in [Some(NOISE), None] {
                        let name = format!("{receivers}r/{transmitters}s, {wrong} gross errors, sigma {sigma:?}");
                        let mut case = Case::new(name, receivers, transmitters);
                        case.simulate.outliers = f64::from(wrong) / (receivers * transmitters) as f64;
                        case.calibrate.sigma = sigma;
                        all.push(case);
                    }
                }
            }
            "detours" => {
                for (receivers, transmitters, share) in [(12, 40, 0.1), (12, 40, 0.3), (12, 40, 0.5), (8, 12, 0.3)] {
                    for errors in [Errors::Symmetric, Errors::OneSided] {
                        let name = format!("{receivers}r/{transmitters}s, {share} of the cells by detours, {errors:?}");
                        let mut case = Case::new(name, receivers, transmitters);
                        (case.simulate.detours, case.simulate.detour_size) = (share, 0.5);
                        case.calibrate.errors = errors;
                        all.push(case);
                    }
                }
            }
            _ => {
                for (receivers, transmitters) in [(6, 10), (8, 12), (8, 20), (10, 30), (12, 40)] {
                    let outliers = if kind == "gross" { 0.05 } else { 0.0 };
                    let mut case = Case::new(format!("{receivers}r/{transmitters}s"), receivers, transmitters);
                    case.simulate.outliers = outliers;
                    all.push(case);
                }
            }
        }
        all
    }

    fn simulation(&self, seed: u64) -> Simulation {
        let mut options = self.simulate.clone();
        options.seed = seed;
        simulate(&options).expect("options within their range")
    }

    fn run(&self, seed: u64) -> Run {
        let simulation = self.simulation(seed);
        let mut options = self.calibrate.clone();
        options.seed = seed;
        let found = calibrate(&simulation.pseudoranges, &options);
        let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
        let ideal = oracle(&simulation.pseudoranges, &truth, &options);
        let judged = [&found, &ideal].map(|result| {
            let mut trial = judge(&simulation, NOISE, seed, 0.0, result);
            let (measured, outliers, truth) = (&simulation.pseudoranges, &simulation.outliers, &simulation.network);
            trial.bound = match self.simulate.fault {
                Some(ReceiverFault::Delay(_)) => cramer_rao_with_delays(measured, outliers, truth, NOISE, &[0]),
                _ => cramer_rao_with_clocks(measured, outliers, truth, NOISE, &self.calibrate.clocks),
            };
            trial
        });
        let [trial, ideal] = judged;
        (trial, found.ok(), ideal)
    }

    /// Prints a row of the table; networks, and how many of them are wrong and unique.
    fn report(&self, first: u64, networks: u64, each: bool) -> [usize; 2] {
        let runs: Vec<Run> = (first..first + networks).into_par_iter().map(|seed| self.run(seed)).collect();
        let count = |of: &dyn Fn(&Run) -> bool| runs.iter().filter(|run| of(run)).count();
        let is_mistaken = |trial: &Trial| trial.unique && !trial.among_alternatives();
        let mistaken = count(&|(trial, ..)| is_mistaken(trial));
        let ratios = |of: &dyn Fn(&Run) -> &Trial| {
            let ratio = |trial: &Trial| trial.receiver_rms.unwrap_or(f64::INFINITY) / trial.bound;
            let mut all: Vec<f64> = runs.iter().map(|run| ratio(of(run))).collect();
            all.sort_by(f64::total_cmp);
            all
        };
        let (own, ideal) = (ratios(&|run| &run.0), ratios(&|run| &run.2));
        let named = |run: &Run| run.1.as_ref().is_some_and(|found| !found.receiver_errors.is_empty());
        let named = count(&named);
        let covered: usize = runs.iter().map(|(trial, ..)| trial.covered).sum();
        let ellipses: usize = runs.iter().map(|(trial, ..)| trial.ellipses).sum();
        println!(
            "| {} | {networks} | {} | {mistaken} | {} | {named} | {:.2} | {:.2} | {:.3} | {} | {:.2} |",
            self.name,
            count(&|(trial, ..)| trial.unique),
            count(&|(trial, ..)| trial.unique && !trial.success()),
            own[own.len() / 2],
            own[own.len() - 1],
            covered as f64 / ellipses as f64,
            count(&|(.., ideal)| ideal.success()),
            ideal[ideal.len() / 2],
        );
        for run in runs.iter().filter(|(trial, ..)| each || is_mistaken(trial)) {
            self.tell(run);
        }
        [runs.len(), mistaken]
    }

    fn tell(&self, (trial, found, ideal): &Run) {
        let Some(found) = found else { return };
        let std = found.receiver_std.iter().flatten().flatten().fold(0.0f64, |a, b| a.max(*b));
        let errors: Vec<String> = (found.receiver_errors.iter())
            .map(|e| format!("{} {:?} {:.3} gain {:.1}", e.receiver, e.kind, e.size, e.gain))
            .collect();
        let simulation = self.simulation(trial.seed);
        let costs = [
            found.residuals.values().iter().map(|residual| residual.length).collect(),
            simulation.network.residuals(&simulation.pseudoranges),
        ]
        .map(|residuals: Vec<f64>| residuals.iter().map(|e| (0.5 * (e / NOISE).powi(2)).min(15.0)).sum::<f64>());
        eprintln!(
            "{}, seed {}: unique {}, cost {:.1}, unfitted truth {:.1}, error {:.4} m, bound {:.4} m, largest deviation {std:.2e}, sigma {:.4}, \
             redundancy {}, {} of {} starts, from the truth {:?}, {errors:?}",
            self.name,
            trial.seed,
            trial.unique,
            costs[0],
            costs[1],
            trial.receiver_rms.unwrap_or(f64::NAN),
            trial.bound,
            found.sigma,
            found.redundancy,
            found.agreeing,
            found.starts,
            ideal.receiver_rms
        );
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| arguments.get(k).and_then(|text| text.parse().ok()).unwrap_or(default);
    let (networks, first) = (number(1, 12).max(1), number(2, 5000));
    let each = arguments.iter().any(|text| text == "--each");
    let kind = arguments.first().map_or("clean", String::as_str);
    let kinds: Vec<_> = KINDS.into_iter().filter(|(name, _)| kind == "all" || kind == *name).collect();
    if kinds.is_empty() {
        eprintln!("no such kind of networks: {kind}; there are all, {}", KINDS.map(|(name, _)| name).join(", "));
        std::process::exit(2);
    }
    println!("# Networks whose errors a calibration may not see");
    println!();
    println!(
        "`cargo run --release -p experiments --example unseen -- {kind} {networks} {first}`. Networks in a room of 10 m, noise of 0.01 m, \
         seeds from {first} on. Errors are root mean squares over the receivers after the best rigid alignment, over the Cramer-Rao bound of \
         the measurements that are no outliers (with delays unknown where receivers have some). Wrong: off by more than three bounds and 2 % \
         of the network's size. From the truth: the same calibration started there."
    );
    let mut total = [0, 0];
    for (name, title) in kinds {
        println!();
        println!("## {title}");
        println!();
        println!(
            "| networks of | number | unique | wrong and unique | above three bounds and unique | a receiver's error named | median error \
             | worst | coverage of 95 % ellipses | from the truth within three bounds | median error |"
        );
        println!("|{}", "---|".repeat(11));
        for case in Case::all(name) {
            let networks = if kind == "all" && name == "clean" { CHEAP * networks } else { networks };
            let [runs, mistaken] = case.report(first, networks, each);
            total = [total[0] + runs, total[1] + mistaken];
        }
    }
    println!();
    let share = 100.0 * total[1] as f64 / total[0] as f64;
    println!("Of all {} networks {} are wrong and called unique: {share:.2} %.", total[0], total[1]);
}
