//! Networks whose errors a calibration may not see: one receiver late by little, receivers without a
//! common clock, gross errors that leave few measurements over, errors that only lengthen. Told are
//! networks that are wrong and called unique. `clean` has no such errors and `gross` one gross
//! error in twenty measurements: false alarms and, by the time of the whole run, what a calibration
//! takes.
//!
//!     cargo run --release -p experiments --example unseen -- late 18

use experiments::trials::calibration::{Trial, judge, oracle};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use tdoa::{CalibrateOptions, Calibration, Errors, ReceiverDelays, ReceiverFault, SimulateOptions, Simulation};
use tdoa::{calibrate, simulate};

const NOISE: f64 = 0.01;

/// A calibration judged, the calibration, and one from the truth judged.
type Run = (Trial, Option<Calibration>, Option<Trial>);

/// Networks and how they are calibrated.
#[derive(Clone)]
struct Case {
    name: String,
    simulate: SimulateOptions,
    calibrate: CalibrateOptions,
    /// Whether each network is calibrated from the truth too.
    oracle: bool,
}

impl Case {
    fn new(name: impl Into<String>, receivers: usize, transmitters: usize) -> Case {
        let mut simulate = SimulateOptions::default();
        (simulate.receivers, simulate.transmitters, simulate.noise) = (receivers, transmitters, NOISE);
        Case { name: name.into(), simulate, calibrate: CalibrateOptions::default(), oracle: false }
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
                        (case.calibrate.receiver_delays, case.calibrate.sigma) = (ReceiverDelays::All, sigma);
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
                        case.oracle = true;
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
        let trial = judge(&simulation, NOISE, seed, 0.0, &found);
        let ideal = self.oracle.then(|| {
            let truth: Vec<_> = simulation.network.receivers.iter().copied().map(Some).collect();
            judge(&simulation, NOISE, seed, 0.0, &oracle(&simulation.pseudoranges, &truth, &options))
        });
        (trial, found.ok(), ideal)
    }

    fn report(&self, first: u64, networks: u64, told: bool) {
        let trials: Vec<_> = (first..first + networks).into_par_iter().map(|seed| self.run(seed)).collect();
        let count = |of: &dyn Fn(&Run) -> bool| trials.iter().filter(|trial| of(trial)).count();
        let unique = count(&|(trial, ..)| trial.unique);
        let mistaken = |trial: &Trial| trial.unique && !trial.among_alternatives();
        let mut ratios: Vec<f64> =
            trials.iter().map(|(trial, ..)| trial.receiver_rms.unwrap_or(f64::INFINITY) / trial.bound).collect();
        ratios.sort_by(f64::total_cmp);
        let named = count(&|(_, found, _)| found.as_ref().is_some_and(|found| !found.receiver_errors.is_empty()));
        let plain = count(&|(trial, ..)| trial.unique && !trial.success());
        println!(
            "{}: {networks} networks, {unique} unique, of them {} wrong and {plain} above three bounds; errors of receivers in {named}; \
             error over bound {:.2} median, {:.2} worst",
            self.name,
            count(&|(trial, ..)| mistaken(trial)),
            ratios[ratios.len() / 2],
            ratios[ratios.len() - 1],
        );
        if self.oracle {
            println!("    right from the truth: {}", count(&|(.., ideal)| ideal.as_ref().is_some_and(Trial::success)));
        }
        let (mut covered, mut ellipses) = (0, 0);
        for (trial, ..) in &trials {
            (covered, ellipses) = (covered + trial.covered, ellipses + trial.ellipses);
        }
        println!("    coverage {:.3}", covered as f64 / ellipses as f64);
        for (trial, found, ideal) in trials.iter().filter(|(trial, ..)| told || trial.unique && !trial.success()) {
            let Some(found) = found else { continue };
            let std = found.receiver_std.iter().flatten().flatten().fold(0.0f64, |a, b| a.max(*b));
            let errors: Vec<String> = (found.receiver_errors.iter())
                .filter(|_| self.calibrate.receiver_delays != ReceiverDelays::All)
                .map(|e| format!("{} {:?} {:.3} gain {:.1}", e.receiver, e.kind, e.size, e.gain))
                .collect();
            let simulation = self.simulation(trial.seed);
            let costs = [
                found.residuals.iter().flatten().flatten().copied().collect(),
                simulation.network.residuals(&simulation.pseudoranges),
            ]
            .map(|residuals: Vec<f64>| residuals.iter().map(|e| (0.5 * (e / NOISE).powi(2)).min(15.0)).sum::<f64>());
            println!(
                "    seed {}: cost {:.1}, unfitted truth {:.1}, error {:.4} m, bound {:.4} m, largest deviation {std:.2e}, sigma {:.4}, redundancy {}, {} of {} starts, unique {}, \
                 from the truth {:?}, {errors:?}",
                trial.seed,
                costs[0],
                costs[1],
                trial.receiver_rms.unwrap_or(f64::NAN),
                trial.bound,
                found.sigma,
                found.redundancy,
                found.agreeing,
                found.starts,
                trial.unique,
                ideal.as_ref().and_then(|ideal| ideal.receiver_rms)
            );
        }
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |k: usize, default: u64| arguments.get(k).and_then(|text| text.parse().ok()).unwrap_or(default);
    let told = arguments.iter().any(|text| text == "--all");
    for case in Case::all(arguments.first().map_or("clean", String::as_str)) {
        case.report(number(2, 5000), number(1, 12).max(1), told);
    }
}
