use super::tests::{
    all_are_found, exchanged_networks, larger_are_the_only_ones, measured, nearest, network_of, options_of,
};
use crate::accuracy::position_error;
use crate::clocks::Emissions::Constant;
use crate::minimal::{MinimalError, MinimalOptions, MinimalStart, MinimalWarning, Solver, adjust, solve, spatial};
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use proptest::prelude::*;

/// Five receivers and transmitters: every real constant has 42 solutions, all candidates explain the ranges, and the truth is
/// one of them.
#[test]
fn five_receivers_and_transmitters_in_space() {
    let mut solver = spatial::Solver::new();
    let mut constants = [0; 5];
    for seed in 0..60 {
        let truth: Network<3> = network_of(Constant, 5, 5, seed);
        let found = solver.solve(&measured(&truth), &options_of(Constant)).unwrap();
        assert_eq!((found.solver, &*found.configuration, found.emissions), ("5r/5s", "5r/5s", Constant));
        // Constants are real or in pairs.
        constants[found.paths.tracked / 42] += 1;
        assert_eq!(
            (found.paths.tracked % 84, found.counts.complex),
            (0, found.paths.tracked),
            "seed {seed}: {found:?}"
        );
        assert!(found.warnings.is_empty(), "seed {seed}: {found:?}");
        for candidate in &found.candidates {
            assert!(candidate.residual < 1e-9 || !candidate.physical, "seed {seed}: {candidate:?}");
        }
        let best = nearest(&found, &truth);
        assert!(best < 1e-6, "seed {seed}: {best}");
    }
    assert!(constants[2] > 0 && constants[4] > 0, "{constants:?}");
}

/// 43 and 388 are the numbers of standard monomials of Groebner bases of other equations: see the families.
#[test]
fn networks_of_the_smallest_sizes() {
    all_are_found::<2>(Constant, Solver::new(), (3, 4), 43, 200);
    all_are_found::<2>(Constant, Solver::new(), (4, 3), 43, 200);
    all_are_found::<3>(Constant, spatial::Solver::new(), (4, 7), 388, 12);
    all_are_found::<3>(Constant, spatial::Solver::new(), (7, 4), 388, 12);
}

#[test]
fn larger_networks() {
    let sizes = [(4, 4, "3r/4s"), (3, 5, "3r/4s"), (5, 3, "4r/3s"), (8, 7, "3r/4s")];
    larger_are_the_only_ones::<2>(Constant, Solver::new(), &sizes);
    let sizes = [(5, 6, "5r/5s"), (6, 5, "5r/5s"), (7, 8, "5r/5s")];
    larger_are_the_only_ones::<3>(Constant, spatial::Solver::new(), &sizes);
}

#[test]
fn receivers_and_transmitters_are_exchanged() {
    exchanged_networks::<2>(Constant, Solver::new(), 3, 4);
    exchanged_networks::<3>(Constant, spatial::Solver::new(), 5, 5);
}

/// Another constant, of an hour at the speed of sound, is an offset of all networks, and costs no more digits than it has.
#[test]
fn constants_of_any_size() {
    let hour = 1e6;
    for seed in 0..30 {
        let truth: Network = network_of(Constant, 3, 4, seed);
        let mut later = truth.clone();
        later.offsets.iter_mut().for_each(|offset| *offset += hour);
        let [found, shifted] =
            [&truth, &later].map(|network| solve(&measured(network), &options_of(Constant)).unwrap());
        assert_eq!(found.counts, shifted.counts, "seed {seed}");
        let best = shifted
            .candidates
            .iter()
            .min_by(|a, b| position_error(&a.network, &later).total_cmp(&position_error(&b.network, &later)));
        let best = best.unwrap();
        // Measurements are rounded to 1e-10.
        assert!(position_error(&best.network, &later) < 1e-9 * best.condition.max(1.0), "seed {seed}: {best:?}");
        assert!((best.network.offsets[0] - later.offsets[0]).abs() < 1e-9 * best.condition.max(1.0), "seed {seed}");
    }
}

#[test]
fn a_known_network_is_adjusted() {
    let truth: Network = network_of(Constant, 4, 5, 8);
    let mut start = truth.clone();
    start.receivers[1][0] += 1e-3;
    start.offsets.iter_mut().for_each(|offset| *offset -= 1e-3);
    let found = adjust(&measured(&truth), &start, &options_of(Constant)).unwrap();
    assert!(found.residual < 1e-10 && position_error(&found.network, &truth) < 1e-8, "{found:?}");
    assert!(found.network.offsets.iter().all(|offset| (offset - truth.offsets[0]).abs() < 1e-8), "{found:?}");
}

/// A network with some nodes moved.
fn moved<const D: usize>(m: usize, n: usize, change: impl Fn(&mut Network<D>)) -> Pseudoranges {
    let mut network: Network<D> = network_of(Constant, m, n, 1);
    change(&mut network);
    measured(&network)
}

#[test]
fn nodes_in_special_position_are_refused() {
    let line = |p: &mut [f64; 2]| p[1] = 0.5 * p[0] - 1.0;
    for (m, n) in [(3, 4), (4, 3), (4, 5)] {
        let refused = |measured: &Pseudoranges| solve(measured, &options_of(Constant)).unwrap_err();
        assert_eq!(refused(&moved::<2>(m, n, |w| w.receivers.iter_mut().for_each(line))), MinimalError::InOneLine);
        assert_eq!(refused(&moved::<2>(m, n, |w| w.transmitters.iter_mut().for_each(line))), MinimalError::InOneLine);
        let twice = moved::<2>(m, n, |w| w.receivers[2] = w.receivers[0]);
        assert!(matches!(refused(&twice), MinimalError::IdenticalReceivers { .. }));
        let twice = moved::<2>(m, n, |w| w.transmitters[2] = w.transmitters[1]);
        assert!(matches!(refused(&twice), MinimalError::IdenticalTransmitters { .. }));
    }
}

/// As without a constant: see the other tests.
#[test]
fn nodes_in_space_in_special_position() {
    let floor = |p: &mut [f64; 3]| p[2] = 0.5 * p[0] - p[1] + 1.0;
    let refused = |measured: &Pseudoranges| spatial::solve(measured, &options_of(Constant)).unwrap_err();
    for (m, n) in [(5, 5), (6, 7), (4, 7), (7, 4)] {
        assert_eq!(refused(&moved::<3>(m, n, |w| w.receivers.iter_mut().for_each(floor))), MinimalError::InOnePlane);
        assert_eq!(refused(&moved::<3>(m, n, |w| w.transmitters.iter_mut().for_each(floor))), MinimalError::InOnePlane);
        let twice = moved::<3>(m, n, |w| w.receivers[2] = w.receivers[0]);
        assert!(matches!(refused(&twice), MinimalError::IdenticalReceivers { .. }));
    }
    let receivers = |w: &mut Network<3>| (0..4).for_each(|i| w.receivers[i][2] = 1.0);
    let transmitters = |w: &mut Network<3>| (1..5).for_each(|j| w.transmitters[j][2] = 1.0);
    for measured in [moved(5, 5, receivers), moved(5, 5, transmitters)] {
        assert_eq!(refused(&measured), MinimalError::SpecialPosition);
    }
}

/// Noise makes real constants complex where they are nearly one; their real part is tried where that is allowed.
#[test]
fn noise_is_told() {
    let truth: Network<3> = network_of(Constant, 6, 6, 3);
    let noisy = |size: f64| {
        let values = truth.pseudoranges().into_iter().enumerate().map(|(k, f)| f + size * (7.0 * k as f64).sin());
        Pseudoranges::new(6, 6, values.collect()).unwrap()
    };
    let solved = |size: f64, tolerance: f64| {
        spatial::solve(&noisy(size), &MinimalOptions { tolerance, ..options_of(Constant) }).unwrap()
    };
    assert!(solved(1e-9, 1e-6).warnings.is_empty());
    assert!(matches!(solved(1e-4, 1e-6).warnings[..], [MinimalWarning::NotExplained { .. }]));
    let found = solved(1e-4, 1e-2);
    assert!(found.warnings.is_empty() && nearest(&found, &truth) < 0.1, "{found:?}");
}

#[test]
fn what_is_no_network_of_ranges_is_refused() {
    let refused = |measured: &Pseudoranges| solve(measured, &options_of(Constant)).unwrap_err();
    let truth: Network = network_of(Constant, 3, 3, 1);
    let error = refused(&measured(&truth)).to_string();
    assert!(error.contains("9 ranges for 10 unknowns (positions up to a rigid motion, a constant)"), "{error}");
    assert!(error.contains("are 4 receivers with 3 transmitters, and 3 with 4"), "{error}");
    let truth: Network = network_of(Constant, 3, 4, 1);
    let mut values = truth.pseudoranges();
    values[4] = f64::NAN;
    assert!(matches!(refused(&Pseudoranges::new(3, 4, values).unwrap()), MinimalError::Missing { .. }));
    let polyhedral = MinimalOptions { start: MinimalStart::Polyhedral, ..options_of(Constant) };
    assert!(matches!(solve(&measured(&truth), &polyhedral), Err(MinimalError::StoredOnly { .. })));
    let mut fits = options_of(Constant);
    fits.first_under = Some(1e-6);
    let found = solve(&measured(&truth), &fits).unwrap();
    assert!(found.stopped_early && found.candidates[0].physical && found.candidates[0].residual < 1e-6, "{found:?}");
    // Negative values are no error.
    assert!(nearest(&solve(&measured(&truth), &options_of(Constant)).unwrap(), &truth) < 1e-6);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]
    #[test]
    fn no_table_makes_it_panic(values in prop::collection::vec(prop_oneof![
        -1e3..1e3f64, Just(0.0), Just(1.0), Just(2.0), Just(1e12), Just(-1e200), Just(1e-200)
    ], 25)) {
        for (m, n) in [(3, 4), (4, 3), (3, 5), (5, 5)] {
            let Ok(measured) = Pseudoranges::new(m, n, values[..m * n].to_vec()) else { continue };
            let found = solve(&measured, &options_of(Constant));
            prop_assert!(found.ok().is_none_or(|found| found.candidates.iter().all(|c| c.network.is_finite())));
            let found = spatial::solve(&measured, &options_of(Constant));
            prop_assert!(found.ok().is_none_or(|found| found.candidates.iter().all(|c| c.network.is_finite())));
        }
    }
}
