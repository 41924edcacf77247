//! Trials of the minimal solvers on networks that are hard: far and near nodes, extreme scales,
//! networks next to degenerate ones and degenerate ones.

use serde::Serialize;
use std::f64::consts::TAU;
use tdoa::Network;
use tdoa::Pseudoranges;
use tdoa::accuracy::position_error;
use tdoa::minimal::{MinimalOptions, Solver};

/// A candidate whose positions are this near the truth (relative to the network's size) is the
/// truth.
const FOUND: f64 = 1e-3;

/// What makes a network hard.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub enum Case {
    /// Positions and offsets standard normal.
    Plain,
    /// The first transmitter this many times as far out.
    FarTransmitter(f64),
    /// The second receiver this many times as far out.
    FarReceiver(f64),
    /// All lengths times this.
    Scale(f64),
    /// Offsets times this.
    Offsets(f64),
    /// Receivers at this distance from a line, in units of their spread along it.
    ReceiversNearLine(f64),
    /// Transmitters at this distance from a line.
    TransmittersNearLine(f64),
    /// The first two receivers this near.
    NearReceivers(f64),
    /// The first two transmitters this near.
    NearTransmitters(f64),
    /// Receivers on the unit circle.
    ReceiversOnCircle,
}

impl Case {
    /// The cases of the table.
    pub const ALL: [Case; 20] = [
        Case::Plain,
        Case::FarTransmitter(100.0),
        Case::FarReceiver(100.0),
        Case::Scale(1e-6),
        Case::Scale(1e6),
        Case::Offsets(1e6),
        Case::ReceiversNearLine(1e-3),
        Case::ReceiversNearLine(1e-6),
        Case::ReceiversNearLine(0.0),
        Case::TransmittersNearLine(1e-3),
        Case::TransmittersNearLine(1e-6),
        Case::TransmittersNearLine(0.0),
        Case::NearReceivers(1e-3),
        Case::NearReceivers(1e-6),
        Case::NearReceivers(0.0),
        Case::NearTransmitters(1e-3),
        Case::NearTransmitters(1e-6),
        Case::NearTransmitters(0.0),
        Case::ReceiversOnCircle,
        Case::FarTransmitter(1e4),
    ];

    /// Name for tables.
    pub fn name(self) -> String {
        match self {
            Case::Plain => "plain".into(),
            Case::FarTransmitter(factor) => format!("a transmitter {factor} times as far"),
            Case::FarReceiver(factor) => format!("a receiver {factor} times as far"),
            Case::Scale(factor) => format!("all lengths times {factor:e}"),
            Case::Offsets(factor) => format!("offsets times {factor:e}"),
            Case::ReceiversNearLine(0.0) => "receivers in one line".into(),
            Case::ReceiversNearLine(d) => format!("receivers {d:e} from a line"),
            Case::TransmittersNearLine(0.0) => "transmitters in one line".into(),
            Case::TransmittersNearLine(d) => format!("transmitters {d:e} from a line"),
            Case::NearReceivers(0.0) => "two receivers in one place".into(),
            Case::NearReceivers(d) => format!("two receivers {d:e} apart"),
            Case::NearTransmitters(0.0) => "two transmitters in one place".into(),
            Case::NearTransmitters(d) => format!("two transmitters {d:e} apart"),
            Case::ReceiversOnCircle => "receivers on a circle".into(),
        }
    }

    /// Makes a plain network hard.
    pub fn apply(self, network: &mut Network) {
        match self {
            Case::Plain => {}
            Case::FarTransmitter(factor) => network.transmitters[0] = network.transmitters[0].map(|x| x * factor),
            Case::FarReceiver(factor) => network.receivers[1] = network.receivers[1].map(|x| x * factor),
            Case::Scale(factor) => {
                let nodes = network.receivers.iter_mut().chain(&mut network.transmitters).flatten();
                for x in nodes.chain(&mut network.offsets) {
                    *x *= factor;
                }
            }
            Case::Offsets(factor) => {
                for offset in &mut network.offsets {
                    *offset *= factor;
                }
            }
            Case::ReceiversNearLine(d) => flatten(&mut network.receivers, d),
            Case::TransmittersNearLine(d) => flatten(&mut network.transmitters, d),
            Case::NearReceivers(d) => network.receivers[1] = next_to(network.receivers[0], network.receivers[1], d),
            Case::NearTransmitters(d) => {
                network.transmitters[1] = next_to(network.transmitters[0], network.transmitters[1], d);
            }
            Case::ReceiversOnCircle => {
                let m = network.receivers.len() as f64;
                for (i, r) in network.receivers.iter_mut().enumerate() {
                    // Uneven angles, taken from the coordinate that is given up.
                    let angle = TAU * (i as f64 + 0.3 * r[0].tanh()) / m;
                    *r = [angle.cos(), angle.sin()];
                }
            }
        }
    }
}

/// Brings points nearer to the x axis by a factor.
fn flatten(points: &mut [[f64; 2]], factor: f64) {
    for p in points {
        p[1] *= factor;
    }
}

/// The point at distance `d` from `a` towards `b`.
fn next_to(a: [f64; 2], b: [f64; 2], d: f64) -> [f64; 2] {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    let length = (dx * dx + dy * dy).sqrt();
    [0, 1].map(|k| a[k] + (b[k] - a[k]) * d / length)
}

/// How a case went over all instances.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HardSummary {
    /// Instances.
    pub instances: usize,
    /// Instances in which the true network is among the physical candidates.
    pub found: usize,
    /// Instances that were refused with an error that names the nodes.
    pub refused: usize,
    /// Instances without the truth and without a refusal that were answered with a warning.
    pub warned: usize,
    /// The rest: a wrong answer without a word.
    pub silent: usize,
    /// Paths lost, over all instances.
    pub paths_lost: usize,
    /// Largest relative position error of the found ones.
    pub position_error: f64,
    /// An error message, if there was one.
    pub message: Option<String>,
}

/// Solves networks made hard; `networks` are plain ones.
pub fn hard_trials(solver: &mut Solver, case: Case, networks: impl Iterator<Item = Network>) -> HardSummary {
    let mut summary = HardSummary::default();
    for mut truth in networks {
        case.apply(&mut truth);
        summary.instances += 1;
        let (m, n) = (truth.receivers.len(), truth.transmitters.len());
        let solved = Pseudoranges::new(m, n, truth.pseudoranges())
            .map_err(|e| e.to_string())
            .and_then(|f| solver.solve(&f, &MinimalOptions::default()).map_err(|e| e.to_string()));
        let solution = match solved {
            Ok(solution) => solution,
            Err(message) => {
                summary.refused += 1;
                summary.message.get_or_insert(message);
                continue;
            }
        };
        summary.paths_lost += solution.paths.failed;
        let physical = solution.candidates.iter().filter(|c| c.physical);
        let error = physical.map(|c| position_error(&c.network, &truth)).fold(f64::INFINITY, f64::min);
        if error < FOUND {
            summary.found += 1;
            summary.position_error = summary.position_error.max(error);
        } else if solution.warnings.is_empty() {
            summary.silent += 1;
        } else {
            summary.warned += 1;
        }
    }
    summary
}

#[cfg(test)]
mod tests {
    use super::{Case, hard_trials};
    use tdoa::minimal::Solver;
    use tdoa::{Layout, SimulateOptions, simulate};

    /// What is answered in which way is counted: networks on a circle are found, coincident nodes
    /// refused by name.
    #[test]
    fn answers_are_counted() {
        let networks = || {
            (0..3).map(|seed| {
                let mut options = SimulateOptions::default();
                (options.receivers, options.transmitters, options.seed) = (6, 3, seed);
                options.layout = Layout::Normal;
                simulate(&options).unwrap().network
            })
        };
        let mut solver = Solver::new();
        let found = hard_trials(&mut solver, Case::ReceiversOnCircle, networks());
        assert_eq!((found.instances, found.found, found.refused, found.silent), (3, 3, 0, 0), "{found:?}");
        let refused = hard_trials(&mut solver, Case::NearReceivers(0.0), networks());
        assert_eq!((refused.instances, refused.found, refused.refused), (3, 0, 3), "{refused:?}");
        assert!(refused.message.unwrap().contains("receivers r1 and r2"));
    }
}
