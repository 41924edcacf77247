//! The minimal solvers on networks of extreme scales, next to degenerate ones, and degenerate.

use crate::common::clean;
use tdoa::accuracy::position_error;
use tdoa::minimal::{MinimalOptions, MinimalWarning, NodeKind, Solver};
use tdoa::{Candidate, MinimalSolution, Network, Pseudoranges};

/// Solves networks of 6 receivers and 3 transmitters made hard: the truth is found in each.
fn all_found(count: u64, harden: impl Fn(&mut Network)) -> Vec<MinimalSolution> {
    let mut solver = Solver::new();
    let mut solutions = Vec::new();
    for seed in 0..count {
        let mut truth = clean(6, 3, seed).network;
        harden(&mut truth);
        let measured = Pseudoranges::new(6, 3, truth.pseudoranges()).unwrap();
        let solution = solver.solve(&measured, &MinimalOptions::default()).unwrap();
        let found = |c: &Candidate| c.physical && position_error(&c.network, &truth) < 1e-3;
        assert!(solution.candidates.iter().any(found), "seed {seed}");
        solutions.push(solution);
    }
    solutions
}

#[test]
fn scales_and_far_nodes_are_no_obstacle() {
    for factor in [1e-6, 1e6] {
        all_found(4, |network| {
            let nodes = network.receivers.iter_mut().chain(&mut network.transmitters).flatten();
            for x in nodes.chain(&mut network.offsets) {
                *x *= factor;
            }
        });
    }
    all_found(4, |network| network.transmitters[0] = network.transmitters[0].map(|x| 100.0 * x));
    // Receivers on the unit circle, at uneven angles.
    all_found(4, |network| {
        for (i, r) in network.receivers.iter_mut().enumerate() {
            let angle = std::f64::consts::TAU * (i as f64 + 0.3 * r[0].tanh()) / 6.0;
            *r = [angle.cos(), angle.sin()];
        }
    });
}

/// The point at distance 1e-6 from `a` towards `b`.
fn next_to(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let length = (b[0] - a[0]).hypot(b[1] - a[1]);
    [0, 1].map(|k| a[k] + (b[k] - a[k]) * 1e-6 / length)
}

#[test]
fn nodes_that_nearly_coincide_lose_no_path() {
    // Their roots are regular, though no Jacobian in doubles tells.
    let transmitters = |n: &mut Network| n.transmitters[1] = next_to(n.transmitters[0], n.transmitters[1]);
    let receivers = |n: &mut Network| n.receivers[1] = next_to(n.receivers[0], n.receivers[1]);
    for solution in all_found(4, transmitters).iter().chain(&all_found(4, receivers)) {
        assert_eq!(solution.paths.failed, 0);
    }
}

/// Largest distance of a point from the line through the first and the one farthest from it, over
/// the distance of these two.
fn flatness(points: &[[f64; 2]]) -> f64 {
    let from_first = |p: &[f64; 2]| [p[0] - points[0][0], p[1] - points[0][1]];
    let length = |v: [f64; 2]| v[0].hypot(v[1]);
    let far = points.iter().map(from_first).max_by(|a, b| length(*a).total_cmp(&length(*b))).unwrap();
    let across = |v: [f64; 2]| (v[0] * far[1] - v[1] * far[0]).abs() / length(far).powi(2);
    points.iter().map(from_first).map(across).fold(0.0, f64::max)
}

#[test]
fn nodes_in_one_line_are_found_and_named() {
    for (kind, nodes, others) in [(NodeKind::Receivers, 6, 3), (NodeKind::Transmitters, 3, 6)] {
        let solutions = all_found(4, |network| {
            let line = if kind == NodeKind::Receivers { &mut network.receivers } else { &mut network.transmitters };
            for p in line {
                p[1] = 0.0;
            }
        });
        for solution in solutions {
            let in_line = solution.warnings.iter().find_map(|warning| match warning {
                MinimalWarning::InOneLine { kind, names, listed: true } => Some((*kind, names.len())),
                _ => None,
            });
            assert_eq!(in_line, Some((kind, nodes)), "{:?}", solution.warnings);
            // Every mirror image fits as well, and no network stands there twice.
            let flat = |c: &&Candidate| {
                let network = &c.network;
                let line = if kind == NodeKind::Receivers { &network.receivers } else { &network.transmitters };
                c.physical && c.residual < 1e-12 && flatness(line) < 1e-9
            };
            assert_eq!(solution.candidates.iter().filter(flat).count(), 1 << (others - 1), "{kind}");
        }
    }
}

#[test]
fn a_symmetric_network_ends_in_time_and_says_what_is_lost() {
    // Such data have roots next to which pivots vanish: their paths come as near as doubles allow
    // and no farther.
    let corner = |k: u32| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_3).sin_cos();
        [cos, sin]
    };
    let network = Network::new((0..6).map(corner).collect(), vec![[2.0, 0.0], [0.0, 2.0], [-1.5, 0.0]], vec![0.0; 3]);
    let measured = Pseudoranges::new(6, 3, network.pseudoranges()).unwrap();
    let mut solver = Solver::new();
    let solution = solver.solve(&measured, &MinimalOptions::default()).unwrap();
    let lost = solution.paths.failed;
    assert!(lost > 0 && solution.warnings.contains(&MinimalWarning::PathsLost { lost, tracked: 180 }), "{solution:?}");
    // About 64 paths with six charts of 1,600 steps in the last round, not four rounds of up to
    // 102,400.
    let steps: usize = solver.records().iter().map(|r| r.accepted + r.rejected).sum();
    assert!(steps < 2_000_000, "{steps}");
}

#[test]
fn coincident_nodes_are_refused_by_name() {
    for seed in 0..3 {
        let mut network = clean(6, 3, seed).network;
        network.receivers[1] = network.receivers[0];
        let measured = Pseudoranges::new(6, 3, network.pseudoranges()).unwrap();
        let error = Solver::new().solve(&measured, &MinimalOptions::default()).unwrap_err();
        assert!(error.to_string().contains("receivers r1 and r2"), "{error}");
    }
}
