//! What is expected of the clocks of recorders beforehand.

use crate::network::Network;

/// Offsets and drifts of recorders' clocks that are normal about their means, with these deviations.
///
/// The means are not known: they are the transmitters' offsets, and the propagation speed.
#[derive(Debug, Clone)]
pub(crate) struct ClockPrior {
    /// One over the variances of offsets and of drifts over half the recording, one over square metres; 0 where nothing is
    /// expected.
    pub(super) information: [f64; 2],
    pub(super) clocks: Vec<ExpectedClock>,
}

/// A clock of which something is expected.
#[derive(Debug, Clone)]
pub(super) struct ExpectedClock {
    /// A receiver that has it.
    pub(super) receiver: usize,
    /// The unknowns that its offset and its drift are.
    pub(super) unknowns: [Option<usize>; 2],
    /// What has been taken off the measurements for it.
    pub(super) taken: [f64; 2],
}

impl ClockPrior {
    /// How unlikely the clocks of a network are: half the squares of what they are off the mean, in their deviations.
    pub(crate) fn misfit<const D: usize>(&self, network: &Network<D>) -> f64 {
        let squares = (0..2).map(|k| self.information[k] * self.off_mean(network, k).map(|x| x * x).sum::<f64>());
        0.5 * squares.sum::<f64>()
    }

    /// The gradient of the misfit by each unknown.
    pub(crate) fn gradient<const D: usize>(&self, network: &Network<D>) -> impl Iterator<Item = (usize, f64)> {
        (0..2).flat_map(move |k| {
            let each = self.clocks.iter().zip(self.off_mean(network, k));
            each.filter_map(move |(clock, off)| Some((clock.unknowns[k]?, self.information[k] * off)))
        })
    }

    /// The second derivatives of the misfit by each pair of unknowns.
    pub(crate) fn curvature(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let share = 1.0 / self.clocks.len().max(1) as f64;
        (0..2).flat_map(move |k| {
            let unknowns = move || self.clocks.iter().filter_map(move |clock| clock.unknowns[k]);
            unknowns().flat_map(move |a| {
                let own = move |b: usize| if a == b { 1.0 - share } else { -share };
                unknowns().map(move |b| (a, b, self.information[k] * own(b)))
            })
        })
    }

    /// Receivers whose recorders' clocks are off by more than this many of the expected deviations, in the offset or in the
    /// rate.
    pub(crate) fn surprises<const D: usize>(&self, network: &Network<D>, limit: f64) -> Vec<usize> {
        let mut surprises = Vec::new();
        for k in 0..2 {
            let each = self.clocks.iter().zip(self.off_mean(network, k));
            let beyond = each.filter(|(_, off)| self.information[k].sqrt() * off.abs() > limit);
            surprises.extend(beyond.map(|(clock, _)| clock.receiver));
        }
        surprises.sort_unstable();
        surprises.dedup();
        surprises
    }

    /// Offsets, or drifts, of the clocks less their mean.
    fn off_mean<const D: usize>(&self, network: &Network<D>, k: usize) -> impl Iterator<Item = f64> {
        let value = move |clock: &ExpectedClock, network: &Network<D>| {
            clock.taken[k] + network.clocks.get(clock.receiver).map_or(0.0, |clock| clock[k])
        };
        let values: Vec<f64> = self.clocks.iter().map(|clock| value(clock, network)).collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        values.into_iter().map(move |value| value - mean)
    }
}
