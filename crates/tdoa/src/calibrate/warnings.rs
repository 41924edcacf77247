//! Warnings about the geometry of a result, with the names of the nodes and a remedy.

use crate::degeneracy::{least_per_transmitter, list};
use crate::network::Network;
use crate::observations::Observations;
use crate::points::{distance, trace};
use crate::pseudoranges::Pseudoranges;
use crate::refine::Covariance;

/// Receivers whose inliers may agree by chance are expected less often than this in a calibration.
pub(super) const BY_CHANCE: f64 = 0.01;

/// Receivers most of whose measurements are outliers.
fn mostly_wrong<const D: usize>(measured: &Pseudoranges, kept: &Observations<D>) -> Vec<usize> {
    let is_mostly_wrong = |i: &usize| 2 * kept.of_receiver(*i).len() < count(measured, *i);
    (0..measured.receivers()).filter(is_mostly_wrong).collect()
}

/// Number of measurements of a receiver.
fn count(measured: &Pseudoranges, i: usize) -> usize {
    measured.cells().row(i).count()
}

/// Receivers most of whose measurements are outliers, and whose inliers may agree by chance: the
/// network of the others does not tell where they are. `width` is the width of the band of an
/// inlier as a share of the network's size.
pub(super) fn doubtful_receivers<const D: usize>(
    measured: &Pseudoranges,
    kept: &Observations<D>,
    width: f64,
) -> Vec<usize> {
    let by_chance = |i: &usize| {
        measured.receivers() as f64 * agree_by_chance::<D>(count(measured, *i), kept.of_receiver(*i).len(), width)
            > BY_CHANCE
    };
    mostly_wrong(measured, kept).into_iter().filter(by_chance).collect()
}

/// How many of the places that two of `all` measurements give a receiver, in space three, are expected
/// to have `inliers` of them by chance, those included, where one is an inlier by chance with
/// probability `width`: two places for each two (three), and the tail of a binomial distribution.
pub(super) fn agree_by_chance<const D: usize>(all: usize, inliers: usize, width: f64) -> f64 {
    let (others, least) = (all.saturating_sub(D), inliers.saturating_sub(D));
    let p = width.clamp(0.0, 1.0);
    let mut term = (1.0 - p).powi(others as i32);
    let mut below = 0.0;
    let mut tail = 0.0;
    // Terms from one to the next by the ratio of binomial probabilities; where the first is zero, all agree.
    for k in 0..=others {
        if k < least {
            below += term
        } else {
            tail += term
        }
        term *= (others - k) as f64 / (k + 1) as f64 * p / (1.0 - p).max(f64::MIN_POSITIVE);
    }
    let tail = if p == 1.0 || !(below + tail).is_finite() { 1.0 } else { tail };
    let subsets = (0..D).map(|k| all.saturating_sub(k)).product::<usize>() / (1..=D).product::<usize>();
    (2 * subsets) as f64 * tail
}

/// Warnings about the geometry: in one place, poorly tied down. Returns whether most
/// receivers are determined, as far as the noise is known.
pub(super) fn warn_of_nodes<const D: usize>(
    measured: &Pseudoranges,
    network: &Network<D>,
    kept: &Observations<D>,
    uncertainty: &Covariance<D>,
    noise_known: bool,
    doubtful: &[usize],
    warnings: &mut Vec<String>,
) -> bool {
    let size = network.size();
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
    let receivers = weak(names, &|i| uncertainty.receivers.get(i).map_or(f64::INFINITY, |c| trace(c).max(0.0).sqrt()));
    let transmitters = weak(measured.transmitter_names(), &|j| {
        uncertainty.transmitters.get(j).and_then(|c| *c).map_or(f64::INFINITY, |c| trace(&c.rows).max(0.0).sqrt())
    });
    let open = (0..names.len()).filter(|&i| uncertainty.loose.contains(&i) || receivers.contains(&names[i])).count();
    let determined = !noise_known || 2 * open <= names.len();
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
    let astray: Vec<String> = (0..measured.transmitters())
        .filter(|&j| {
            let all = (0..measured.receivers()).filter(|&i| measured.get(i, j).is_some()).count();
            let good = kept.of_transmitter(j).len();
            good < least_per_transmitter::<D>() || 2 * good < all
        })
        .map(|j| measured.transmitter_names()[j].clone())
        .collect();
    if !astray.is_empty() {
        warnings.push(format!("transmitters most of whose measurements are outliers: {}; check them", list(&astray)));
    }
    let (none, some): (Vec<usize>, Vec<usize>) =
        mostly_wrong(measured, kept).into_iter().partition(|i| doubtful.contains(i));
    let named = |all: &[usize]| list(&all.iter().map(|&i| names[i].clone()).collect::<Vec<_>>());
    if !none.is_empty() {
        warnings.push(format!(
            "receivers most of whose measurements are outliers: {}; no position is given for them; check them",
            named(&none)
        ));
    }
    if !some.is_empty() {
        warnings.push(format!(
            "receivers most of whose measurements are outliers: {}; those that are left agree on their positions; check them",
            named(&some)
        ));
    }
    determined
}

#[cfg(test)]
mod tests {
    use super::agree_by_chance;
    use crate::align::align;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

    #[test]
    fn chance_is_that_of_a_binomial_distribution() {
        // By hand: 2 places for each of 6 pairs, and both others, or one of them at least.
        assert!((agree_by_chance::<2>(4, 4, 0.1) - 12.0 * 0.01).abs() < 1e-12);
        assert!((agree_by_chance::<2>(4, 3, 0.1) - 12.0 * 0.19).abs() < 1e-12);
        assert_eq!([agree_by_chance::<2>(4, 2, 0.1), agree_by_chance::<2>(3, 3, 1.0)], [12.0, 6.0]);
        // In space: 2 places for each of 10 threes, and both others.
        assert!((agree_by_chance::<3>(5, 5, 0.1) - 20.0 * 0.01).abs() < 1e-12);
        // Eight of twenty with a band of 7 cm in 10 m: beyond chance; five: not.
        assert!(agree_by_chance::<2>(20, 8, 0.007) < 1e-6 && agree_by_chance::<2>(20, 4, 0.02) > 1.0);
    }

    #[test]
    fn receivers_with_enough_good_measurements_keep_their_places() {
        let mut mostly_wrong = 0;
        for seed in 0..8 {
            let options = SimulateOptions {
                receivers: 20,
                transmitters: 20,
                noise: 0.01,
                outliers: 0.3,
                seed,
                ..Default::default()
            };
            let simulation = simulate(&options).unwrap();
            let found = calibrate(&simulation.pseudoranges, &CalibrateOptions::default()).unwrap();
            let pairs = found.receivers.iter().zip(&simulation.network.receivers);
            let (placed, truth): (Vec<_>, Vec<_>) = pairs.filter_map(|(p, q)| Some(((*p)?, *q))).unzip();
            let error = align(&placed, &truth, false).unwrap().rms;
            assert!(placed.len() == 20 && error < 0.03, "seed {seed}: {} {error}", placed.len());
            let counts = (0..20).map(|i| found.counts_of_receiver(i));
            mostly_wrong += counts.filter(|[all, outliers]| 2 * outliers > *all).count();
        }
        assert!(mostly_wrong > 0);
    }
}
