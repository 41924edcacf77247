//! The elimination against its definition.

use super::*;
use crate::clocks::Emissions;
use crate::clocks::tests::{Model, models};
use crate::network::tests::random;
use crate::observations::Pin;
use crate::pseudoranges::Pseudoranges;
use crate::refine::NetworkRefiner;

/// The Schur complement block by block, as the front of this module gives it.
fn is_eliminated_as_defined<const D: usize>(hearing: usize, are_ranges: bool) {
    let network: Network<D> = random(30, 20, 1);
    let heard = |i: usize, j: usize| (i + 7 * j) % 30 < hearing;
    let values = network.pseudoranges();
    let measured = (0..600).map(|k| if heard(k / 20, k % 20) { values[k] } else { f64::NAN }).collect();
    let measured = Pseudoranges::new(30, 20, measured).unwrap();
    let measured = if are_ranges { measured.with_emissions(Emissions::Known) } else { measured };
    let observations = Observations::new(&measured, |_, _| true);
    let of_offset = if are_ranges { 0.0 } else { 1.0 };
    let mut refiner = NetworkRefiner::new(&observations, f64::INFINITY, &Monitor::default());
    let normal = refiner.normal_at(&network, &Loss { nu: f64::INFINITY, scale: 1.0 }).unwrap();
    let size = D * 30;
    let mut expected = vec![0.0; size * size];
    for j in 0..observations.transmitters {
        let factor = normal.inverse_factor(j).unwrap();
        let rays: Vec<(usize, [f64; D])> = (observations.of_transmitter(j).iter())
            .map(|o| {
                let d = network.distance(o.receiver, j);
                (D * o.receiver, minus(network.transmitters[j], network.receivers[o.receiver]).map(|x| x / d))
            })
            .collect();
        for &(i, u) in &rays {
            for &(k, v) in &rays {
                let (solved, last) = factor.invert((v, of_offset));
                let own = if i == k { 1.0 } else { 0.0 };
                let between = own - (dot(u, solved) + of_offset * last);
                for (a, u) in u.iter().enumerate() {
                    for (b, v) in v.iter().enumerate() {
                        expected[(k + b) * size + i + a] += between * u * v;
                    }
                }
            }
        }
    }
    for column in 0..size {
        for row in column..size {
            let at = column * size + row;
            assert!((normal.schur()[at] - expected[at]).abs() < 1e-10, "{hearing} {row} {column}");
        }
    }
}

#[test]
fn transmitters_that_few_or_many_hear_are_eliminated_as_defined() {
    for hearing in [30, 6] {
        for are_ranges in [false, true] {
            is_eliminated_as_defined::<2>(hearing, are_ranges);
            is_eliminated_as_defined::<3>(hearing, are_ranges);
        }
    }
}

/// Equations of a network with clocks, linearised, and solved with this damping.
fn solved<const D: usize>(observations: &Observations<D>, network: &Network<D>, pull: Option<f64>) -> Normal<D> {
    let mut normal = Normal::new(observations);
    let mut all = vec![0.0; observations.len() + observations.pins().len()];
    crate::refine::residuals(observations, network, &mut all);
    normal.linearise_by(observations, network, &all, |_, e| (1.0, e), |e| (1.0, e));
    if let Some(pull) = pull {
        normal.pull_together(network, [0.2; D], pull);
    }
    assert!(normal.solve(observations, 1e-3, &Monitor::default()).unwrap());
    normal
}

/// A network off the one that was measured, and its measurements.
fn moved<const D: usize>(model: Model) -> (Network<D>, Observations<D>) {
    let (mut network, measured) = model.network::<D>(10, 12);
    network.receivers.iter_mut().enumerate().for_each(|(i, r)| r[i % D] += 0.1);
    (network, Observations::new(&measured, |_, _| true))
}

fn steps_begin_at_the_network<const D: usize>(model: Model) {
    let (network, observations) = moved::<D>(model);
    let normal = solved(&observations, &network, None);
    let (mut target, mut other) = (network.clone(), network.clone());
    other.clocks.iter_mut().flatten().for_each(|clock| *clock += 7.0);
    other.receivers[0][0] += 7.0;
    other.offsets[0] += 7.0;
    normal.step(&observations, &network, &mut target);
    normal.step(&observations, &network, &mut other);
    assert!(target != network && target == other, "{model:?}");
}

fn a_pull_is_that_of_pins<const D: usize>(model: Model) {
    let (network, observations) = moved::<D>(model);
    let pins: Vec<Pin> = (0..10)
        .map(Node::Receiver)
        .chain((0..12).map(Node::Transmitter))
        .flat_map(|node| (0..D).map(move |axis| Pin { node, axis, value: 0.2, precision: 0.3 }))
        .collect();
    let pinned = observations.clone().pinned(&pins);
    let (mut pulled, mut expected) = (network.clone(), network.clone());
    solved(&observations, &network, Some(0.09)).step(&observations, &network, &mut pulled);
    solved(&pinned, &network, None).step(&pinned, &network, &mut expected);
    let nodes = |network: &Network<D>| [network.receivers.clone(), network.transmitters.clone()].concat();
    for (a, b) in nodes(&pulled).into_iter().zip(nodes(&expected)) {
        assert!((0..D).all(|k| (a[k] - b[k]).abs() < 1e-9), "{model:?}: {a:?} {b:?}");
    }
}

#[test]
fn a_step_depends_on_the_network_that_it_begins_at_alone() {
    for model in models() {
        steps_begin_at_the_network::<2>(model);
        steps_begin_at_the_network::<3>(model);
        a_pull_is_that_of_pins::<2>(model);
        a_pull_is_that_of_pins::<3>(model);
    }
}
