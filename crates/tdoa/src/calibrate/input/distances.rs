//! Distances between receivers that take part as measurements.

use crate::calibrate::options::CalibrateOptions;
use crate::distances::ReceiverDistance;
use crate::pseudoranges::Pseudoranges;
use std::borrow::Cow;

/// Measurements with the distances between receivers that were measured besides: all that are given, unless these tell the
/// propagation speed.
pub(crate) fn with_distances<'a, const D: usize>(
    measured: Cow<'a, Pseudoranges>,
    options: &CalibrateOptions<D>,
) -> Cow<'a, Pseudoranges> {
    if options.estimate_speed || options.distances.is_empty() {
        return measured;
    }
    let of = |known: &crate::KnownDistance| {
        Some(ReceiverDistance { receivers: known.receivers, value: known.distance, sigma: known.sigma? })
    };
    let distances = options.distances.iter().filter_map(of).collect();
    Cow::Owned(measured.into_owned().with_distances(distances))
}

#[cfg(test)]
mod tests {
    use super::with_distances;
    use crate::accuracy::cramer_rao_with_clocks;
    use crate::align::align;
    use crate::calibrate::{Calibrates, Dimension};
    use crate::points::distance;
    use crate::{CalibrateOptions, Emissions, Errors, KnownDistance, SimulateOptions, Simulation, calibrate, simulate};
    use std::borrow::Cow;

    /// A network of six receivers and its ranges, with three distances of receivers that are known well. The first is wrong
    /// by this length.
    fn taped<const D: usize>(seed: u64, wrong_by: f64) -> (Simulation<D>, CalibrateOptions<D>) {
        let mut made = SimulateOptions::<D>::new();
        (made.receivers, made.transmitters, made.noise, made.seed) = (6, 30, 0.1, seed);
        (made.missing, made.outliers, made.emissions) = (0.1, 0.05, Emissions::Known);
        let made = simulate(&made).unwrap();
        let mut options = CalibrateOptions::<D> { seed, ..CalibrateOptions::new() };
        options.clocks.emissions = Emissions::Known;
        let known = |(receivers, off): ([usize; 2], f64)| {
            let [a, b] = receivers.map(|i| made.network.receivers[i]);
            KnownDistance { receivers, distance: distance(a, b) + off, sigma: Some(0.002) }
        };
        options.distances = [([0, 3], wrong_by), ([5, 1], 0.0), ([2, 4], 0.0)].into_iter().map(known).collect();
        (made, options)
    }

    /// Squares of errors and of bounds, and of the bounds without the distances.
    fn squares<const D: usize>(seed: u64, errors: Errors) -> [f64; 3]
    where
        Dimension<D>: Calibrates<D>,
    {
        let (made, mut options) = taped::<D>(seed, 0.0);
        options.errors = errors;
        let bound = |measured: &crate::Pseudoranges| {
            cramer_rao_with_clocks(measured, &made.outliers, &made.network, 0.1, &options.clocks)
        };
        let with = bound(&with_distances(Cow::Borrowed(&made.pseudoranges), &options));
        let without = bound(&made.pseudoranges);
        let found = calibrate(&made.pseudoranges, &options).unwrap();
        let places: Vec<[f64; D]> = found.receivers.iter().flatten().copied().collect();
        let apart = align(&places, &made.network.receivers, false).unwrap().rms;
        assert!(apart < 3.0 * with, "{D} {errors:?} {seed}: {apart} {with}");
        for known in &found.distances {
            assert!(known.inlier && (known.found - known.measured).abs() < 3.0 * known.sigma, "{seed}: {known:?}");
        }
        [apart, with, without].map(|x| x * x)
    }

    #[test]
    fn taped_distances_are_measurements() {
        let mut sums = [0.0; 3];
        for seed in 0..8 {
            for all in [squares::<2>(seed, Errors::Symmetric), squares::<3>(seed, Errors::Symmetric)] {
                sums.iter_mut().zip(all).for_each(|(sum, x)| *sum += x);
            }
        }
        // Robust estimates of 16 networks of 6 to 9 coordinates beyond the taped ones: 1.6 times the bound's mean square has
        // a chance of less than one in a thousand.
        assert!(sums[0] < 1.6 * sums[1] && sums[1] < sums[2], "{sums:?}");
        squares::<2>(1, Errors::OneSided);
        squares::<3>(1, Errors::OneSided);
    }

    #[test]
    fn a_wrong_distance_is_named_and_left_out() {
        for seed in 0..4 {
            let (made, options) = taped::<2>(seed, 1.0);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let inliers: Vec<bool> = found.distances.iter().map(|known| known.inlier).collect();
            assert_eq!(inliers, [false, true, true], "seed {seed}: {:?}", found.distances);
            assert!(found.unique && found.warnings.iter().any(|warning| warning.contains("r1-r4 (measured")));
            let apart =
                align(&found.receivers.iter().flatten().copied().collect::<Vec<_>>(), &made.network.receivers, false);
            let bound = cramer_rao_with_clocks(&made.pseudoranges, &made.outliers, &made.network, 0.1, &options.clocks);
            assert!(apart.unwrap().rms < 3.0 * bound);
            // All wrong: the measurements may be.
            let mut options = options;
            options.distances.iter_mut().for_each(|known| known.distance *= 1.5);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            assert!(!found.unique && found.warnings.iter().any(|warning| warning.contains("at least half")));
        }
    }
}
