//! What measurements say of heights: the likelihood ratio of a network in space and a planar one.

use crate::calibrate::judge::dimension_test::DimensionTest;
use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::deviation::inlier_deviation;
use crate::calibrate::search::truncated_cost::truncated;
use crate::calibrate::steps::Draft;
use crate::loss::CAUCHY;
use crate::points::extent;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, RefineOptions, SEARCH};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Probability of the quantile that the gain of heights must exceed.
const QUANTILE: f64 = 1.0 - 1e-4;

/// Heights enter distances by their squares, and the search takes the best of many networks: gains of
/// planar networks have about twice the mean that as many unknowns of a linear model would give (measured
/// on 20 to 30 planar networks of six kinds; `tdoa experiment dimension` counts).
const BENT: f64 = 2.0;

/// Deviations of measurements are at least this share of the network's size: exact ones have no noise.
const LEAST_DEVIATION: f64 = 1e-6;

/// What a network in space leaves of the measurements.
pub(super) struct InSpace {
    /// Deviation of the measurements.
    sigma: f64,
    /// The largest distance of two receivers, metres.
    extent: f64,
    /// Nodes that have a place.
    located: usize,
    /// Inliers less the unknowns.
    redundancy: usize,
    /// Receiver, transmitter and residual, metres.
    residuals: Vec<(usize, usize, f64)>,
    /// The evidence for heights, and what they change.
    of_heights: DimensionTest,
}

impl InSpace {
    /// Of a calibration.
    pub(super) fn of(whole: &Calibration<3>) -> Self {
        InSpace {
            sigma: whole.sigma,
            extent: whole.extent().unwrap_or(0.0),
            located: whole.receivers.iter().flatten().count() + whole.transmitters.iter().flatten().count(),
            redundancy: whole.redundancy,
            residuals: whole.residuals.iter().map(|(i, j, residual)| (i, j, residual.length)).collect(),
            of_heights: whole.dimension_test.unwrap_or_default(),
        }
    }

    /// Of the network with the likeliest heights near those of a draft; `None` where heights do not follow from the
    /// measurements alone.
    pub(super) fn likeliest(draft: &Draft<'_, 3>) -> Result<Option<Self>, CalibrateError<3>> {
        let Draft { state, input } = draft;
        if !state.has_heights_of_its_own() {
            return Ok(None);
        }
        let modes = state.height_modes()?;
        let Some((heights, of_heights)) = state.likeliest_heights(&modes) else { return Ok(None) };
        let observations = state.observations.clone().pinned(&heights.pins());
        let observations = observations.with_other_unknowns(heights.told.round() as usize);
        // As planar networks are, whose residuals are compared with these.
        let fit =
            RefineOptions { scale: Some(CAUCHY * heights.deviation), steps: 30, rounds: 0, tolerance: 1e-9, ..SEARCH };
        let mut refiner = NetworkRefiner::new(&observations, 1.0, state.monitor);
        let network = &refiner.refine(heights.network.clone(), &fit).network;
        check(state.monitor)?;
        let threshold = state.options.inlier_threshold;
        let sigma =
            state.known.unwrap_or_else(|| inlier_deviation(&observations, network, heights.deviation, threshold));
        let is_inlier = |residual: f64| residual.abs() <= threshold * sigma;
        let inliers = observations.all().iter().filter(|o| is_inlier(o.residual(network))).count();
        let (receivers, transmitters) = (&input.usable.receivers, &input.usable.transmitters);
        let residuals = observations
            .all()
            .iter()
            .map(|o| (receivers[o.receiver], transmitters[o.transmitter], o.residual(network) / o.precision));
        Ok(Some(InSpace {
            sigma,
            extent: extent(&network.receivers).unwrap_or(0.0),
            located: network.receivers.len() + network.transmitters.len(),
            redundancy: inliers.saturating_sub(observations.unknowns()),
            residuals: residuals.collect(),
            of_heights,
        }))
    }

    /// The likelihood ratio of space and plane, over the measurements that both have, with the deviation that
    /// is given or left in space. Outliers cost the same in both.
    pub(super) fn beside(&self, flat: &Calibration, measured: &Pseudoranges, is_given: bool) -> DimensionTest {
        let deviation = self.sigma.max(LEAST_DEVIATION * self.extent);
        let (mut in_plane, mut in_space) = (0.0, 0.0);
        for &(i, j, residual) in &self.residuals {
            let Some(other) = flat.residuals.get(i, j) else { continue };
            let cost = |length: f64| truncated(length / (deviation * measured.sigma(i, j).unwrap_or(1.0)));
            in_plane += cost(other.length);
            in_space += cost(residual);
        }
        // Heights, but for those of a plane that moves.
        let heights = self.located.saturating_sub(3).max(1) as f64;
        let quantile = if is_given {
            ChiSquared::new(heights).ok().map(|all| all.inverse_cdf(QUANTILE))
        } else {
            // Without measurements left over there is no deviation to compare with.
            let left = self.redundancy as f64;
            FisherSnedecor::new(heights, left).ok().map(|all| heights * all.inverse_cdf(QUANTILE))
        };
        DimensionTest {
            evidence: self.of_heights.evidence,
            change: self.of_heights.change,
            gain: Some(in_plane - in_space).filter(|gain| gain.is_finite()),
            needed: quantile.map(|quantile| 0.5 * BENT * quantile).filter(|needed| needed.is_finite()),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::calibrate::{Calibrated, calibrate_either};
    use crate::{CalibrateOptions, Layout, SimulateOptions, simulate};
    use hc::Monitor;

    /// Enough measurements for a part of the nodes to tell how high they are.
    fn many<const D: usize>(seed: u64) -> SimulateOptions<D> {
        let size = SimulateOptions { receivers: 40, transmitters: 150, ..SimulateOptions::new() };
        SimulateOptions { noise: 0.01, outliers: 0.05, missing: 0.1, seed, ..size }
    }

    #[test]
    fn many_nodes_of_a_plane_have_no_heights() {
        for seed in 0..2 {
            let made = simulate(&many::<2>(seed)).unwrap();
            let found = calibrate_either(&made.pseudoranges, &CalibrateOptions::new(), &Monitor::default()).unwrap();
            let Calibrated::Plane(found) = found else { panic!("seed {seed} is in space") };
            let test = found.dimension_test.unwrap();
            assert!(test.evidence.unwrap() < -5.0 && test.gain.unwrap() < 0.3 * test.needed.unwrap(), "{test:?}");
            assert!(found.unique, "{:?}", found.warnings);
        }
    }

    /// All nodes of a room of 10 m by 8 m are within 0.8 m of height.
    #[test]
    fn many_nodes_show_small_heights() {
        for seed in 0..2 {
            let layout = Layout::Room { extent: [10.0, 8.0, 0.8] };
            let made = simulate(&SimulateOptions { layout, ..many::<3>(seed) }).unwrap();
            let found = calibrate_either(&made.pseudoranges, &CalibrateOptions::new(), &Monitor::default()).unwrap();
            assert!(matches!(found, Calibrated::Space(_)), "seed {seed} is in the plane");
        }
    }
}
