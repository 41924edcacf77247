//! Warnings about the geometry of a result, with the names of the nodes and a remedy.

use crate::degeneracy::list;
use crate::network::Network;
use crate::observations::Observations;
use crate::plane::{distance, flatness};
use crate::pseudoranges::Pseudoranges;
use crate::refine::Covariance;

/// Receivers most of whose measurements are outliers: the others' network says nothing of where
/// they are.
pub(super) fn doubtful_receivers(measured: &Pseudoranges, kept: &Observations) -> Vec<usize> {
    let mostly_wrong = |i: &usize| {
        let all = (0..measured.transmitters()).filter(|&j| measured.get(*i, j).is_some()).count();
        2 * kept.of_receiver(*i).len() < all
    };
    (0..measured.receivers()).filter(mostly_wrong).collect()
}

/// Warnings about the geometry: in line, in one place, poorly tied down. Returns whether most
/// receivers are determined, as far as the noise is known.
pub(super) fn warn_of_nodes(
    measured: &Pseudoranges,
    network: &Network,
    kept: &Observations,
    uncertainty: &Covariance,
    noise_known: bool,
    warnings: &mut Vec<String>,
) -> bool {
    let size = network.size();
    for (kind, points) in [("receivers", &network.receivers), ("transmitters", &network.transmitters)] {
        let flat = flatness(points);
        if flat < 0.02 {
            warnings.push(format!(
                "the {kind} lie nearly in one line (width {:.1} % of length): on which side of it the other nodes lie is \
                 poorly determined; move some {kind} off the line",
                100.0 * flat
            ));
        }
    }
    let names = measured.receiver_names();
    for (a, p) in network.receivers.iter().enumerate() {
        for (b, q) in network.receivers.iter().enumerate().skip(a + 1) {
            if distance(*p, *q) < 1e-3 * size {
                warnings.push(format!("receivers {} and {} stand in the same place; remove one", names[a], names[b]));
            }
        }
    }
    if !uncertainty.loose.is_empty() {
        let loose: Vec<String> = uncertainty.loose.iter().map(|&i| names[i].clone()).collect();
        warnings.push(format!("the measurements do not determine where {} are; measure more of them", list(&loose)));
    }
    let weak = |names: &[String], std: &dyn Fn(usize) -> f64| -> Vec<String> {
        (0..names.len()).filter(|&k| std(k) > 0.1 * size).map(|k| names[k].clone()).collect()
    };
    let receivers =
        weak(names, &|i| uncertainty.receivers.get(i).map_or(f64::INFINITY, |c| (c[0][0] + c[1][1]).max(0.0).sqrt()));
    let transmitters = weak(measured.transmitter_names(), &|j| {
        uncertainty.transmitters.get(j).and_then(|c| *c).map_or(f64::INFINITY, |c| (c[0][0] + c[1][1]).max(0.0).sqrt())
    });
    let determined = !noise_known || 2 * receivers.len() <= names.len();
    if !determined {
        warnings.push(
            "most receivers are poorly determined: are receivers the rows of the table, and transmitters its columns? else measure more"
                .to_string(),
        );
    }
    for (kind, nodes) in [("receivers", receivers), ("transmitters", transmitters)] {
        if noise_known && !nodes.is_empty() {
            warnings.push(format!(
                "poorly determined {kind} (standard deviation above a tenth of the network's size): {}; measure more, or \
                 from more directions",
                list(&nodes)
            ));
        }
    }
    let doubtful: Vec<String> = (0..measured.transmitters())
        .filter(|&j| {
            let all = (0..measured.receivers()).filter(|&i| measured.get(i, j).is_some()).count();
            let good = kept.of_transmitter(j).len();
            good < 4 || 2 * good < all
        })
        .map(|j| measured.transmitter_names()[j].clone())
        .collect();
    if !doubtful.is_empty() {
        warnings.push(format!("transmitters most of whose measurements are outliers: {}; check them", list(&doubtful)));
    }
    let doubtful: Vec<String> = doubtful_receivers(measured, kept).into_iter().map(|i| names[i].clone()).collect();
    if !doubtful.is_empty() {
        warnings.push(format!(
            "receivers most of whose measurements are outliers: {}; no position is given for them; check them",
            list(&doubtful)
        ));
    }
    determined
}
