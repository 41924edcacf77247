use super::{LocateError, LocatedEvent, Locator, Unplaced};
use crate::align::align;
use crate::calibrate::{Calibrates, Dimension};
use crate::points::{distance, minus};
use crate::{
    CalibrateOptions, Calibration, Emissions, Pseudoranges, ReceiverClocks, SimulateOptions, Simulation, calibrate,
    simulate,
};

/// Transmitters that calibrate a network, and new ones.
const KNOWN: usize = 20;
const NEW: usize = 20;

/// Numbers from one to before another.
fn numbers(from: usize, to: usize) -> Vec<usize> {
    (from..to).collect()
}

/// A network calibrated with the first transmitters, in its true frame: with known receivers if these are to be held.
fn calibrated<const D: usize>(made: &Simulation<D>, options: &CalibrateOptions<D>, held: bool) -> Calibration<D>
where
    Dimension<D>: Calibrates<D>,
{
    let mut options = options.clone();
    let receivers = made.network.receivers.clone();
    if held {
        options.anchors = receivers.iter().copied().map(Some).collect();
    }
    let measured = made.pseudoranges.select(&numbers(0, receivers.len()), &numbers(0, KNOWN));
    let mut network = calibrate(&measured, &options).unwrap();
    let found: Vec<[f64; D]> = network.receivers.iter().map(|place| place.unwrap()).collect();
    network.transform(&align(&found, &receivers, false).unwrap().transform);
    network
}

/// The new transmitters, located by receivers of these numbers.
fn located<const D: usize>(network: &Calibration<D>, made: &Simulation<D>, by: &[usize]) -> Vec<LocatedEvent<D>> {
    Locator::new(network, Some(0.01)).unwrap().locate(&heard(made, by, &numbers(KNOWN, KNOWN + NEW))).unwrap()
}

/// What some receivers, which are named, hear of some transmitters.
fn heard<const D: usize>(made: &Simulation<D>, by: &[usize], of: &[usize]) -> Pseudoranges {
    let names = by.iter().map(|&i| made.pseudoranges.receiver_names()[i].clone()).collect();
    made.pseudoranges.select(by, of).with_receiver_names(names).unwrap()
}

fn network<const D: usize>(seed: u64) -> SimulateOptions<D> {
    let mut options = SimulateOptions::<D>::new();
    (options.receivers, options.transmitters, options.noise, options.seed) = (10, KNOWN + NEW, 0.01, seed);
    options
}

/// The square of an error in its standard deviations.
fn mahalanobis<const D: usize>(error: [f64; D], covariance: &[[f64; D]; D]) -> f64 {
    let matrix = faer::Mat::from_fn(D, D, |a, b| covariance[a][b]);
    let right = faer::Mat::from_fn(D, 1, |a, _| error[a]);
    let solved = faer::linalg::solvers::Solve::solve(&matrix.partial_piv_lu(), &right);
    (0..D).map(|k| error[k] * solved[(k, 0)]).sum()
}

/// Errors are as large as covariances have them: with known receivers their squares have the mean of chi-squared, whether some
/// measurements are wrong or not.
fn errors_are_as_said<const D: usize>()
where
    Dimension<D>: Calibrates<D>,
{
    for outliers in [0.0, 0.05] {
        let (mut squares, mut count, mut offsets) = (0.0, 0, 0.0);
        for seed in 0..5 {
            let made = simulate(&SimulateOptions { outliers, ..network::<D>(seed) }).unwrap();
            let network = calibrated(&made, &CalibrateOptions::new(), true);
            for (j, event) in located(&network, &made, &numbers(0, 10)).iter().enumerate() {
                let (place, truth) = (event.place.as_ref().unwrap(), &made.network);
                assert!(place.fits && event.heard == 10, "{seed} {j}: {event:?}");
                squares += mahalanobis(minus(place.position, truth.transmitters[KNOWN + j]), &place.covariance);
                offsets += ((place.offset - truth.offsets[KNOWN + j]) / place.offset_std).powi(2);
                count += 1;
            }
        }
        // The mean of 100 draws of chi-squared with D degrees of freedom has a deviation of sqrt(2 D / 100).
        let (mean, of_offset) = (squares / f64::from(count), offsets / f64::from(count));
        let within = 4.0 * (2.0 * D as f64 / f64::from(count)).sqrt();
        assert!((mean - D as f64).abs() < within, "{outliers}: {mean}");
        assert!((of_offset - 1.0).abs() < 4.0 * (2.0 / f64::from(count)).sqrt(), "{outliers}: {of_offset}");
    }
}

#[test]
fn errors_are_as_covariances_have_them() {
    errors_are_as_said::<2>();
    errors_are_as_said::<3>();
}

/// The errors of the receivers are in the covariances: without them errors would be larger than these say.
#[test]
fn receivers_errors_count() {
    let (mut squares, mut count) = (0.0, 0);
    for seed in 10..14 {
        let made = simulate(&network::<2>(seed)).unwrap();
        let network = calibrated(&made, &CalibrateOptions::new(), false);
        for (j, event) in located(&network, &made, &numbers(0, 10)).iter().enumerate() {
            let place = event.place.as_ref().unwrap();
            squares += mahalanobis(minus(place.position, made.network.transmitters[KNOWN + j]), &place.covariance);
            count += 1;
        }
    }
    // Errors of receivers are taken to be independent, which they are not: half and twice the mean of chi-squared are bounds.
    let mean = squares / f64::from(count);
    assert!((1.0..4.0).contains(&mean), "{mean}");
}

#[test]
fn wrong_measurements_are_named() {
    let made = simulate(&SimulateOptions { outliers: 0.1, outlier_size: 10.0, ..network::<3>(1) }).unwrap();
    let network = calibrated(&made, &CalibrateOptions::new(), true);
    let (mut named, mut wrong) = (0, 0);
    for (j, event) in located(&network, &made, &numbers(0, 10)).iter().enumerate() {
        let place = event.place.as_ref().unwrap();
        let truly: Vec<&String> = (0..10)
            .filter(|i| made.outliers[i * (KNOWN + NEW) + KNOWN + j])
            .map(|i| &network.receiver_names[i])
            .collect();
        let far = distance(place.position, made.network.transmitters[KNOWN + j]);
        assert!(far < 0.3, "{j}: {far} {event:?}");
        wrong += truly.len();
        named += truly.iter().filter(|name| place.outliers.contains(name)).count();
        assert!(place.outliers.len() <= truly.len() + 1, "{j}: {truly:?} {event:?}");
    }
    // Errors are uniform up to 10 m: one of less than 5 cm, which noise hides, is one in two hundred.
    assert!(wrong >= 10 && named + 1 >= wrong, "{named} of {wrong}");
}

/// Three receivers in the plane, and four in space, have two solutions as often as both are in front of all receivers: the truth is
/// one of those that are given. With one receiver more there is one, unless both are near.
#[test]
fn as_few_receivers_as_unknowns_leave_a_second_place() {
    let mut second = 0;
    for seed in 20..24 {
        let made = simulate(&network::<2>(seed)).unwrap();
        let network = calibrated(&made, &CalibrateOptions::new(), true);
        for (j, event) in located(&network, &made, &[0, 1, 2]).iter().enumerate() {
            let place = event.place.as_ref().unwrap();
            let truth = made.network.transmitters[KNOWN + j];
            let off = minus(place.position, truth);
            let is_best = mahalanobis(off, &place.covariance) < 25.0;
            let is_other = place.others.iter().any(|other| distance(other.position, truth) < 1.0);
            assert!(is_best || is_other, "{seed} {j}: {truth:?} {event:?}");
            assert!(place.redundancy == 0 && place.unique == place.others.is_empty() && place.others.len() <= 1);
            second += place.others.len();
        }
    }
    assert!(second > 0);
}

#[test]
fn receivers_in_a_plane_of_space_leave_the_mirror_image() {
    let made = simulate(&network::<3>(3)).unwrap();
    let mut network = calibrated(&made, &CalibrateOptions::new(), true);
    // The receivers, and what they hear of a transmitter, are put into a plane.
    let places: Vec<[f64; 3]> = made.network.receivers.iter().map(|place| [place[0], place[1], 1.0]).collect();
    network.receivers = places.iter().copied().map(Some).collect();
    let truth = [4.0, 7.0, 2.5];
    let measured =
        Pseudoranges::new(10, 1, places.iter().map(|place| distance(*place, truth) + 3.0).collect()).unwrap();
    let measured = measured.with_receiver_names(network.receiver_names.clone()).unwrap();
    let event = Locator::new(&network, Some(0.01)).unwrap().locate(&measured).unwrap().remove(0);
    let place = event.place.unwrap();
    assert!(place.fits && !place.unique && place.others.len() == 1, "{place:?}");
    let both = [place.position, place.others[0].position];
    assert!(both.iter().any(|found| distance(*found, truth) < 1e-3), "{both:?}");
    assert!(both.iter().any(|found| distance(*found, [4.0, 7.0, -0.5]) < 1e-3), "{both:?}");
}

/// Ranges have no offset, and readings of clocks are corrected.
#[test]
fn clocks_are_those_of_the_network() {
    let mut options = network::<2>(5);
    options.emissions = Emissions::Known;
    let made = simulate(&options).unwrap();
    let mut calibrate = CalibrateOptions::new();
    calibrate.clocks.emissions = Emissions::Known;
    let network = calibrated(&made, &calibrate, true);
    for (j, event) in located(&network, &made, &[3, 5, 8]).iter().enumerate() {
        let place = event.place.as_ref().unwrap();
        let off = minus(place.position, made.network.transmitters[KNOWN + j]);
        assert!(place.offset == 0.0 && mahalanobis(off, &place.covariance) < 25.0, "{j}: {event:?}");
    }

    let mut options = network_with_clocks();
    options.duration = Some(2e5);
    let made = simulate(&options).unwrap();
    let mut calibrate = CalibrateOptions::new();
    calibrate.clocks.receivers = ReceiverClocks::Rate;
    let network = calibrated(&made, &calibrate, true);
    for (j, event) in located(&network, &made, &numbers(0, 10)).iter().enumerate() {
        let place = event.place.as_ref().unwrap();
        let off = distance(place.position, made.network.transmitters[KNOWN + j]);
        // Clocks have errors of their own, of about the noise over the root of the number of transmitters.
        assert!(off < 0.1 && place.redundancy >= 5, "{j}: {off} {event:?}");
    }
    let other =
        made.pseudoranges.select(&numbers(0, 10), &[KNOWN]).with_recorders(vec!["other".to_string(); 10]).unwrap();
    let error = Locator::new(&network, None).unwrap().locate(&other).unwrap_err();
    assert_eq!(error, LocateError::Recorder { recorder: "other".to_string() });
}

/// One offset for all is taken off, with clocks of recorders too; where transmitters sent by a schedule, a new one has an offset
/// by that clock.
#[test]
fn a_constant_is_the_network_s() {
    for (delays, faster) in [(0.0, 1.0), (100.0, 1.0), (0.0, 1.05)] {
        let made = simulate(&SimulateOptions { emissions: Emissions::Constant, delays, ..network::<2>(8) }).unwrap();
        let mut options = CalibrateOptions::new();
        options.clocks.emissions = Emissions::Constant;
        if delays > 0.0 {
            options.clocks.receivers = ReceiverClocks::Offset;
        }
        // Lengths at a speed that is too low are too short, until known positions tell it.
        let mut slow = made.clone();
        slow.pseudoranges = made.pseudoranges.map(|_, _, value| value / faster);
        options.estimate_speed = faster > 1.0;
        let network = calibrated(&slow, &options, true);
        assert_eq!(network.speed.is_some_and(|speed| (speed.factor - faster).abs() < 0.01), options.estimate_speed);
        // Three ranges leave one place, where three pseudoranges leave two.
        for (j, event) in located(&network, &slow, &[2, 5, 8]).iter().enumerate() {
            let place = event.place.as_ref().unwrap();
            let off = distance(place.position, made.network.transmitters[KNOWN + j]);
            let is_near = off < 0.2
                || place
                    .others
                    .iter()
                    .any(|other| distance(other.position, made.network.transmitters[KNOWN + j]) < 0.2);
            assert!(is_near && place.redundancy == 1 && place.offset == 0.0, "{delays} {faster} {j}: {off} {event:?}");
        }
    }
    let made = simulate(&network::<2>(9)).unwrap();
    let times: Vec<f64> = made.network.offsets[..KNOWN].iter().map(|offset| offset - 50.0).collect();
    let known = heard(&made, &numbers(0, 10), &numbers(0, KNOWN)).with_emission_times(times).unwrap();
    let mut options = CalibrateOptions::new();
    options.clocks.emissions = Emissions::Constant;
    options.anchors = made.network.receivers.iter().copied().map(Some).collect();
    let network = calibrate(&known, &options).unwrap();
    for (j, event) in located(&network, &made, &numbers(0, 10)).iter().enumerate() {
        let place = event.place.as_ref().unwrap();
        let off = distance(place.position, made.network.transmitters[KNOWN + j]);
        // A rate against the schedule is told to the noise over the time of twenty events.
        assert!(off < 0.1 && place.fits && place.redundancy >= 5, "{j}: {off} {event:?}");
    }
}

fn network_with_clocks() -> SimulateOptions<2> {
    SimulateOptions { delays: 1000.0, rates: 2e-5, ..network::<2>(6) }
}

#[test]
fn what_cannot_be_located_is_said() {
    let made = simulate(&network::<2>(7)).unwrap();
    let mut network = calibrated(&made, &CalibrateOptions::new(), true);
    let locator = Locator::new(&network, None).unwrap();
    let few = locator.locate(&heard(&made, &[1, 4], &[KNOWN])).unwrap().remove(0);
    assert_eq!((few.place, few.problem), (None, Some(Unplaced::TooFew { heard: 2, least: 3 })));
    let other = made.pseudoranges.clone().with_receiver_names((0..10).map(|k| format!("other{k}")).collect()).unwrap();
    assert!(matches!(locator.locate(&other), Err(LocateError::Unknown { .. })));
    let unnamed = Pseudoranges::new(3, 1, vec![1.0, 2.0, 3.0]).unwrap();
    assert_eq!(locator.locate(&unnamed), Err(LocateError::Count { given: 3, known: 10 }));
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Locator::new(&network, Some(value)), Err(LocateError::Sigma { .. })), "{value}");
    }
    // A deviation that is given is a factor where measurements carry their own.
    let own = made.pseudoranges.clone().with_sigma_of(|_, _| 0.02).unwrap();
    let [twice, same] = [(Some(2.0), own), (Some(0.04), made.pseudoranges.clone())]
        .map(|(sigma, measured)| Locator::new(&network, sigma).unwrap().locate(&measured).unwrap());
    let stds =
        |all: &[LocatedEvent]| all.iter().map(|event| event.place.as_ref().unwrap().position_std).collect::<Vec<_>>();
    let pairs = stds(&twice).into_iter().zip(stds(&same));
    assert!(pairs.into_iter().all(|(a, b)| (a[0] - b[0]).abs() < 1e-6 * b[0]));
    // All receivers at one place tell nothing.
    network.receivers = vec![Some([1.0, 1.0]); 10];
    let nowhere = Locator::new(&network, None).unwrap().locate(&made.pseudoranges).unwrap();
    assert!(
        nowhere.iter().all(|event| event.problem == Some(Unplaced::Degenerate) || !event.place.as_ref().unwrap().fits)
    );
    (network.sigma, network.receivers[2]) = (f64::NAN, None);
    let locator = Locator::new(&network, None).unwrap();
    assert!(locator.notes()[0].contains(&network.receiver_names[2]));
    assert_eq!(locator.locate(&made.pseudoranges), Err(LocateError::NoSigma));
    network.fits = false;
    assert!(matches!(Locator::new(&network, None), Err(LocateError::Distrust { .. })));
}
