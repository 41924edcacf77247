use super::ReceiverErrorKind;
use crate::align::align;
use crate::calibrate::receivers::evidence::tests::late;
use crate::{CalibrateOptions, Calibration, ReceiverDelays, ReceiverFault, SimulateOptions, calibrate, simulate};

const SIGMA: f64 = 0.01;

/// A calibration and how far its receivers are from the truth, metres.
fn run(fault: Option<ReceiverFault>, handling: ReceiverDelays, seed: u64) -> (Calibration, f64) {
    let options = SimulateOptions { receivers: 10, transmitters: 20, noise: SIGMA, fault, seed, ..Default::default() };
    let simulation = simulate(&options).unwrap();
    let options = CalibrateOptions { receiver_delays: handling, seed, ..Default::default() };
    let found = calibrate(&simulation.pseudoranges, &options).unwrap();
    let pairs = found.receivers.iter().zip(&simulation.network.receivers).filter_map(|(p, q)| Some(((*p)?, *q)));
    let (placed, truth): (Vec<_>, Vec<_>) = pairs.unzip();
    let error = align(&placed, &truth, false).unwrap().rms;
    (found, error)
}

#[test]
fn the_receiver_and_its_error_are_named_and_taken_out() {
    for (fault, kind, size) in [
        (ReceiverFault::Delay(0.3), ReceiverErrorKind::Delay, 0.3),
        (ReceiverFault::Drift(0.5), ReceiverErrorKind::Drift, 0.5),
        (ReceiverFault::Move(1.0), ReceiverErrorKind::Move, 1.0),
    ] {
        for seed in 0..3 {
            let (told, _) = run(Some(fault), ReceiverDelays::None, seed);
            let error = &told.receiver_errors[0];
            assert_eq!((error.receiver.as_str(), error.kind, error.taken_out), ("r1", kind, false), "{fault:?} {seed}");
            assert!(!told.unique && told.warnings.iter().any(|warning| warning.contains("receiver r1 seems")));
            let (mended, right) = run(Some(fault), ReceiverDelays::Auto, seed);
            let error = &mended.receiver_errors[0];
            assert_eq!((error.receiver.as_str(), error.kind, error.taken_out), ("r1", kind, true), "{fault:?} {seed}");
            assert!((error.size.abs() - size).abs() < 0.3 * size, "{fault:?} {seed}: {}", error.size);
            // The noise alone makes errors of about its own size.
            assert!(right < 3.0 * SIGMA && mended.receivers[0].is_some(), "{fault:?} {seed}: {right}");
        }
    }
}

#[test]
fn a_network_that_has_bent_itself_to_an_error_is_seen_through() {
    // Thirty deviations, part of which the network takes up while it gives up other measurements
    // of the receiver as outliers.
    for (seed, outliers) in [(5007, 0.0), (5002, 0.05), (5012, 0.05), (40072, 0.0), (40098, 0.0)] {
        let simulation = late(outliers, seed);
        for handling in [ReceiverDelays::None, ReceiverDelays::Auto] {
            let options = CalibrateOptions { receiver_delays: handling, seed, ..Default::default() };
            let found = calibrate(&simulation.pseudoranges, &options).unwrap();
            let [error] = &found.receiver_errors[..] else { panic!("seed {seed}: {:?}", found.receiver_errors) };
            assert_eq!((error.receiver.as_str(), error.kind), ("r1", ReceiverErrorKind::Delay), "seed {seed}");
            assert_eq!(found.unique, error.taken_out && found.alternatives.is_empty());
            // Twenty measurements determine it to a few deviations.
            assert!((error.size - 0.3).abs() < 5.0 * SIGMA || !error.taken_out, "seed {seed}: {}", error.size);
        }
    }
}

#[test]
fn clean_networks_have_no_errors() {
    // Five false alarms in a thousand networks at most.
    for seed in 0..12 {
        let (found, _) = run(None, ReceiverDelays::None, 100 + seed);
        assert!(found.receiver_errors.is_empty(), "seed {seed}: {:?}", found.receiver_errors);
    }
}
