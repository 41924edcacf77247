use super::five_transmitters;
use crate::accuracy::{cramer_rao, position_error};
use crate::align::align;
use crate::minimal::MinimalError;
use crate::network::Network;
use crate::network::tests::random;
use crate::pseudoranges::Pseudoranges;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

fn measured(network: &Network<3>) -> Pseudoranges {
    Pseudoranges::new(network.receivers.len(), network.transmitters.len(), network.pseudoranges()).unwrap()
}

/// The truth is the only network: a generic one has no other of these sizes.
#[test]
fn the_truth_is_found_of_every_random_network() {
    for receivers in [9, 10, 11, 20] {
        let mut errors: Vec<f64> = (0..250)
            .map(|seed| {
                let truth: Network<3> = random(receivers, 5, seed);
                let exact = measured(&truth);
                let found = five_transmitters(&exact).unwrap();
                assert!(found.rms(&exact) < 1e-8 && found.is_physical(&exact, 1e-6), "{receivers}r, seed {seed}");
                assert_eq!(found.receivers.len(), receivers);
                position_error(&found, &truth)
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        assert!(errors[125] < 1e-11 && errors[249] < 1e-5, "{receivers}r: {} {}", errors[125], errors[249]);
    }
}

/// Noise moves the receivers as far as it must, by the Cramer-Rao bound, and not by the hundred times
/// as much of the linear equations. The square of the error has the square of the bound for its mean,
/// and at most twice its square for its variance, as if all errors were along one direction: the mean
/// of 200 is within five deviations.
#[test]
fn noise_is_adjusted() {
    let ratios: Vec<f64> = (0..200)
        .map(|seed| {
            let truth: Network<3> = random(12, 5, seed);
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let noise = 1e-7;
            let mut normal = || -> f64 { rng.sample(StandardNormal) };
            let values = truth.pseudoranges().iter().map(|f| f + noise * normal()).collect();
            let noisy = Pseudoranges::new(12, 5, values).unwrap();
            let found = five_transmitters(&noisy).unwrap();
            let error = align(&found.receivers, &truth.receivers, false).unwrap().rms;
            (error / cramer_rao(&noisy, &[false; 60], &truth, noise)).powi(2)
        })
        .collect();
    let mean = ratios.iter().sum::<f64>() / 200.0;
    assert!((mean - 1.0).abs() < 5.0 * (2.0f64 / 200.0).sqrt(), "{mean}");
}

#[test]
fn what_cannot_be_solved_is_named() {
    let truth: Network<3> = random(9, 5, 1);
    let size = |m: usize, n: usize| five_transmitters(&measured(&random(m, n, 2))).unwrap_err().to_string();
    assert!(size(8, 5).starts_with("8r/5s: five transmitters and nine receivers"));
    assert!(size(9, 6).starts_with("9r/6s"));
    let gap: Vec<_> = (0..45).filter(|k| *k != 7).map(|k| (k / 5, k % 5, truth.pseudoranges()[k])).collect();
    let gap = Pseudoranges::from_cells(9, 5, gap).unwrap();
    assert!(matches!(five_transmitters(&gap), Err(MinimalError::Missing { .. })));
    // One place twice.
    let mut twice = truth.clone();
    twice.receivers[4] = twice.receivers[2];
    assert!(matches!(five_transmitters(&measured(&twice)), Err(MinimalError::IdenticalReceivers { .. })));
    let mut twice = truth.clone();
    twice.transmitters[4] = twice.transmitters[2];
    assert!(matches!(five_transmitters(&measured(&twice)), Err(MinimalError::IdenticalTransmitters { .. })));
    // All receivers on the floor, all transmitters at one height, four of them, all receivers on a line.
    let is_special = |change: &dyn Fn(&mut Network<3>)| {
        let mut network = truth.clone();
        change(&mut network);
        matches!(five_transmitters(&measured(&network)), Err(MinimalError::SpecialPosition))
    };
    assert!(is_special(&|network| network.receivers.iter_mut().for_each(|r| r[2] = 0.0)));
    assert!(is_special(&|network| network.transmitters.iter_mut().for_each(|s| s[2] = 1.0)));
    assert!(is_special(&|network| network.transmitters[1..].iter_mut().for_each(|s| s[2] = 1.0)));
    assert!(is_special(&|network| network.receivers.iter_mut().for_each(|r| *r = [r[0], 2.0 * r[0], -r[0]])));
    // Eight corners of a box lie on three pairs of planes, two combinations of which a ninth point is on.
    let corner = |k: u8| [f64::from(k & 1) * 4.0, f64::from(k >> 1 & 1) * 5.0, f64::from(k >> 2) * 2.5];
    assert!(is_special(&|network| (0..8).for_each(|k| network.receivers[usize::from(k)] = corner(k))));
}

#[test]
fn wrong_measurements_leave_residuals() {
    for seed in 0..100 {
        let mut values = random::<3>(9, 5, seed).pseudoranges();
        // Neither a distance nor an offset: one clap heard late by one receiver.
        values[12] += 2.0;
        let wrong = Pseudoranges::new(9, 5, values).unwrap();
        if let Ok(found) = five_transmitters(&wrong) {
            assert!(found.rms(&wrong) > 1e-3, "seed {seed}");
        }
    }
}

proptest! {
    #[test]
    fn no_table_makes_it_panic(values in prop::collection::vec(prop_oneof![
        -1e3..1e3f64, Just(0.0), Just(1.0), Just(1e200), Just(-1e200), Just(1e-200), Just(f64::MAX)
    ], 45)) {
        let found = Pseudoranges::new(9, 5, values).ok().and_then(|measured| five_transmitters(&measured).ok());
        prop_assert!(found.is_none_or(|found| found.is_finite()));
    }
}
