//! Nodes that the measurements hardly tie down.

use crate::calibrate::judge::far_transmitters::Far;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::trace;
use crate::pseudoranges::Pseudoranges;
use crate::refine::Covariance;

/// Receivers whose inliers may agree by chance are expected less often than this in a calibration.
pub(crate) const BY_CHANCE: f64 = 0.01;

/// Receivers most of whose measurements are outliers.
pub(crate) fn mostly_wrong<const D: usize>(measured: &Pseudoranges, kept: &Observations<D>) -> Vec<usize> {
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
pub(crate) fn doubtful_receivers<const D: usize>(
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
pub(crate) fn agree_by_chance<const D: usize>(all: usize, inliers: usize, width: f64) -> f64 {
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

/// Nodes whose standard deviation is above a tenth of the network's size, or not known; without far transmitters.
pub(crate) struct WeakNodes {
    pub(crate) receivers: Vec<usize>,
    pub(crate) transmitters: Vec<usize>,
    /// Receivers that are among these or not determined at all.
    open: usize,
    all_receivers: usize,
    all_transmitters: usize,
}

impl WeakNodes {
    pub(crate) fn new<const D: usize>(network: &Network<D>, uncertainty: &Covariance<D>, far: &[Far<D>]) -> WeakNodes {
        let limit = 0.1 * network.size();
        let all = network.receivers.len();
        let of_receiver = |i: &usize| uncertainty.receivers.get(*i).map_or(f64::INFINITY, deviation) > limit;
        let of_transmitter = |j: &usize| {
            let known = uncertainty.transmitters.get(*j).and_then(Option::as_ref);
            known.map_or(f64::INFINITY, |c| deviation(&c.rows)) > limit
        };
        let receivers: Vec<usize> = (0..all).filter(of_receiver).collect();
        let open = (0..all).filter(|i| uncertainty.loose.contains(i) || receivers.contains(i)).count();
        let is_far = |j: &usize| far.iter().any(|far| far.transmitter == *j);
        let transmitters = (0..network.transmitters.len()).filter(|j| of_transmitter(j) && !is_far(j)).collect();
        WeakNodes { receivers, transmitters, open, all_receivers: all, all_transmitters: network.transmitters.len() }
    }

    /// Whether they are more than half of the receivers.
    pub(crate) fn are_most_receivers(&self) -> bool {
        2 * self.open > self.all_receivers
    }

    /// Whether they are most receivers, or most nodes with more than a quarter of the receivers among them.
    pub(crate) fn are_most(&self) -> bool {
        let nodes = self.open + self.transmitters.len();
        self.are_most_receivers()
            || (4 * self.open > self.all_receivers && 2 * nodes > self.all_receivers + self.all_transmitters)
    }
}

/// Standard deviation of a point: the root of the trace of its covariance.
fn deviation<const D: usize>(covariance: &[[f64; D]; D]) -> f64 {
    trace(covariance).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{WeakNodes, agree_by_chance};
    use crate::align::align;
    use crate::{CalibrateOptions, SimulateOptions, calibrate, simulate};

    #[test]
    fn most_are_open_by_receivers_or_by_all_nodes() {
        let of = |open: usize, transmitters: usize| {
            let weak = WeakNodes {
                receivers: (0..open).collect(),
                transmitters: (0..transmitters).collect(),
                open,
                all_receivers: 9,
                all_transmitters: 40,
            };
            weak.are_most()
        };
        // Sources far outside leave an array as it is; with receivers open among them, nothing is told.
        assert_eq!([of(0, 40), of(2, 40), of(3, 40), of(4, 10), of(5, 0)], [false, false, true, false, true]);
    }

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
