//! Whether a network is flat: a calibration in the plane and one in space, compared by how likely they make the
//! measurements.

use crate::calibrate::input::anchors;
use crate::calibrate::judge::dimension_test::DimensionTest;
use crate::calibrate::judge::raised::{RAISED, may_be_raised};
use crate::calibrate::model::calibrated::{Calibrated, CalibratedError};
use crate::calibrate::model::errors_chosen::with_errors_chosen;
use crate::calibrate::model::excluded::plane_is_excluded;
use crate::calibrate::model::heights_test::InSpace;
use crate::calibrate::model::known_heights::{KnownHeights, in_plane};
use crate::calibrate::model::lifted::{from_plane, lifted, unless_stopped};
use crate::calibrate::model::question::Question;
use crate::calibrate::options::{CalibrateOptions, ReceiverDelays};
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::steps::{Draft, calibrate_with};
use crate::flatness::{FLAT, slenderness};
use crate::network::Network;
use crate::points::dot;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;

/// Starts of the search in the plane, before one in space tells whether more are worth it.
const FIRST_STARTS: usize = 96;

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
    let question = Question { measured, in_space: options, in_plane: &first, monitor };
    let from_plane = from_plane(options);

    let draft = Draft::searched(measured, &first, &[], monitor)?;
    let raised = lifted(measured, &from_plane, &draft, monitor)?;
    if raised.as_ref().is_some_and(|raised| plane_is_excluded(&draft, raised))
        && let Some(space) = question.without_plane(&draft)?
    {
        return Ok(Calibrated::Space(space));
    }
    let mut flat = draft.cleared()?.judged()?;
    let settled = first.search.max_starts == plane.search.max_starts || flat.starts < first.search.max_starts;
    let is_plain = settled && flat.fits && flat.unique_receivers;
    // Errors of receivers that are told, and not taken out, change nothing of the networks; in space on planar measurements
    // it takes longest to look for them, and to tell how sure the network is.
    if is_plain
        && options.receiver_delays == ReceiverDelays::None
        && let Some(raised) = &raised
        && let Some(raised) = unless_stopped(raised.clone().without_reflections())?
        && let Some(raised) = unless_stopped(InSpace::likeliest(&raised))?.flatten()
    {
        let test = question.test(&flat, &raised);
        if !test.is_space() {
            return Ok(Calibrated::Plane(planar(flat, test)));
        }
    }
    let raised = match raised {
        Some(raised) => unless_stopped(raised.cleared().and_then(Draft::judged))?,
        None => None,
    };
    let mut test = raised.as_ref().map_or_else(DimensionTest::default, |raised| question.compare(&flat, raised));
    if !is_plain || test.is_space() {
        match question.search_space(&flat, raised, test)? {
            Some((space, true)) => return Ok(Calibrated::Space(space)),
            Some((space, false)) => test = space.dimension_test.unwrap_or(test),
            None => {}
        }
        if !settled {
            flat = calibrate_with(measured, &plane, &[], monitor)?;
        }
    }
    Ok(Calibrated::Plane(planar(flat, test)))
}

/// The planar network that is chosen, with what speaks against it.
fn planar(mut flat: Calibration, test: DimensionTest) -> Calibration {
    doubt(&mut flat, test);
    if on_conics(&flat) {
        flat.determined = false;
        flat.call_not_unique(RAISED.into());
    }
    flat
}

/// Whether a planar network that was not said to be one, or another that fits as well, may have its transmitters raised.
fn on_conics(flat: &Calibration) -> bool {
    let variances: Vec<f64> = flat.receiver_std.iter().flatten().map(|std| dot(*std, *std)).collect();
    let std = (variances.iter().sum::<f64>() / variances.len().max(1) as f64).sqrt();
    let others = flat.alternatives.iter().map(|other| (&other.receivers, &other.transmitters));
    others.chain([(&flat.receivers, &flat.transmitters)]).any(|(receivers, transmitters)| {
        let located = transmitters.iter().flatten().copied();
        let offsets = vec![0.0; located.clone().count()];
        let network = Network::new(receivers.iter().flatten().copied().collect(), located.collect(), offsets);
        may_be_raised(&network, std)
    })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Layout, ReceiverFault, SimulateOptions, simulate};

    fn chosen(measured: &Pseudoranges, options: &CalibrateOptions<3>) -> Calibrated {
        calibrate_either(measured, options, &Monitor::default()).unwrap()
    }

    /// What is known of each measurement by itself says as much of heights as the same deviation for all, also where it is small
    /// beside the network.
    #[test]
    fn deviations_of_single_measurements_say_the_same() {
        let mut made =
            SimulateOptions { receivers: 10, transmitters: 20, noise: 6e-4, seed: 6, ..SimulateOptions::<3>::new() };
        made.layout = Layout::Room { extent: [8.0, 6.0, 3.0] };
        let common = simulate(&made).unwrap().pseudoranges;
        let own = common.clone().with_sigma_of(|_, _| 6e-4).unwrap();
        let options = CalibrateOptions { sigma: Some(6e-4), ..CalibrateOptions::new() };
        let [common, own] =
            [chosen(&common, &options), chosen(&own, &CalibrateOptions::new())].map(|found| match found {
                Calibrated::Space(found) => found,
                Calibrated::Plane(_) => panic!("a room is no plane"),
            });
        assert!(common.unique && own.unique, "{:?} {:?}", common.warnings, own.warnings);
        let evidence = [&common, &own].map(|found| found.dimension_test.unwrap().evidence.unwrap());
        assert!((evidence[0] - evidence[1]).abs() < 1e-3 * evidence[0], "{evidence:?}");
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
