//! Whether a network is flat: a calibration in the plane and one in space, compared by the likelihood of
//! the measurements.

use crate::calibrate::entry::calibrate_with;
use crate::calibrate::input::anchors;
use crate::calibrate::judge::dimension_test::DimensionTest;
use crate::calibrate::options::{
    CalibrateError, CalibrateOptions, Errors, MeasuredPosition, ReceiverDelays, SearchOptions,
};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::hypotheses::{Hypotheses, generator};
use crate::calibrate::search::truncated_cost::truncated;
use crate::points::spread;
use crate::pseudoranges::Pseudoranges;
use crate::quantity::number;
use crate::refine::PartialNetwork;
use hc::Monitor;
use rand::RngExt;
use rand_distr::StandardNormal;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use thiserror::Error;

/// Probability of the quantile that the gain of heights must exceed.
const QUANTILE: f64 = 1.0 - 1e-4;

/// Heights enter distances by their squares, and the search takes the best of many networks: gains of
/// planar networks have about twice the mean that as many unknowns of a linear model would give (measured
/// on 20 to 30 planar networks of six kinds; `tdoa experiment dimension` counts).
const BENT: f64 = 2.0;

/// A network in space takes the place of a planar one that fits only if it gains so many times what is
/// needed: heights explain late measurements too.
const OVERWHELMING: f64 = 4.0;

/// Starts of the search in the plane, before one in space tells whether more are worth it.
const FIRST_STARTS: usize = 96;

/// Starts in space from the planar network, and their heights as shares of its size.
const LIFTED: [f64; 6] = [0.03, 0.1, 0.3, 0.03, 0.1, 0.3];

/// Residuals count in this share of the network's size at least: exact measurements have no noise.
const LEAST_DEVIATION: f64 = 1e-6;

/// A network whose dimension was chosen by its measurements.
#[derive(Debug, Clone, PartialEq)]
pub enum Calibrated {
    /// In the plane.
    Plane(Calibration),
    /// In space.
    Space(Calibration<3>),
}

/// Why there is none.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CalibratedError {
    /// The calibration in the plane failed, or was stopped.
    #[error(transparent)]
    Plane(#[from] CalibrateError),
    /// The one in space did.
    #[error(transparent)]
    Space(#[from] CalibrateError<3>),
}

/// Calibrates in the plane, or in space where the measurements support a third coordinate.
///
/// Known positions decide: where their heights differ the network is in space, else in the plane. Without
/// any, it is in space if one there fits and the planar network does not, or if the measurements are far
/// more likely in space. What is needed is twice the 99.99 % quantile of what as many unknowns of a linear
/// model gain by chance (likelihood ratio; of F, or of chi-squared where the deviation is given). A gain of
/// that much is told in a warning, one of four times that takes the place of a planar network that fits.
/// Errors of receivers that the planar network shows are no reason for heights.
/// [`Calibration::dimension_test`] has the numbers. `options.seed` and the rest are for both.
///
/// ```
/// use tdoa::{CalibrateOptions, SimulateOptions, calibrate::{Calibrated, calibrate_either}, simulate};
///
/// let mut options = SimulateOptions::<3>::new();
/// (options.receivers, options.transmitters, options.noise) = (10, 20, 0.01);
/// let room = simulate(&options)?;
/// let found = calibrate_either(&room.pseudoranges, &CalibrateOptions::new(), &Default::default())?;
/// assert!(matches!(found, Calibrated::Space(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`calibrate_with`], of the calibration that failed or was stopped.
pub fn calibrate_either(
    measured: &Pseudoranges,
    options: &CalibrateOptions<3>,
    monitor: &Monitor,
) -> Result<Calibrated, CalibratedError> {
    anchors::validate(measured, options)?;
    let plane = in_plane(options);
    if has_heights(options) {
        return Ok(Calibrated::Space(calibrate_with(measured, options, &[], monitor)?));
    }
    if options.anchors.iter().any(Option::is_some) || !options.positions.is_empty() {
        return Ok(Calibrated::Plane(calibrate_with(measured, &plane, &[], monitor)?));
    }
    let mut first = plane.clone();
    first.search.max_starts = plane.search.max_starts.min(FIRST_STARTS.max(plane.search.min_starts));
    let mut flat = calibrate_with(measured, &first, &[], monitor)?;
    let settled = first.search.max_starts == plane.search.max_starts || flat.starts < first.search.max_starts;
    if settled && flat.fits && flat.unique_receivers {
        let test = lifted(measured, options, &flat, monitor)?.map(|lifted| compare(measured, &flat, &lifted, options));
        if test.is_none_or(|test| !test.supports(1.0)) {
            flat.dimension_test = Some(test.unwrap_or(DimensionTest::UNTRIED));
            return Ok(Calibrated::Plane(flat));
        }
    }
    let whole = unless_stopped(calibrate_with(measured, options, &[], monitor))?;
    let mut test = DimensionTest::UNTRIED;
    if let Some(mut whole) = whole {
        let cleared = cleared(measured, &first, &flat, monitor)?;
        let judged = cleared.as_ref().unwrap_or(&flat);
        test = compare(measured, judged, &whole, options);
        if whole.fits && (test.supports(OVERWHELMING) || !judged.fits) {
            whole.dimension_test = Some(test);
            return Ok(Calibrated::Space(whole));
        }
    }
    if !settled {
        flat = calibrate_with(measured, &plane, &[], monitor)?;
    }
    if let (true, Some(gain)) = (test.supports(1.0), test.gain) {
        flat.warnings.push(format!(
            "the measurements are more likely in space (by {} in the natural logarithm), which heights may explain or errors that nearly \
             all lengthen; --dimensions 3 gives the network there",
            number(gain, 3)
        ));
    }
    flat.dimension_test = Some(test);
    Ok(Calibrated::Plane(flat))
}

/// The planar network without the errors that receivers show in it; `None` if it shows none or they are
/// taken out already.
fn cleared(
    measured: &Pseudoranges,
    options: &CalibrateOptions,
    flat: &Calibration,
    monitor: &Monitor,
) -> Result<Option<Calibration>, CalibrateError> {
    if flat.receiver_errors.iter().all(|error| error.taken_out) || options.errors == Errors::OneSided {
        return Ok(None);
    }
    let options = CalibrateOptions { receiver_delays: ReceiverDelays::Auto, ..options.clone() };
    unless_stopped(calibrate_with(measured, &options, &[], monitor))
}

/// A calibration if there is one; stopping is an error, failing is none.
fn unless_stopped<const D: usize>(
    ended: Result<Calibration<D>, CalibrateError<D>>,
) -> Result<Option<Calibration<D>>, CalibrateError<D>> {
    match ended {
        Ok(found) => Ok(Some(found)),
        Err(error @ CalibrateError::Cancelled(_)) => Err(error),
        Err(_) => Ok(None),
    }
}

/// Whether known positions have different heights.
fn has_heights(options: &CalibrateOptions<3>) -> bool {
    let exact = options.anchors.iter().flatten().map(|p| Some(p[2]));
    let measured = options.positions.iter().map(|known| known.position[2]);
    let mut all = exact.chain(measured).flatten();
    let first = all.next();
    all.any(|z| Some(z) != first)
}

/// Options for the plane with these values. All fields are named, so that none is forgotten.
fn in_plane(options: &CalibrateOptions<3>) -> CalibrateOptions {
    let position = |known: &MeasuredPosition<3>| {
        let ([x, y, _], [of_x, of_y, _]) = (known.position, known.sigma);
        MeasuredPosition { receiver: known.receiver, position: [x, y], sigma: [of_x, of_y] }
    };
    CalibrateOptions {
        sigma: options.sigma,
        seed: options.seed,
        search: options.search,
        inlier_threshold: options.inlier_threshold,
        alternative_margin: options.alternative_margin,
        planar_limit: options.planar_limit,
        anchors: options.anchors.iter().map(|p| p.map(|[x, y, _]| [x, y])).collect(),
        positions: options.positions.iter().map(position).collect(),
        receiver_delays: options.receiver_delays,
        errors: options.errors,
        distances: options.distances.clone(),
        estimate_speed: options.estimate_speed,
    }
}

/// Starts in space from a planar network.
struct Lifted<'a> {
    flat: &'a Calibration,
    size: f64,
}

impl Hypotheses<3> for Lifted<'_> {
    fn propose(&self, measured: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork<3>> {
        let mut rng = generator(seed ^ 0x2f0b_4c47_91d3_55e9, index);
        let height = LIFTED[index % LIFTED.len()] * self.size;
        let mut lift = |p: [f64; 2]| [p[0], p[1], height * rng.sample::<f64, _>(StandardNormal)];
        // The search may work on some of the nodes.
        let place = |all: &[String], name: &String| all.iter().position(|other| other == name);
        let flat = self.flat;
        let receivers = measured.receiver_names().iter();
        let receivers =
            receivers.map(|name| flat.receivers[place(&flat.receiver_names, name)?].map(&mut lift)).collect();
        vec![PartialNetwork { receivers, transmitters: vec![None; measured.transmitters()] }]
    }
}

/// A calibration in space that starts at a planar one; `None` where there is none.
fn lifted(
    measured: &Pseudoranges,
    options: &CalibrateOptions<3>,
    flat: &Calibration,
    monitor: &Monitor,
) -> Result<Option<Calibration<3>>, CalibrateError<3>> {
    let starts = LIFTED.len();
    let mut options = options.clone();
    options.search =
        SearchOptions { min_starts: starts, max_starts: starts, restarts: false, minimal_subsets: 0, ..options.search };
    let source = Lifted { flat, size: spread(flat.receivers.iter().flatten()) };
    unless_stopped(calibrate_with(measured, &options, &[&source], monitor))
}

/// The likelihood ratio of space and plane, over the measurements that both have, with the deviation that
/// is given or left in space. Outliers cost the same in both.
fn compare(
    measured: &Pseudoranges,
    flat: &Calibration,
    whole: &Calibration<3>,
    options: &CalibrateOptions<3>,
) -> DimensionTest {
    let deviation = whole.sigma.max(LEAST_DEVIATION * whole.extent().unwrap_or(0.0));
    let (mut in_plane, mut in_space) = (0.0, 0.0);
    for (i, j, residual) in whole.residuals.iter() {
        let Some(other) = flat.residuals.get(i, j) else { continue };
        let cost = |length: f64| truncated(length / (deviation * measured.sigma(i, j).unwrap_or(1.0)));
        in_plane += cost(other.length);
        in_space += cost(residual.length);
    }
    let located = whole.receivers.iter().flatten().count() + whole.transmitters.iter().flatten().count();
    // Heights, but for those of a plane that moves.
    let heights = located.saturating_sub(3).max(1) as f64;
    let given = options.sigma.is_some() || measured.has_sigmas();
    let quantile = if given {
        ChiSquared::new(heights).ok().map(|all| all.inverse_cdf(QUANTILE))
    } else {
        // Without measurements left over there is no deviation to compare with.
        let left = whole.redundancy as f64;
        FisherSnedecor::new(heights, left).ok().map(|all| heights * all.inverse_cdf(QUANTILE))
    };
    DimensionTest {
        gain: Some(in_plane - in_space).filter(|gain| gain.is_finite()),
        needed: quantile.map(|quantile| 0.5 * BENT * quantile).filter(|needed| needed.is_finite()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, ReceiverFault, SimulateOptions, simulate};

    fn chosen(measured: &Pseudoranges, options: &CalibrateOptions<3>) -> Calibrated {
        calibrate_either(measured, options, &Monitor::default()).unwrap()
    }

    #[test]
    fn planar_networks_stay_planar() {
        for seed in 0..6 {
            let options = SimulateOptions { noise: 0.01, outliers: 0.05, seed, ..Default::default() };
            let made = simulate(&options).unwrap();
            let mut options = CalibrateOptions::<3>::new();
            options.seed = seed;
            let Calibrated::Plane(found) = chosen(&made.pseudoranges, &options) else { panic!("seed {seed}") };
            let test = found.dimension_test.unwrap();
            assert!(test.gain.unwrap() < test.needed.unwrap() && found.planar);
            // The same as without the question.
            let plain = crate::calibrate(&made.pseudoranges, &in_plane(&options)).unwrap();
            assert_eq!(Calibration { dimension_test: None, ..found }, plain);
        }
    }

    #[test]
    fn a_delay_is_no_height() {
        for (seed, size) in [(5, 0.3), (6, 1.0), (7, 3.0)] {
            let made = SimulateOptions { noise: 0.01, fault: Some(ReceiverFault::Delay(size)), seed, ..room() };
            let found = chosen(&simulate(&made).unwrap().pseudoranges, &CalibrateOptions::new());
            assert!(matches!(found, Calibrated::Plane(_)), "{size} m late");
        }
    }

    fn room() -> SimulateOptions {
        SimulateOptions { receivers: 10, transmitters: 20, ..Default::default() }
    }

    #[test]
    fn rooms_are_in_space() {
        for (seed, sigma) in [(0, None), (1, Some(0.01)), (2, None)] {
            let mut made = SimulateOptions::<3>::new();
            (made.receivers, made.transmitters, made.noise, made.seed) = (10, 20, 0.01, seed);
            made.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            let made = simulate(&made).unwrap();
            let mut options = CalibrateOptions::<3>::new();
            (options.seed, options.sigma) = (seed, sigma);
            let Calibrated::Space(found) = chosen(&made.pseudoranges, &options) else { panic!("seed {seed}") };
            let test = found.dimension_test.unwrap();
            assert!(test.gain.unwrap() > 10.0 * test.needed.unwrap(), "seed {seed}: {test:?}");
        }
    }

    #[test]
    fn known_positions_decide() {
        let made = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        let mut options = CalibrateOptions::<3>::new();
        let anchors = |z: f64| made.network.receivers.iter().map(|p| Some([p[0], p[1], z])).collect::<Vec<_>>();
        options.anchors = anchors(0.0);
        assert!(
            matches!(chosen(&made.pseudoranges, &options), Calibrated::Plane(found) if found.dimension_test.is_none())
        );
        // All at one height, which fixes nothing in space.
        options.anchors = anchors(1.5);
        assert!(matches!(chosen(&made.pseudoranges, &options), Calibrated::Plane(_)));
        let mut made = SimulateOptions::<3>::new();
        (made.receivers, made.transmitters, made.noise) = (10, 20, 0.01);
        let made = simulate(&made).unwrap();
        options.anchors = made.network.receivers.iter().copied().map(Some).collect();
        assert!(
            matches!(chosen(&made.pseudoranges, &options), Calibrated::Space(found) if found.dimension_test.is_none())
        );
    }

    #[test]
    fn too_few_measurements_for_space_leave_the_plane() {
        let made = simulate(&SimulateOptions { receivers: 6, transmitters: 4, noise: 0.01, ..Default::default() });
        let Calibrated::Plane(found) = chosen(&made.unwrap().pseudoranges, &CalibrateOptions::new()) else { panic!() };
        assert_eq!(found.dimension_test, Some(DimensionTest::UNTRIED));
    }
}
