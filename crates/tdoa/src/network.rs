//! The solution: positions and offsets.

use serde::Serialize;

use crate::points::{distance, spread};
use crate::pseudoranges::Pseudoranges;

/// A complete network in the plane, or in space with `D` = 3: every receiver, every transmitter and
/// its offset, all in metres.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct Network<const D: usize = 2> {
    /// Positions of the receivers.
    pub receivers: Vec<[f64; D]>,
    /// Positions of the transmitters.
    pub transmitters: Vec<[f64; D]>,
    /// Offsets o_j of the transmitters: send time times propagation speed.
    pub offsets: Vec<f64>,
    /// Per receiver, what its clock adds to measurements: an offset, and a drift over half the recording. Empty where all
    /// receivers share a clock.
    #[serde(skip)]
    pub(crate) clocks: Vec<[f64; 2]>,
}

impl<const D: usize> Network<D> {
    /// A network of these nodes, whose receivers share a clock.
    pub fn new(receivers: Vec<[f64; D]>, transmitters: Vec<[f64; D]>, offsets: Vec<f64>) -> Self {
        Network { receivers, transmitters, offsets, clocks: Vec::new() }
    }

    /// Distance between receiver `i` and transmitter `j`.
    pub fn distance(&self, i: usize, j: usize) -> f64 {
        distance(self.receivers[i], self.transmitters[j])
    }

    /// The pseudorange that receiver `i` measures for transmitter `j` without noise: |r_i - s_j| +
    /// o_j.
    pub fn pseudorange(&self, i: usize, j: usize) -> f64 {
        self.distance(i, j) + self.offsets[j]
    }

    /// What a measurement has beyond distance, offset and clock, metres; `None` where it is missing.
    pub(crate) fn residual(&self, measured: &Pseudoranges, i: usize, j: usize) -> Option<f64> {
        let off = measured.get(i, j)? - self.pseudorange(i, j);
        Some(match (self.clocks.get(i), measured.unknown_clocks()) {
            (Some(clock), Some(recorders)) => off - recorders.delay(*clock, i, j),
            _ => off,
        })
    }

    /// |r_i - s_j| + o_j for all receivers and transmitters in metres, row-major.
    pub fn pseudoranges(&self) -> Vec<f64> {
        let row = |i| (0..self.transmitters.len()).map(move |j| self.pseudorange(i, j));
        (0..self.receivers.len()).flat_map(row).collect()
    }

    /// The unsquared residuals f_ij - o_j - |r_i - s_j| in metres, row-major, NaN where the
    /// measurement is missing.
    ///
    /// # Panics
    /// If the network and the measurements differ in size.
    pub fn residuals(&self, measured: &Pseudoranges) -> Vec<f64> {
        self.check_size(measured);
        let n = self.transmitters.len();
        let mut all = vec![f64::NAN; self.receivers.len() * n];
        for (i, j, f) in measured.cells().iter() {
            all[i * n + j] = f - self.pseudorange(i, j);
        }
        all
    }

    /// Root mean square of the unsquared residuals over the measured cells, in metres; 0 if nothing
    /// was measured.
    ///
    /// # Panics
    /// If the network and the measurements differ in size.
    pub fn rms(&self, measured: &Pseudoranges) -> f64 {
        self.check_size(measured);
        let squares = measured.cells().iter().map(|(i, j, f)| (f - self.pseudorange(i, j)).powi(2));
        let sum: f64 = squares.sum();
        if measured.observed() == 0 { 0.0 } else { (sum / measured.observed() as f64).sqrt() }
    }

    /// Whether every measured f_ij - o_j, which is a distance, is at least `-tolerance` (metres).
    /// The squared equations lose this condition; a network that violates it lies on a branch with
    /// the wrong sign.
    ///
    /// # Panics
    /// If the network and the measurements differ in size.
    pub fn is_physical(&self, measured: &Pseudoranges, tolerance: f64) -> bool {
        self.check_size(measured);
        measured.cells().iter().all(|(_, j, f)| f - self.offsets[j] >= -tolerance)
    }

    /// Whether every number of the network is finite.
    pub fn is_finite(&self) -> bool {
        self.receivers
            .iter()
            .chain(&self.transmitters)
            .flatten()
            .chain(&self.offsets)
            .chain(self.clocks.iter().flatten())
            .all(|x| x.is_finite())
    }

    /// The network's size: root mean square distance of the receivers from their centroid, in
    /// metres.
    pub fn size(&self) -> f64 {
        spread(self.receivers.iter())
    }

    fn check_size(&self, measured: &Pseudoranges) {
        assert_eq!(self.receivers.len(), measured.receivers(), "receivers of network and measurements");
        assert_eq!(self.transmitters.len(), measured.transmitters(), "transmitters of network and measurements");
        assert_eq!(self.transmitters.len(), self.offsets.len(), "transmitters and offsets");
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;
    use std::array::from_fn;

    /// Coordinates and offsets are standard normal.
    pub(crate) fn random<const D: usize>(receivers: usize, transmitters: usize, seed: u64) -> Network<D> {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut point = || from_fn(|_| rng.sample(StandardNormal));
        let receivers = (0..receivers).map(|_| point()).collect();
        let positions: Vec<[f64; D]> = (0..transmitters).map(|_| point()).collect();
        let offsets = positions.iter().map(|_| rng.sample(StandardNormal)).collect();
        Network::new(receivers, positions, offsets)
    }

    fn square() -> Network {
        Network::new(vec![[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]], vec![[3.0, 4.0], [0.0, 0.0]], vec![1.0, -2.0])
    }

    #[test]
    fn residuals_are_measured_minus_modelled() {
        // By hand: distances 5, 0; 4, 3; 3, 4, with offsets 1 and -2 added.
        let f = Pseudoranges::new(3, 2, vec![6.0, -2.0, 5.0, 1.5, f64::NAN, 2.0]).unwrap();
        let residuals = square().residuals(&f);
        assert_eq!(residuals[..4], [0.0, 0.0, 0.0, 0.5]);
        assert!(residuals[4].is_nan());
        assert_eq!(square().rms(&f), (0.25f64 / 5.0).sqrt());
    }

    #[test]
    fn residuals_in_space() {
        // By hand: distances 3, 7 and 0, 2.
        let network = Network::new(
            vec![[1.0, 2.0, 2.0], [-1.0, 1.0, 4.0]],
            vec![[0.0, 0.0, 0.0], [3.0, 5.0, -4.0]],
            vec![0.5, -1.0],
        );
        let f = Pseudoranges::new(2, 2, vec![3.5, 6.25, 18f64.sqrt() + 0.5, 12.0]).unwrap();
        let residuals = network.residuals(&f);
        assert_eq!(residuals[..3], [0.0, 0.25, 0.0]);
        assert!((residuals[3] - (13.0 - 96f64.sqrt())).abs() < 1e-14);
        // The receivers are 3 apart.
        assert_eq!(network.size(), 1.5);
    }

    #[test]
    fn physical_means_no_negative_distance() {
        let f = Pseudoranges::new(3, 2, vec![6.0, -2.5, 5.0, 1.0, 4.0, f64::NAN]).unwrap();
        assert!(!square().is_physical(&f, 0.4));
        assert!(square().is_physical(&f, 0.5));
    }
}
