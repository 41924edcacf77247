//! Where the nodes of a random network lie.

use std::array::from_fn;

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::network::Network;

/// Where the nodes of a random network lie. Extents are those in x, in y and in space in z, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Layout<const D: usize = 2> {
    /// Coordinates and offsets are standard normal, as in the paper's experiments.
    Normal,
    /// Positions are uniform in a rectangle or a box, offsets uniform in plus or minus its diagonal.
    Room {
        /// Its extents, metres.
        extent: [f64; D],
    },
    /// Receivers stand evenly along a road, which is x, displaced by up to a third of their
    /// spacing, and anywhere in the other coordinates; transmitters are uniform on the road.
    Chain {
        /// Its length and width, and in space the height up to which nodes are, metres.
        extent: [f64; D],
    },
    /// Receivers stand at the points of a square grid over x and y, displaced by up to a third of
    /// their spacing, and in space at any height; transmitters are uniform in the rectangle or box.
    Grid {
        /// Its extents, metres.
        extent: [f64; D],
    },
}

impl<const D: usize> Layout<D> {
    /// The extents, metres; those of standard normal positions are 1.
    pub fn extent(self) -> [f64; D] {
        match self {
            Layout::Normal => [1.0; D],
            Layout::Room { extent } | Layout::Chain { extent } | Layout::Grid { extent } => extent,
        }
    }

    /// A random network of `m` receivers and `n` transmitters.
    pub(super) fn network(self, m: usize, n: usize, rng: &mut Pcg64Mcg) -> Network<D> {
        let receivers = (0..m).map(|i| self.receiver(i, m, rng)).collect();
        let transmitters = (0..n).map(|_| self.point(rng)).collect();
        let diagonal = self.extent().into_iter().reduce(f64::hypot).unwrap_or_default();
        let offsets = (0..n).map(|_| match self {
            Layout::Normal => rng.sample(StandardNormal),
            _ => diagonal * rng.random_range(-1.0..=1.0),
        });
        Network::new(receivers, transmitters, offsets.collect())
    }

    /// Any point.
    fn point(self, rng: &mut Pcg64Mcg) -> [f64; D] {
        let extent = self.extent();
        from_fn(|k| match self {
            Layout::Normal => rng.sample(StandardNormal),
            _ => extent[k] * rng.random::<f64>(),
        })
    }

    /// The position of receiver `i` of `m`.
    fn receiver(self, i: usize, m: usize, rng: &mut Pcg64Mcg) -> [f64; D] {
        let extent = self.extent();
        // The receiver's place among so many in a coordinate in which they stand in order.
        let mut places = [None; D];
        match self {
            Layout::Normal | Layout::Room { .. } => return self.point(rng),
            Layout::Chain { .. } => places[0] = Some((i, m)),
            Layout::Grid { .. } => {
                let across = ((m as f64 * extent[0] / extent[1]).sqrt().round() as usize).clamp(1, m);
                places[0] = Some((i % across, across));
                places[1] = Some((i / across, m.div_ceil(across)));
            }
        }
        from_fn(|k| match places[k] {
            Some((place, count)) => {
                let off = 0.5 + rng.random_range(-1.0 / 3.0..=1.0 / 3.0);
                extent[k] * (place as f64 + off) / count as f64
            }
            None => extent[k] * rng.random::<f64>(),
        })
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::*;

    fn network(layout: Layout<3>, m: usize, n: usize) -> Network<3> {
        layout.network(m, n, &mut Pcg64Mcg::seed_from_u64(7))
    }

    #[test]
    fn nodes_in_space_lie_within_the_extent() {
        let extent = [40.0, 9.0, 2.5];
        for layout in [Layout::Room { extent }, Layout::Chain { extent }, Layout::Grid { extent }] {
            let network = network(layout, 60, 200);
            let nodes = || network.receivers.iter().chain(&network.transmitters);
            for (k, side) in extent.into_iter().enumerate() {
                assert!(nodes().all(|p| (0.0..=side).contains(&p[k])), "{layout:?}, coordinate {k}");
                // Of 260 nodes hardly any share of a coordinate is left empty.
                let [low, high] = [f64::min, f64::max].map(|of| nodes().map(|p| p[k]).reduce(of).unwrap());
                assert!(high - low > 0.9 * side, "{layout:?}, coordinate {k}: {low} to {high}");
            }
            // The diagonal of the box, by hand.
            let most = (1600.0 + 81.0 + 6.25f64).sqrt();
            let largest = network.offsets.iter().fold(0.0, |most: f64, o| most.max(o.abs()));
            assert!(largest <= most && largest > 0.9 * most, "{layout:?}: {largest}");
        }
    }

    #[test]
    fn a_chain_in_space_stands_in_order_along_x() {
        let network = network(Layout::Chain { extent: [120.0, 10.0, 5.0] }, 12, 3);
        for (i, p) in network.receivers.iter().enumerate() {
            // Spacings are 10 m: in the middle of its own, a third of one off at most.
            assert!((p[0] - 10.0 * (i as f64 + 0.5)).abs() <= 10.0 / 3.0 + 1e-9, "{i}: {p:?}");
        }
    }

    #[test]
    fn a_grid_in_space_is_one_over_x_and_y() {
        let network = network(Layout::Grid { extent: [40.0, 30.0, 5.0] }, 12, 3);
        for (i, p) in network.receivers.iter().enumerate() {
            // Four receivers in each of three rows, 10 m apart.
            for (x, place) in [(p[0], i % 4), (p[1], i / 4)] {
                assert!((x - 10.0 * (place as f64 + 0.5)).abs() <= 10.0 / 3.0 + 1e-9, "{i}: {p:?}");
            }
        }
        // Heights are in no order.
        assert!(!network.receivers.is_sorted_by_key(|p| p[2]));
    }

    #[test]
    fn normal_networks_in_space_have_variance_one() {
        let network = network(Layout::Normal, 1000, 1000);
        for k in 0..3 {
            let squares = network.receivers.iter().chain(&network.transmitters).map(|p| p[k] * p[k]);
            // A mean of 2000 squares has standard deviation sqrt(2 / 2000) = 0.03.
            assert!((squares.sum::<f64>() / 2000.0 - 1.0).abs() < 0.15);
        }
    }
}
