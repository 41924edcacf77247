//! Transmitters so far from the receivers that the measurements tell their directions alone.
//!
//! How far such a transmitter is follows from the curvature of the wave front over the receivers, which is linear in
//! the inverse of the distance. With x the inverse distance and s its standard deviation, no distance is too large
//! where x - 1.645 s < 0, and distances below 1 / (x + 1.645 s) are ruled out (one-sided, 95 %).

use crate::align::Transform;
use crate::bordered::Bordered;
use crate::network::Network;
use crate::points::{centroid, distance, dot, minus, trace};
use crate::refine::Covariance;
use serde::{Deserialize, Serialize};
use std::array::from_fn;

/// Quantile of the normal distribution for 95 % on one side.
const ONE_SIDED: f64 = 1.645;

/// Far transmitters are farther from the middle of the receivers than so many sizes of the network of receivers.
const OUTSIDE: f64 = 1.0;

/// The direction of a far transmitter is told to so many radians.
const TOLD: f64 = 0.2;

/// Distance in sizes of the network beyond which wave fronts over the receivers are plane for all that arithmetic
/// tells of positions.
const FARTHEST: f64 = 30.0;

/// A transmitter whose direction from the receivers is told, and whose distance is not.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[f64; D]: Serialize", deserialize = "[f64; D]: Deserialize<'de>"))]
pub struct FarTransmitter<const D: usize = 2> {
    /// Name of the transmitter.
    pub transmitter: String,
    /// Where it is seen from the middle of the receivers: a vector of length one.
    pub direction: [f64; D],
    /// Standard deviation of the direction, radians; root mean square over the axes across it.
    pub direction_std: f64,
    /// Distance from the middle of the receivers, metres, below which it is not, with a probability of 95 %.
    pub least_distance: f64,
}

impl<const D: usize> FarTransmitter<D> {
    /// The direction in another frame, and the distance in its unit.
    pub(crate) fn transform(&mut self, map: &Transform<D>) {
        self.direction = map.turn(self.direction);
        self.least_distance *= map.scale;
    }
}

/// A far transmitter by its index.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Far<const D: usize> {
    pub(crate) transmitter: usize,
    pub(crate) direction: [f64; D],
    pub(crate) direction_std: f64,
    pub(crate) least_distance: f64,
}

/// The far transmitters of a network, of which this is the covariance.
pub(crate) fn far_transmitters<const D: usize>(network: &Network<D>, uncertainty: &Covariance<D>) -> Vec<Far<D>> {
    let (middle, size) = (centroid(network.receivers.iter()), network.size());
    let far = |(j, (p, covariance)): (usize, (&[f64; D], &Option<Bordered<D>>))| {
        let covariance = (*covariance)?;
        let d = distance(*p, middle);
        let direction = minus(*p, middle).map(|x| x / d);
        let along = dot(direction, covariance.rows.map(|row| dot(row, direction))).max(0.0);
        let across = (trace(&covariance.rows) - along).max(0.0) / (D - 1) as f64;
        let (inverse, deviation, direction_std) = (1.0 / d, along.sqrt() / (d * d), across.sqrt() / d);
        let is_far = d > OUTSIDE * size && inverse < ONE_SIDED * deviation && direction_std < TOLD;
        let least_distance = 1.0 / (inverse + ONE_SIDED * deviation);
        is_far.then_some(Far { transmitter: j, direction, direction_std, least_distance })
    };
    network.transmitters.iter().zip(&uncertainty.transmitters).enumerate().filter_map(far).collect()
}

/// The network with transmitters as near as arithmetic needs them, if any is farther.
pub(crate) fn within_reach<const D: usize>(network: &Network<D>) -> Option<Network<D>> {
    let (middle, reach) = (centroid(network.receivers.iter()), FARTHEST * network.size());
    let mut near = network.clone();
    let mut is_any = false;
    for p in &mut near.transmitters {
        let d = distance(*p, middle);
        if d > reach {
            *p = scaled(*p, middle, reach / d);
            is_any = true;
        }
    }
    is_any.then_some(near)
}

/// The network with its far transmitters at their least distances, each in the direction that it has there.
pub(crate) fn drawn_in<const D: usize>(network: &Network<D>, far: &[Far<D>]) -> Network<D> {
    let middle = centroid(network.receivers.iter());
    let mut near = network.clone();
    for Far { transmitter, least_distance, .. } in far {
        let p = &mut near.transmitters[*transmitter];
        let d = distance(*p, middle);
        if d > 0.0 {
            *p = scaled(*p, middle, least_distance / d);
        }
    }
    near
}

/// A point so many times as far from a middle.
fn scaled<const D: usize>(p: [f64; D], middle: [f64; D], factor: f64) -> [f64; D] {
    from_fn(|k| middle[k] + (p[k] - middle[k]) * factor)
}

#[cfg(test)]
mod tests {
    use crate::align::align;
    use crate::points::{distance, dot};
    use crate::{CalibrateOptions, Network, Pseudoranges, calibrate};
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;

    /// Ten receivers in a cube of 30 cm, and 30 transmitters so far from its middle in all directions.
    fn array(far: f64, seed: u64) -> (Network<3>, Pseudoranges) {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let receivers: Vec<[f64; 3]> = (0..10).map(|_| [(); 3].map(|()| 0.3 * rng.random::<f64>())).collect();
        let transmitters: Vec<[f64; 3]> = (0..30)
            .map(|_| {
                let v: [f64; 3] = [(); 3].map(|()| rng.sample(StandardNormal));
                v.map(|x| 0.15 + far * x / dot(v, v).sqrt())
            })
            .collect();
        let offsets = (0..30).map(|_| rng.random::<f64>()).collect();
        let network = Network::new(receivers, transmitters, offsets);
        let noisy = network.pseudoranges().into_iter().map(|f| f + 1e-3 * rng.sample::<f64, _>(StandardNormal));
        let measured = Pseudoranges::new(10, 30, noisy.collect()).unwrap();
        (network, measured)
    }

    #[test]
    fn far_transmitters_have_a_direction_and_leave_the_receivers_alone() {
        let (mut bounds, mut wrong) = (0, 0);
        for seed in 0..4 {
            let (truth, measured) = array(4.0, seed);
            let mut options = CalibrateOptions { sigma: Some(1e-3), seed, ..CalibrateOptions::<3>::new() };
            // Distances keep starts from agreeing, so that all would be taken.
            options.search.max_starts = 96;
            let found = calibrate(&measured, &options).unwrap();
            let receivers: Vec<[f64; 3]> = found.receivers.iter().flatten().copied().collect();
            let apart = align(&receivers, &truth.receivers, false).unwrap();
            // The array is 0.4 m across.
            assert!(apart.rms < 0.01 && found.determined, "seed {seed}: {} {:?}", apart.rms, found.warnings);
            for far in &found.far_transmitters {
                let j = found.transmitter_names.iter().position(|name| *name == far.transmitter).unwrap();
                let at_origin = apart.transform.apply([0.0; 3]);
                let turned: [f64; 3] = std::array::from_fn(|k| apart.transform.apply(far.direction)[k] - at_origin[k]);
                let true_direction = truth.transmitters[j].map(|x| (x - 0.15) / 4.0);
                let angle = distance(turned, true_direction);
                assert!(angle < 5.0 * far.direction_std + 0.03, "seed {seed}: {angle} {far:?}");
                bounds += 1;
                wrong += usize::from(far.least_distance > distance(truth.transmitters[j], [0.15; 3]));
            }
        }
        // One in twenty is expected to be nearer than its least distance.
        assert!(bounds > 0 && 10 * wrong <= bounds, "{wrong} of {bounds}");
    }

    #[test]
    fn transmitters_among_the_receivers_are_not_far() {
        let (_, measured) = array(0.2, 5);
        let options = CalibrateOptions { sigma: Some(1e-3), ..CalibrateOptions::<3>::new() };
        assert!(calibrate(&measured, &options).unwrap().far_transmitters.is_empty());
    }
}
