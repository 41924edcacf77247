use super::{Solver, five_transmitters, solve};
use crate::accuracy::{cramer_rao, position_error};
use crate::align::align;
use crate::minimal::{Candidate, MinimalError, MinimalOptions, MinimalSolution, MinimalStart, MinimalWarning};
use crate::network::Network;
use crate::network::tests::random;
use crate::pseudoranges::Pseudoranges;
use hc::Monitor;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use std::array::from_fn;

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

/// The truth is the only network of these sizes. Rounding errors grow by the condition and with the
/// square of it in the linear equations, of which the refinement leaves nothing.
#[test]
fn networks_of_all_sizes_are_found() {
    let sizes = [("9r/5s", 9, 5), ("9r/5s", 10, 5), ("9r/5s", 9, 7), ("9r/5s", 12, 6)];
    let eigenvalues = [("7r/6s", 7, 6), ("7r/6s", 8, 6), ("7r/6s", 8, 9), ("6r/8s", 6, 8), ("6r/8s", 6, 11)];
    for (solver, receivers, transmitters) in sizes.into_iter().chain(eigenvalues) {
        let mut errors: Vec<f64> = (0..200)
            .map(|seed| {
                let truth: Network<3> = random(receivers, transmitters, 1_000 + seed);
                let exact = measured(&truth);
                let found = solve(&exact, &MinimalOptions::default()).unwrap();
                let said = format!("{receivers}r/{transmitters}s, seed {seed}: {found:?}");
                assert!(found.solver == solver && found.warnings.is_empty() && found.candidates.len() == 1, "{said}");
                let best = &found.candidates[0];
                assert!(best.physical && best.residual < 1e-12 && best.condition >= 1.0, "{said}");
                let error = position_error(&best.network, &truth) / truth.size();
                assert!(error < 1e3 * f64::EPSILON * best.condition, "{error:e}, {said}");
                error
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        assert!(errors[100] < 1e-12 && errors[199] < 1e-6, "{receivers}r: {:e} {:e}", errors[100], errors[199]);
    }
}

/// The truth is among the networks of the smallest sizes, and the only one of the others. The numbers of
/// solutions are those of families whose trace tests passed; none of their paths is lost.
#[test]
fn the_truth_is_found_by_paths() {
    let sizes = [(8, 5, 256, 10), (7, 5, 2321, 1), (6, 6, 3920, 1), (6, 7, 3920, 1), (10, 4, 6148, 1)];
    for (receivers, transmitters, paths, instances) in sizes.into_iter().chain([(11, 4, 6148, 1)]) {
        for seed in 0..instances {
            let truth: Network<3> = random(receivers, transmitters, seed);
            let exact = measured(&truth);
            let found = solve(&exact, &MinimalOptions::default()).unwrap();
            let said = format!("{receivers}r/{transmitters}s, seed {seed}: {found:?}");
            assert!(found.warnings.is_empty() && found.candidates.iter().all(|c| c.residual < 1e-10), "{said}");
            assert_eq!((found.paths.tracked, found.paths.finite), (paths, paths), "{said}");
            let error = |c: &Candidate<3>| position_error(&c.network, &truth) / truth.size();
            let near = |c: &&Candidate<3>| error(c) < 1e4 * f64::EPSILON * c.condition;
            assert_eq!(found.candidates.iter().filter(near).count(), 1, "{said}");
            assert!(found.candidates.iter().find(near).is_some_and(|c| c.physical), "{said}");
            let spare = receivers * transmitters > 3 * receivers + 4 * transmitters - 6;
            assert!(!spare || found.candidates.len() == 1, "{said}");
            // Real networks come in pairs.
            assert!(spare || found.counts.positive_definite.is_multiple_of(2), "{said}");
        }
    }
}

/// Special positions that leave solutions at infinity, or are told from the measurements.
#[test]
fn planes_in_small_networks_are_named() {
    let floor = |p: &mut [f64; 3]| p[2] = 0.5 * p[0] - 1.0;
    for (m, n) in [(8, 5), (10, 4), (11, 4)] {
        let mut low: Network<3> = random(m, n, 5);
        low.transmitters.iter_mut().for_each(floor);
        let mut flat: Network<3> = random(m, n, 5);
        flat.receivers.iter_mut().for_each(floor);
        for network in [low, flat] {
            assert_eq!(solve(&measured(&network), &MinimalOptions::default()), Err(MinimalError::InOnePlane));
        }
    }
    let mut low: Network<3> = random(7, 5, 5);
    low.transmitters.iter_mut().for_each(floor);
    // One level, so that the many paths to infinity are not tracked again and again.
    let mut options = MinimalOptions::default();
    options.paths.retries = 1;
    let found = solve(&measured(&low), &options).unwrap();
    let diverges =
        |w: &MinimalWarning| matches!(w, MinimalWarning::PathsDiverge { .. } | MinimalWarning::PathsLost { .. });
    assert!(found.warnings.iter().any(diverges), "{:?} {:?}", found.paths, found.warnings);
}

#[test]
fn what_cannot_be_solved_is_named() {
    let truth: Network<3> = random(9, 5, 1);
    let error = |network: &Network<3>| solve(&measured(network), &MinimalOptions::default()).unwrap_err();
    let size = |m: usize, n: usize| error(&random(m, n, 2)).to_string();
    // Five receivers have finitely many networks with nine transmitters and more, too many to be tracked.
    for n in [9, 30] {
        let said = size(5, n);
        assert!(said.starts_with(&format!("5r/{n}s is not solved exactly in space: with five receivers")), "{said}");
    }
    let polyhedral = MinimalOptions { start: MinimalStart::Polyhedral, ..MinimalOptions::default() };
    let found = solve(&measured(&random(7, 5, 1)), &polyhedral);
    assert_eq!(found, Err(MinimalError::StoredOnly { configuration: "7r/5s".into() }));
    let monitor = Monitor::watched();
    monitor.cancel();
    let found = Solver::new().solve_watched(&measured(&random(8, 5, 1)), &MinimalOptions::default(), &monitor);
    assert_eq!(found, Err(MinimalError::Cancelled));
    for (m, n) in [(9, 4), (6, 5), (5, 8), (4, 30), (30, 3)] {
        let said = size(m, n);
        assert!(said.contains("underdetermined in space") && said.contains("7 with 5, 6 with 6"), "{said}");
    }
    assert!(size(1_001, 5).starts_with("1001r/5s has more than the 5000 measurements"));
    let gap: Vec<_> = (0..45).filter(|k| *k != 7).map(|k| (k / 5, k % 5, truth.pseudoranges()[k])).collect();
    let gap = Pseudoranges::from_cells(9, 5, gap).unwrap();
    let found = solve(&gap, &MinimalOptions::default());
    assert!(
        matches!(found, Err(MinimalError::Missing { receiver, transmitter }) if receiver == "r2" && transmitter == "s3")
    );
    // One place twice.
    let mut twice = truth.clone();
    twice.receivers[4] = twice.receivers[2];
    assert!(
        matches!(error(&twice), MinimalError::IdenticalReceivers { first, second } if first == "r3" && second == "r5")
    );
    let mut twice = truth.clone();
    twice.transmitters[4] = twice.transmitters[2];
    assert!(
        matches!(error(&twice), MinimalError::IdenticalTransmitters { first, second } if first == "s3" && second == "s5")
    );
}

/// Nodes in special position, with offsets of any size.
#[test]
fn special_positions_are_told_apart() {
    let check = |network: &Network<3>, expected: &MinimalError| {
        for factor in [1.0, 1e3, 1e6] {
            let mut network = network.clone();
            network.offsets.iter_mut().for_each(|o| *o *= factor);
            let found = solve(&measured(&network), &MinimalOptions::default());
            let named = found.as_ref().is_err_and(|error| error == expected);
            // Rounded to a ten-thousandth of a micrometre, planes are nearly planes.
            let doubted = found.as_ref().is_ok_and(|found| !found.warnings.is_empty());
            let right = |f: &MinimalSolution<3>| position_error(&f.candidates[0].network, &network) < 1e-3;
            let rounded = factor == 1e6 && (doubted || found.as_ref().is_ok_and(right));
            assert!(named || rounded, "{factor}: {found:?}");
        }
    };
    let changed = |m: usize, n: usize, change: &dyn Fn(&mut Network<3>)| {
        let mut network = random(m, n, 1);
        change(&mut network);
        network
    };
    let names = |numbers: &[usize]| MinimalError::TransmittersInOnePlane {
        names: numbers.iter().map(|j| format!("s{j}")).collect(),
    };
    for (m, n) in [(9, 5), (12, 5), (10, 7)] {
        // All receivers or all transmitters in one plane, on a line, and all nodes in one plane.
        let floor = |p: &mut [f64; 3]| p[2] = 0.5 * p[0] - 1.0;
        let line = |p: &mut [f64; 3]| *p = [p[0], 2.0 * p[0], 1.0 - p[0]];
        check(&changed(m, n, &|w| w.receivers.iter_mut().for_each(floor)), &MinimalError::InOnePlane);
        check(&changed(m, n, &|w| w.transmitters.iter_mut().for_each(floor)), &MinimalError::InOnePlane);
        check(&changed(m, n, &|w| w.receivers.iter_mut().for_each(line)), &MinimalError::InOnePlane);
        check(&changed(m, n, &|w| w.transmitters.iter_mut().for_each(line)), &MinimalError::InOnePlane);
        let flat = changed(m, n, &|w| w.receivers.iter_mut().chain(&mut w.transmitters).for_each(|p| p[2] = 1.0));
        check(&flat, &MinimalError::InOnePlane);
    }
    // Four of five transmitters in one plane, three in one line.
    check(&changed(9, 5, &|w| w.transmitters[1..].iter_mut().for_each(|s| s[2] = 1.0)), &names(&[2, 3, 4, 5]));
    let middle = |a: [f64; 3], b: [f64; 3]| from_fn(|k| 0.5 * (a[k] + b[k]));
    check(&changed(11, 5, &|w| w.transmitters[3] = middle(w.transmitters[0], w.transmitters[2])), &names(&[1, 3, 4]));
    // Eight corners of a box lie on three pairs of planes, two combinations of which a ninth point is on.
    let corner = |k: u8| [f64::from(k & 1) * 4.0, f64::from(k >> 1 & 1) * 5.0, f64::from(k >> 2) * 2.5];
    let corners = changed(9, 5, &|w| (0..8).for_each(|k| w.receivers[usize::from(k)] = corner(k)));
    assert_eq!(solve(&measured(&corners), &MinimalOptions::default()), Err(MinimalError::SpecialPosition));
}

/// A sixth transmitter is enough where four of the others lie in one plane: other five are solved.
#[test]
fn transmitters_in_one_plane_are_gone_around() {
    for seed in 0..50 {
        let mut truth: Network<3> = random(9, 6, seed);
        truth.transmitters[..4].iter_mut().for_each(|s| s[2] = 1.0);
        let found = solve(&measured(&truth), &MinimalOptions::default());
        // Of any five of the six, three at least are of the four; only five without one of them will do.
        let error = found.as_ref().map_or(1.0, |found| position_error(&found.candidates[0].network, &truth));
        assert!(error < 1e-6, "seed {seed}: {found:?}");
    }
}

#[test]
fn wrong_measurements_leave_residuals() {
    for seed in 0..100 {
        let mut values = random::<3>(9, 5, seed).pseudoranges();
        // Neither a distance nor an offset: one clap heard late by one receiver.
        values[12] += 2.0;
        let wrong = Pseudoranges::new(9, 5, values).unwrap();
        if let Ok(found) = solve(&wrong, &MinimalOptions::default()) {
            assert!(found.candidates[0].residual > 1e-3, "seed {seed}");
            assert!(matches!(found.warnings[0], MinimalWarning::NotExplained { .. }), "seed {seed}");
        }
    }
}

proptest! {
    #[test]
    fn no_table_makes_it_panic(values in prop::collection::vec(prop_oneof![
        -1e3..1e3f64, Just(0.0), Just(1.0), Just(1e200), Just(-1e200), Just(1e-200), Just(f64::MAX)
    ], 54)) {
        for (m, n) in [(9, 5), (9, 6)] {
            let measured = Pseudoranges::new(m, n, values[..m * n].to_vec());
            let found = measured.ok().and_then(|measured| solve(&measured, &MinimalOptions::default()).ok());
            prop_assert!(found.is_none_or(|found| found.candidates.iter().all(|c| c.network.is_finite())));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn no_small_table_makes_it_panic(values in prop::collection::vec(prop_oneof![
        -1e3..1e3f64, Just(0.0), Just(1.0), Just(1e12), Just(-1e12), Just(1e-200)
    ], 48)) {
        for (m, n) in [(7, 6), (6, 8)] {
            let measured = Pseudoranges::new(m, n, values[..m * n].to_vec());
            let found = measured.ok().and_then(|measured| solve(&measured, &MinimalOptions::default()).ok());
            prop_assert!(found.is_none_or(|found| found.candidates.iter().all(|c| c.network.is_finite())));
        }
    }
}

/// Nodes in one plane or line in sizes that eigenvalues solve, one wrong measurement: nothing of this is
/// taken for a network that is known.
#[test]
fn small_networks_in_special_position_are_doubted() {
    let floor = |p: &mut [f64; 3]| p[2] = 0.5 * p[0] - 1.0;
    let line = |p: &mut [f64; 3]| *p = [p[0], 2.0 * p[0], 1.0 - p[0]];
    for (m, n) in [(7, 6), (6, 8), (8, 7)] {
        for seed in 0..5 {
            let exact: Network<3> = random(m, n, seed);
            let [mut flat, mut low, mut thin, mut slender] = [(); 4].map(|()| exact.clone());
            flat.receivers.iter_mut().for_each(floor);
            low.transmitters.iter_mut().for_each(floor);
            thin.receivers.iter_mut().for_each(line);
            slender.transmitters.iter_mut().for_each(line);
            let mut cases = [flat, low, thin, slender].map(|network| network.pseudoranges()).to_vec();
            cases.push(exact.pseudoranges());
            cases[4][11] += 1.0;
            for (case, values) in cases.into_iter().enumerate() {
                let measured = Pseudoranges::new(m, n, values).unwrap();
                let found = solve(&measured, &MinimalOptions::default());
                let trusted = |f: &MinimalSolution<3>| f.warnings.is_empty() && f.candidates[0].physical;
                assert!(!found.as_ref().is_ok_and(trusted), "{m}r/{n}s, seed {seed}, case {case}: {found:?}");
            }
        }
    }
}
