//! Trials of the minimal solvers on networks that are hard: far and near nodes, extreme scales, networks next to degenerate ones and
//! degenerate ones.

use super::clean::position_error_of;
use crate::minimal::{SolveOptions, Solver};
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use serde::Serialize;
use std::f64::consts::TAU;

/// A candidate whose positions are this near the truth (relative to the network's size) is the truth.
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
                nodes.chain(&mut network.offsets).for_each(|x| *x *= factor);
            }
            Case::Offsets(factor) => network.offsets.iter_mut().for_each(|o| *o *= factor),
            Case::ReceiversNearLine(d) => network.receivers.iter_mut().for_each(|r| r[1] *= d),
            Case::TransmittersNearLine(d) => network.transmitters.iter_mut().for_each(|s| s[1] *= d),
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

/// The point at distance `d` from `a` towards `b`.
fn next_to(a: [f64; 2], b: [f64; 2], d: f64) -> [f64; 2] {
    let length = crate::plane::distance(a, b);
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
            .and_then(|f| solver.solve(&f, &SolveOptions::default()).map_err(|e| e.to_string()));
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
        let error = physical.map(|c| position_error_of(&c.network, &truth)).fold(f64::INFINITY, f64::min);
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
    use crate::minimal::{Nodes, SolveOptions, SolveWarning, Solver};
    use crate::network::{Candidate, Network};
    use crate::plane::flatness;
    use crate::pseudoranges::Pseudoranges;
    use crate::simulate::{Layout, SimulateOptions, simulate};

    fn networks(count: u64) -> impl Iterator<Item = crate::network::Network> {
        (0..count).map(|seed| {
            let options = SimulateOptions {
                receivers: 6,
                transmitters: 3,
                layout: Layout::Normal,
                noise: 0.0,
                seed,
                ..SimulateOptions::default()
            };
            simulate(&options).unwrap().network
        })
    }

    #[test]
    fn scales_and_far_nodes_are_no_obstacle() {
        let mut solver = Solver::new();
        for case in [Case::Scale(1e-6), Case::Scale(1e6), Case::FarTransmitter(100.0), Case::ReceiversOnCircle] {
            let summary = hard_trials(&mut solver, case, networks(4));
            assert_eq!(summary.found, 4, "{case:?}: {summary:?}");
        }
    }

    #[test]
    fn nodes_that_nearly_coincide_lose_no_path() {
        // Their roots are regular, though no Jacobian in doubles tells.
        for case in [Case::NearTransmitters(1e-6), Case::NearReceivers(1e-6)] {
            let summary = hard_trials(&mut Solver::new(), case, networks(4));
            assert_eq!((summary.found, summary.paths_lost), (4, 0), "{case:?}: {summary:?}");
        }
    }

    #[test]
    fn nodes_in_one_line_are_found_and_named() {
        for (case, kind, nodes, others) in [
            (Case::ReceiversNearLine(0.0), Nodes::Receivers, 6, 3),
            (Case::TransmittersNearLine(0.0), Nodes::Transmitters, 3, 6),
        ] {
            let mut solver = Solver::new();
            let summary = hard_trials(&mut solver, case, networks(4));
            assert_eq!(summary.found, 4, "{case:?}: {summary:?}");
            let mut network = networks(1).next().unwrap();
            case.apply(&mut network);
            let measured = Pseudoranges::new(6, 3, network.pseudoranges()).unwrap();
            let solution = solver.solve(&measured, &SolveOptions::default()).unwrap();
            let in_line = solution.warnings.iter().find_map(|warning| match warning {
                SolveWarning::InOneLine { kind, names, listed: true } => Some((*kind, names.len())),
                _ => None,
            });
            assert_eq!(in_line, Some((kind, nodes)), "{:?}", solution.warnings);
            // Every mirror image fits as well, and no network stands there twice.
            let flat = |c: &&Candidate| c.physical && c.residual < 1e-12 && flatness(kind.positions(&c.network)) < 1e-9;
            assert_eq!(solution.candidates.iter().filter(flat).count(), 1 << (others - 1), "{case:?}");
        }
    }

    #[test]
    fn a_symmetric_network_ends_in_time_and_says_what_is_lost() {
        // Such data have roots next to which pivots vanish: their paths come as near as doubles allow and no farther.
        let corner = |k: u32| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
            [cos, sin]
        };
        let network = Network {
            receivers: (0..6).map(corner).collect(),
            transmitters: vec![[2.0, 0.0], [0.0, 2.0], [-1.5, 0.0]],
            offsets: vec![0.0; 3],
        };
        let measured = Pseudoranges::new(6, 3, network.pseudoranges()).unwrap();
        let mut solver = Solver::new();
        let solution = solver.solve(&measured, &SolveOptions::default()).unwrap();
        let lost = solution.paths.failed;
        assert!(
            lost > 0 && solution.warnings.contains(&SolveWarning::PathsLost { lost, tracked: 180 }),
            "{solution:?}"
        );
        // About 64 paths with six charts of 1,600 steps in the last round, not four rounds of up to 102,400.
        let steps: usize = solver.records().iter().map(|r| r.accepted + r.rejected).sum();
        assert!(steps < 2_000_000, "{steps}");
    }

    #[test]
    fn coincident_nodes_are_refused_by_name() {
        let summary = hard_trials(&mut Solver::new(), Case::NearReceivers(0.0), networks(3));
        assert_eq!(summary.refused, 3, "{summary:?}");
        assert!(summary.message.unwrap().contains("receivers r1 and r2"));
    }
}
