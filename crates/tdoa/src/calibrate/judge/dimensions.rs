//! Whether a network is flat: a calibration in the plane and one in space, compared by how likely they make the
//! measurements.

use crate::calibrate::input::anchors;
use crate::calibrate::judge::dimension_test::DimensionTest;
use crate::calibrate::judge::errors_chosen::{Decided, Verdict, with_errors_chosen};
use crate::calibrate::judge::excluded::plane_is_excluded;
use crate::calibrate::judge::explained::explained_by_errors;
use crate::calibrate::judge::known_heights::{KnownHeights, in_plane};
use crate::calibrate::judge::lifted::{Known, from_sources, lifted, unless_stopped};
use crate::calibrate::options::{CalibrateError, CalibrateOptions, Errors, ReceiverDelays};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::search::hypotheses::Hypotheses;
use crate::calibrate::search::truncated_cost::truncated;
use crate::calibrate::steps::{calibrate_looking, calibrate_with};
use crate::flatness::{FLAT, slenderness};
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};
use thiserror::Error;

/// Probability of the quantile that the gain of heights must exceed.
const QUANTILE: f64 = 1.0 - 1e-4;

/// Heights enter distances by their squares, and the search takes the best of many networks: gains of
/// planar networks have about twice the mean that as many unknowns of a linear model would give (measured
/// on 20 to 30 planar networks of six kinds; `tdoa experiment dimension` counts).
const BENT: f64 = 2.0;

/// Starts of the search in the plane, before one in space tells whether more are worth it.
const FIRST_STARTS: usize = 96;

/// Deviations of measurements are at least this share of the network's size: exact ones have no noise.
const LEAST_DEVIATION: f64 = 1e-6;

/// A network whose dimension was chosen by its measurements.
#[derive(Debug, Clone, PartialEq)]
pub enum Calibrated {
    /// In the plane.
    Plane(Calibration),
    /// In space.
    Space(Calibration<3>),
}

impl Decided for Calibrated {
    fn verdict(&self) -> Verdict {
        match self {
            Calibrated::Plane(found) => found.verdict(),
            Calibrated::Space(found) => found.verdict(),
        }
    }

    fn warnings(&mut self) -> &mut Vec<String> {
        match self {
            Calibrated::Plane(found) => &mut found.warnings,
            Calibrated::Space(found) => &mut found.warnings,
        }
    }
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

/// Calibrates in space, or in the plane where the measurements do not need a third coordinate.
///
/// Known positions of different heights are in space. Otherwise the measurements decide, whatever the height of known
/// positions; known positions without heights are for the plane, which is not unique where the measurements ask for
/// space. Heights above the plane are normal in space, with deviations from the measurements, and the plane is reported
/// where the measurements are likelier in it, over all networks ([`Calibration::dimension_test`]). Where neither is a
/// hundred times as likely, or the measurements are too few for space, no network is called unique, unless the
/// likeliest heights are too small to matter. Errors of receivers that the planar network shows are no reason for
/// heights. `options.seed` and the rest are for both.
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
/// Those of [`calibrate_with`](crate::calibrate::calibrate_with), of the calibration that failed or was stopped.
pub fn calibrate_either(
    measured: &Pseudoranges,
    options: &CalibrateOptions<3>,
    monitor: &Monitor,
) -> Result<Calibrated, CalibratedError> {
    with_errors_chosen(options, monitor, |options| with_dimension_chosen(measured, options, monitor))
}

/// [`calibrate_either`] with errors as these options have them.
fn with_dimension_chosen(
    measured: &Pseudoranges,
    options: &CalibrateOptions<3>,
    monitor: &Monitor,
) -> Result<Calibrated, CalibratedError> {
    let heights = KnownHeights::of(options);
    if heights == KnownHeights::Different {
        // Nobody asked.
        let found = calibrate_with(measured, options, &[], monitor)?;
        return Ok(Calibrated::Space(Calibration { dimension_test: None, ..found }));
    }
    if options.anchors.iter().all(Option::is_none) && options.positions.is_empty() {
        return choose(measured, options, monitor);
    }
    let plane = in_plane(options, measured.receivers());
    anchors::validate(measured, &plane)?;
    // Positions at one height say where these nodes are, and not that all others are there.
    let free =
        CalibrateOptions { anchors: Vec::new(), positions: Vec::new(), estimate_speed: false, ..options.clone() };
    let test = match choose(measured, &free, monitor)? {
        Calibrated::Space(chosen) if heights == KnownHeights::One => {
            let found = calibrate_with(measured, options, &[], monitor)?;
            return Ok(Calibrated::Space(Calibration { dimension_test: chosen.dimension_test, ..found }));
        }
        Calibrated::Space(chosen) => chosen.dimension_test,
        Calibrated::Plane(chosen) => chosen.dimension_test,
    };
    let mut found = calibrate_with(measured, &plane, &[], monitor)?;
    let test = test.unwrap_or_default();
    if test.is_space() {
        found.dimension_test = Some(test);
        found.call_not_unique(
            "the measurements ask for space, but the known positions have x and y alone; give z, one height for all if they have it".into(),
        );
    } else {
        doubt(&mut found, test);
    }
    Ok(Calibrated::Plane(found))
}

/// [`with_dimension_chosen`] without known positions.
fn choose(
    measured: &Pseudoranges,
    options: &CalibrateOptions<3>,
    monitor: &Monitor,
) -> Result<Calibrated, CalibratedError> {
    let plane = in_plane(options, measured.receivers());
    let mut first = plane.clone();
    first.search.max_starts = plane.search.max_starts.min(FIRST_STARTS.max(plane.search.min_starts));
    let mut excluded = false;
    let mut flat = calibrate_looking(measured, &first, &[], monitor, |plane| {
        excluded = plane_is_excluded(plane, options);
        !excluded
    })?;
    if excluded {
        if let Some(found) = unless_stopped(calibrate_with(measured, options, &[], monitor))? {
            let test = compare(measured, &flat, &found, options);
            if found.fits && test.is_space() {
                return Ok(Calibrated::Space(Calibration { dimension_test: Some(test), ..found }));
            }
        }
        flat = calibrate_with(measured, &first, &[], monitor)?;
    }
    let settled = first.search.max_starts == plane.search.max_starts || flat.starts < first.search.max_starts;
    let raised = lifted(measured, options, &flat, monitor)?;
    let mut test =
        raised.as_ref().map_or_else(DimensionTest::default, |raised| compare(measured, &flat, raised, options));
    if settled && flat.fits && flat.unique_receivers && !test.is_space() {
        doubt(&mut flat, test);
        return Ok(Calibrated::Plane(flat));
    }
    let known = raised.as_ref().map(Known);
    let sources: Vec<&dyn Hypotheses<3>> = known.iter().map(|source| source as &dyn Hypotheses<3>).collect();
    let mut in_space = options.clone();
    if flat.fits && !test.is_space() {
        // Planar measurements have many networks in space that fit alike, on which starts do not agree.
        in_space.search.max_starts = first.search.max_starts;
    }
    if let Some(mut whole) = unless_stopped(calibrate_with(measured, &in_space, &sources, monitor))? {
        let otherwise = otherwise_cleared(measured, &first, &flat, monitor)?;
        let takes_out = first.receiver_delays == ReceiverDelays::Auto;
        // With the errors of receivers, and without.
        let [bent, judged] = match &otherwise {
            Some(otherwise) if takes_out => [otherwise, &flat],
            Some(otherwise) => [&flat, otherwise],
            None => [&flat; 2],
        };
        let found = compare(measured, judged, &whole, options);
        // What fits best need not be likeliest: a few heights may say about what many do.
        let likelier = if found.evidence >= test.evidence { found } else { test };
        if let Some(first) = raised.filter(|first| first.determined && test.is_likelier_than(&found)) {
            whole = first;
            whole.call_not_unique(
                "another network fits the measurements more closely, with heights that are less likely".into(),
            );
        }
        let explained = otherwise.as_ref().map_or(0.0, |_| explained_by_errors(measured, bent, judged));
        let evidence = likelier.evidence.map(|evidence| evidence - explained);
        test = DimensionTest { evidence, change: likelier.change, ..found };
        // Where nothing fits, the better one is told.
        if (whole.fits || !flat.fits) && (test.is_space() || (whole.fits && !judged.fits)) {
            if test.leaves_both() && judged.fits {
                whole.call_not_unique("the measurements are nearly as likely in the plane as in space".into());
            }
            whole.dimension_test = Some(test);
            return Ok(Calibrated::Space(whole));
        }
    }
    if !settled {
        flat = calibrate_with(measured, &plane, &[], monitor)?;
    }
    doubt(&mut flat, test);
    Ok(Calibrated::Plane(flat))
}

/// Says of a planar network what speaks for space.
fn doubt(flat: &mut Calibration, test: DimensionTest) {
    flat.dimension_test = Some(test);
    if test.needed.is_none() {
        flat.call_not_unique(
            "the measurements are too few to tell whether all nodes lie in one plane, as this network has it; --dimensions 2 says that they \
             do"
            .into(),
        );
    } else if test.leaves_both() || test.is_space() {
        flat.call_not_unique(
            "the measurements do not tell whether all nodes lie in one plane, as this network has it; --dimensions 2 says that they do, \
             --dimensions 3 gives the network in space"
                .into(),
        );
    }
    let is_line = |nodes: &[Option<[f64; 2]>]| slenderness(&nodes.iter().flatten().copied().collect::<Vec<_>>()) < FLAT;
    if is_line(&flat.transmitters) {
        flat.determined = false;
        flat.call_not_unique(
            "the transmitters lie in one line, about which each receiver may be turned out of this plane, and fits as well; move some \
             transmitters off the line, or say with --dimensions 2 that all nodes lie in one plane"
                .into(),
        );
    } else if is_line(&flat.receivers) {
        flat.call_not_unique(
            "the receivers lie in one line, about which each transmitter may be turned out of this plane, and fits as well; move some \
             receivers off the line, or say with --dimensions 2 that all nodes lie in one plane"
                .into(),
        );
    }
}

/// The planar network without the errors that receivers show in it, or with them where they are taken out; `None` if it
/// shows none.
fn otherwise_cleared(
    measured: &Pseudoranges,
    options: &CalibrateOptions,
    flat: &Calibration,
    monitor: &Monitor,
) -> Result<Option<Calibration>, CalibrateError> {
    if flat.receiver_errors.is_empty() || options.errors == Errors::OneSided {
        return Ok(None);
    }
    let receiver_delays = match options.receiver_delays {
        ReceiverDelays::None => ReceiverDelays::Auto,
        ReceiverDelays::Auto => ReceiverDelays::None,
        // Errors of all are no doubt of one.
        ReceiverDelays::All => return Ok(None),
    };
    // Its search would find the same.
    let options = CalibrateOptions { receiver_delays, search: from_sources(1, options.search), ..options.clone() };
    unless_stopped(calibrate_with(measured, &options, &[&Known(flat)], monitor))
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
    let of_heights = whole.dimension_test.unwrap_or_default();
    DimensionTest {
        evidence: of_heights.evidence,
        change: of_heights.change,
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
            assert!(test.gain.unwrap() < test.needed.unwrap() && test.evidence.unwrap() < 0.0 && found.planar);

            // The same as without the question.
            let plain = crate::calibrate(&made.pseudoranges, &in_plane(&options, 0)).unwrap();
            if !test.leaves_both() {
                assert_eq!(Calibration { dimension_test: None, ..found }, plain);
            }
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
            assert!(test.evidence.unwrap() > 100.0, "seed {seed}: {test:?}");
        }
    }

    #[test]
    fn known_positions_decide() {
        let made = simulate(&SimulateOptions { noise: 0.01, ..Default::default() }).unwrap();
        let mut options = CalibrateOptions::<3>::new();
        let anchors = |z: f64| made.network.receivers.iter().map(|p| Some([p[0], p[1], z])).collect::<Vec<_>>();
        options.anchors = anchors(0.0);
        // All at one height, which says nothing of the transmitters.
        assert!(matches!(chosen(&made.pseudoranges, &options), Calibrated::Plane(_)));
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

    /// Three receivers of a room are known, and happen to be at one height.
    #[test]
    fn positions_at_one_height_do_not_make_a_plane() {
        let mut made = SimulateOptions::<3>::new();
        (made.receivers, made.transmitters, made.noise) = (10, 20, 0.01);
        let mut network = simulate(&made).unwrap().network;
        (0..3).for_each(|i| network.receivers[i][2] = 2.0);
        let measured = Pseudoranges::new(10, 20, network.pseudoranges()).unwrap();
        let mut options = CalibrateOptions::<3>::new();
        options.sigma = Some(0.01);
        options.anchors = network.receivers.iter().enumerate().map(|(i, p)| (i < 3).then_some(*p)).collect();
        let Calibrated::Space(found) = chosen(&measured, &options) else { panic!("in the plane") };
        let truth: Vec<Option<[f64; 3]>> = network.receivers.iter().copied().map(Some).collect();
        let positions: Vec<[f64; 3]> = found.receivers.iter().flatten().copied().collect();
        let apart = crate::align::align(&positions, &truth.into_iter().flatten().collect::<Vec<_>>(), false).unwrap();
        assert!(apart.rms < 1e-3, "{}", apart.rms);
    }

    #[test]
    fn too_few_measurements_for_space_leave_the_plane() {
        let made = simulate(&SimulateOptions { receivers: 6, transmitters: 4, noise: 0.01, ..Default::default() });
        let Calibrated::Plane(found) = chosen(&made.unwrap().pseudoranges, &CalibrateOptions::new()) else { panic!() };
        assert_eq!(found.dimension_test, Some(DimensionTest::default()));
        assert!(!found.unique && found.warnings.iter().any(|warning| warning.contains("too few to tell")));
    }
}
