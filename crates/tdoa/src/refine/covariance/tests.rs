//! Covariances against dense algebra.

use super::*;
use crate::clocks::Emissions;
use crate::clocks::tests::{EXPECTED, Model, SIGMA, expecting, models};
use crate::distances::ReceiverDistance;
use crate::network::tests::random;
use crate::observations::{Level, Node, Pin};
use crate::points::distance;
use crate::pseudoranges::Pseudoranges;
use crate::simulate::{SimulateOptions, simulate};
use faer::linalg::solvers::DenseSolveCore;

#[test]
fn receivers_that_are_all_held_have_no_error() {
    let simulation = simulate(&SimulateOptions::default()).unwrap();
    let held = vec![true; simulation.pseudoranges.receivers()];
    let observations = Observations::<2>::new(&simulation.pseudoranges, |_, _| true).holding(&held);
    let found = covariance(&observations, &simulation.network, 0.1, &Monitor::default()).unwrap().unwrap();
    assert!(found.loose.is_empty() && found.receivers.iter().flatten().flatten().all(|&c| c == 0.0));
    assert!(found.transmitters.iter().all(|c| c.is_some_and(|c| c.rows[0][0] > 0.0 && c.rows[1][1] > 0.0)));
}

/// The covariance from the full normal equations with the inner constraint as a border, by dense
/// algebra.
fn agrees_with_bordered_equations<const D: usize>(m: usize, n: usize) {
    let network: Network<D> = random(m, n, 5);
    let mut values = network.pseudoranges();
    values[3] = f64::NAN;
    let observations = Observations::new(&Pseudoranges::new(m, n, values).unwrap(), |_, _| true);
    let (size, motions) = (D * m + (D + 1) * n, D * (D + 1) / 2);
    let mut jacobian = Mat::<f64>::zeros(observations.len(), size);
    for (k, o) in observations.all().iter().enumerate() {
        let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
        let at = D * m + (D + 1) * o.transmitter;
        for axis in 0..D {
            let u = (s[axis] - r[axis]) / network.distance(o.receiver, o.transmitter);
            (jacobian[(k, D * o.receiver + axis)], jacobian[(k, at + axis)]) = (-u, u);
        }
        jacobian[(k, at + D)] = 1.0;
    }
    let mut bordered = Mat::<f64>::zeros(size + motions, size + motions);
    bordered.submatrix_mut(0, 0, size, size).copy_from(jacobian.transpose() * &jacobian);
    for (i, r) in network.receivers.iter().enumerate() {
        let mut next = size;
        for k in 0..D {
            (bordered[(D * i + k, next)], bordered[(next, D * i + k)]) = (1.0, 1.0);
            next += 1;
            for l in 0..k {
                (bordered[(D * i + k, next)], bordered[(next, D * i + k)]) = (r[l], r[l]);
                (bordered[(D * i + l, next)], bordered[(next, D * i + l)]) = (-r[k], -r[k]);
                next += 1;
            }
        }
    }
    let expected = bordered.partial_piv_lu().inverse();
    let sigma = 0.02;
    let found = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
    assert!(found.loose.is_empty());
    let close = |found: f64, a: usize, b: usize| {
        let want = sigma * sigma * expected[(a, b)];
        assert!((found - want).abs() < 1e-8 * want.abs().max(sigma * sigma), "{a} {b}: {found} {want}");
    };
    for a in 0..D * m {
        for b in 0..D * m {
            close(found.joint[a * D * m + b], a, b);
            if a / D == b / D {
                close(found.receivers[a / D][a % D][b % D], a, b);
            }
        }
    }
    for (j, found) in found.transmitters.iter().enumerate() {
        let (at, found) = (D * m + (D + 1) * j, found.unwrap());
        for a in 0..D {
            for b in 0..D {
                close(found.rows[a][b], at + a, at + b);
            }
            close(found.border[a], at + D, at + a);
        }
        close(found.corner, at + D, at + D);
    }
}

#[test]
fn agrees_with_the_bordered_normal_equations() {
    agrees_with_bordered_equations::<2>(6, 5);
    agrees_with_bordered_equations::<3>(8, 9);
}

#[test]
fn a_receiver_that_may_move_in_space_is_loose() {
    let network: Network<3> = random(24, 9, 6);
    let mut values = network.pseudoranges();
    // Two measurements of the third receiver are left.
    values[2 * 9 + 2..3 * 9].fill(f64::NAN);
    let measured = Pseudoranges::new(24, 9, values).unwrap();
    let loose = |held: &[usize]| {
        let held: Vec<bool> = (0..24).map(|i| held.contains(&i)).collect();
        let observations = Observations::new(&measured, |_, _| true).holding(&held);
        covariance(&observations, &network, 0.1, &Monitor::default()).unwrap().unwrap().loose
    };
    // Where nothing is held, others move a little against it.
    assert!(loose(&[]).contains(&2));
    assert_eq!(loose(&[0, 1, 3]), [2]);
    assert!(loose(&[0, 1, 2, 3]).is_empty());
}

/// Against the inverse of the equations of nodes and levels, by dense algebra.
#[test]
fn levels_are_unknowns() {
    let (m, n, sigma) = (7, 9, 0.02);
    let network: Network<3> = random(m, n, 5);
    let measured = Pseudoranges::new(m, n, network.pseudoranges()).unwrap();
    let nodes = (0..m).map(Node::Receiver).chain((0..n).map(Node::Transmitter));
    // All three axes, so that no rigid motion is left.
    let pin = |node, axis| Pin { node, axis, value: 0.0, precision: [0.7, 0.9, 2.0][axis] };
    let pins: Vec<Pin> = nodes.flat_map(|node| (0..3).map(move |axis| pin(node, axis))).collect();
    let share = |of: fn(Node) -> f64| -> Vec<f64> {
        pins.iter().map(|pin| if pin.axis == 2 { of(pin.node) } else { 0.0 }).collect()
    };
    let levels = [
        (share(|node| f64::from(u8::from(matches!(node, Node::Transmitter(_))))), 0.3),
        (share(|node| if let Node::Receiver(i) = node { [1.0, -1.0][i % 2] } else { 0.0 }), 0.5),
    ]
    .map(|(shares, precision)| Level { shares, precision });
    let observations = Observations::<3>::new(&measured, |_, _| true).pinned(&pins).levelled(levels.to_vec());

    let at = |node: Node| match node {
        Node::Receiver(i) => 3 * i,
        Node::Transmitter(j) => 3 * m + 4 * j,
    };
    let nodes = 3 * m + 4 * n;
    let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
    for o in observations.all() {
        let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
        let (i, j) = (at(Node::Receiver(o.receiver)), at(Node::Transmitter(o.transmitter)));
        let u = |axis: usize| (s[axis] - r[axis]) / network.distance(o.receiver, o.transmitter);
        let ray = (0..3).flat_map(|axis| [(i + axis, -u(axis)), (j + axis, u(axis))]);
        rows.push(ray.chain([(j + 3, 1.0)]).collect());
    }
    for (k, pin) in pins.iter().enumerate() {
        let own = (at(pin.node) + pin.axis, pin.precision);
        let of_levels = levels.iter().enumerate().map(|(l, level)| (nodes + l, -pin.precision * level.shares[k]));
        rows.push([own].into_iter().chain(of_levels).collect());
    }
    rows.extend(levels.iter().enumerate().map(|(l, level)| vec![(nodes + l, level.precision)]));
    let mut jacobian = Mat::<f64>::zeros(rows.len(), nodes + levels.len());
    for (k, row) in rows.iter().enumerate() {
        row.iter().for_each(|(column, value)| jacobian[(k, *column)] += value);
    }
    let wanted = (jacobian.transpose() * &jacobian).partial_piv_lu().inverse();
    let found = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
    let close = |found: f64, a: usize, b: usize| {
        let wanted = sigma * sigma * wanted[(a, b)];
        assert!((found - wanted).abs() < 1e-9 * sigma * sigma, "{a} {b}: {found} {wanted}");
    };
    for a in 0..3 * m {
        (0..3 * m).for_each(|b| close(found.joint[a * 3 * m + b], a, b));
        close(found.receivers[a / 3][a % 3][a % 3], a, a);
    }
    for (j, of) in found.transmitters.iter().enumerate() {
        let (at, of) = (at(Node::Transmitter(j)), of.unwrap());
        (0..3).for_each(|a| (0..3).for_each(|b| close(of.rows[a][b], at + a, at + b)));
        (0..3).for_each(|a| close(of.border[a], at + 3, at + a));
        close(of.corner, at + 3, at + 3);
    }
}

/// The covariance of nodes and clocks from derivatives by differences and dense algebra, the receivers held by the inner
/// constraint, with so many measured distances between receivers.
fn agrees_with_differences<const D: usize>(m: usize, n: usize, model: Model, taped: usize) {
    let (network, measured) = model.network::<D>(m, n);
    let between = |network: &Network<D>, [a, b]: [usize; 2]| distance(network.receivers[a], network.receivers[b]);
    let tape = |receivers| ReceiverDistance { receivers, value: between(&network, receivers), sigma: 0.5 * SIGMA };
    let distances: Vec<ReceiverDistance> = [[0, 3], [5, 1], [2, 6]].into_iter().take(taped).map(tape).collect();
    let measured = measured.with_distances(distances.clone());
    let observations = Observations::<D>::new(&measured, |_, _| true);
    let (reduced, sigma, step) = (observations.reduced(), SIGMA, 1e-5);
    let own_offsets = model.emissions == Emissions::Unknown;
    let each = if own_offsets { D + 1 } else { D };
    let size = reduced + each * n;
    let moved = |at: usize, by: f64| {
        let mut network = network.clone();
        let nodes = D * m;
        if at < nodes {
            network.receivers[at / D][at % D] += by;
        } else if at < reduced {
            let mut changes = vec![0.0; reduced - nodes];
            changes[at - nodes] = by;
            observations.clocks().add(&mut network, &changes, 1.0);
        } else {
            let (j, axis) = ((at - reduced) / each, (at - reduced) % each);
            if axis < D { network.transmitters[j][axis] += by } else { network.offsets[j] += by }
        }
        network
    };
    let (first_prior, recorders) = (observations.len() + D * (D + 1) / 2, m.div_ceil(2));
    let first_taped = first_prior + 2 * recorders;
    let mut jacobian = Mat::<f64>::zeros(first_taped + taped, size);
    for at in 0..size {
        let [above, below] = [step, -step].map(|by| moved(at, by));
        for (k, known) in distances.iter().enumerate() {
            let change = between(&above, known.receivers) - between(&below, known.receivers);
            jacobian[(first_taped + k, at)] = change / (2.0 * step) * sigma / known.sigma;
        }
        for (k, o) in observations.all().iter().enumerate() {
            jacobian[(k, at)] = (o.residual(&above) - o.residual(&below)) / (2.0 * step);
        }
    }
    // Rigid motions of the receivers, each as a measurement that costs far more than any other: the covariance hardly
    // has these then. What rigid motions are is tested where they are made.
    let of = rigid_motion(&network);
    for at in 0..D * m {
        for (k, x) in of(at / D, at % D).into_iter().enumerate() {
            jacobian[(observations.len() + k, at)] = 1e3 * x;
        }
    }
    if model.expecting {
        // Each clock less the mean of all.
        let off_mean = |network: &Network<D>, recorder: usize, k: usize| -> f64 {
            let all: Vec<f64> = network.clocks.iter().step_by(2).map(|clock| clock[k]).collect();
            all[recorder] - all.iter().sum::<f64>() / recorders as f64
        };
        for (at, row) in (D * m..reduced).flat_map(|at| (0..2 * recorders).map(move |row| (at, row))) {
            let (recorder, k) = (row / 2, row % 2);
            let [above, below] = [step, -step].map(|by| off_mean(&moved(at, by), recorder, k));
            jacobian[(first_prior + row, at)] = (above - below) / (2.0 * step) * sigma / EXPECTED[k];
        }
    }
    let wanted = (jacobian.transpose() * &jacobian).partial_piv_lu().inverse();
    let found = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
    assert!(found.loose.is_empty());
    let scale = (0..size).map(|a| wanted[(a, a)]).fold(0.0, f64::max);
    let close = |found: f64, a: usize, b: usize| {
        let (found, wanted) = (found / (sigma * sigma), wanted[(a, b)]);
        assert!((found - wanted).abs() < 1e-4 * scale, "{model:?} {a} {b}: {found} {wanted}");
    };
    (0..reduced).for_each(|a| (0..reduced).for_each(|b| close(found.joint[a * reduced + b], a, b)));
    for (j, found) in found.transmitters.iter().enumerate() {
        let (at, found) = (reduced + each * j, found.unwrap());
        (0..D).for_each(|a| (0..D).for_each(|b| close(found.rows[a][b], at + a, at + b)));
        match model.emissions {
            Emissions::Unknown => close(found.corner, at + D, at + D),
            Emissions::Constant => close(found.corner, D * m, D * m),
            Emissions::Known => assert_eq!(found.corner, 0.0),
        }
    }
}

#[test]
fn clocks_are_unknowns_and_distances_measurements() {
    for model in models().chain(expecting()) {
        for taped in [0, 3] {
            agrees_with_differences::<2>(8, 10, model, taped);
            agrees_with_differences::<3>(10, 13, model, taped);
        }
    }
}
