use crate::accuracy::position_error;
use crate::clocks::Emissions;
use crate::minimal::{
    Candidate, MinimalError, MinimalOptions, MinimalSolution, MinimalStart, MinimalWarning, Solver, adjust, solve,
    spatial,
};
use crate::network::Network;
use crate::network::tests::random;
use crate::pseudoranges::Pseudoranges;
use proptest::prelude::*;

fn options() -> MinimalOptions {
    options_of(Emissions::Known)
}

/// The settings for ranges, with a constant or without.
pub(super) fn options_of(emissions: Emissions) -> MinimalOptions {
    MinimalOptions { emissions, ..MinimalOptions::default() }
}

/// A random network of ranges.
fn network<const D: usize>(m: usize, n: usize, seed: u64) -> Network<D> {
    network_of(Emissions::Known, m, n, seed)
}

/// A random network of ranges, with a constant or without.
pub(super) fn network_of<const D: usize>(emissions: Emissions, m: usize, n: usize, seed: u64) -> Network<D> {
    let mut network = random(m, n, seed);
    let constant = if emissions == Emissions::Constant { network.offsets[0] } else { 0.0 };
    network.offsets.fill(constant);
    network
}

pub(super) fn measured<const D: usize>(network: &Network<D>) -> Pseudoranges {
    Pseudoranges::new(network.receivers.len(), network.transmitters.len(), network.pseudoranges()).unwrap()
}

/// A solver in the plane or in space.
pub(super) trait Solves<const D: usize> {
    fn solved(&mut self, measured: &Pseudoranges, options: &MinimalOptions)
    -> Result<MinimalSolution<D>, MinimalError>;
}

impl Solves<2> for Solver {
    fn solved(&mut self, measured: &Pseudoranges, options: &MinimalOptions) -> Result<MinimalSolution, MinimalError> {
        self.solve(measured, options)
    }
}

impl Solves<3> for spatial::Solver {
    fn solved(
        &mut self,
        measured: &Pseudoranges,
        options: &MinimalOptions,
    ) -> Result<MinimalSolution<3>, MinimalError> {
        self.solve(measured, options)
    }
}

/// How far the nearest candidate is from the truth.
pub(super) fn nearest<const D: usize>(found: &MinimalSolution<D>, truth: &Network<D>) -> f64 {
    found.candidates.iter().map(|c| position_error(&c.network, truth)).fold(f64::INFINITY, f64::min)
}

/// Random networks of a minimal size: all paths end in roots, whose number is known, all candidates explain the ranges,
/// and the truth is one of them.
pub(super) fn all_are_found<const D: usize>(
    emissions: Emissions,
    mut solver: impl Solves<D>,
    (m, n): (usize, usize),
    paths: usize,
    seeds: u64,
) {
    let (mut missed, mut incomplete) = (Vec::new(), Vec::new());
    for seed in 0..seeds {
        let truth: Network<D> = network_of(emissions, m, n, seed);
        let found = solver.solved(&measured(&truth), &options_of(emissions)).unwrap();
        assert_eq!((found.paths.tracked, &*found.configuration), (paths, &*format!("{m}r/{n}s")));
        assert_eq!((found.solver, found.emissions), (&*found.configuration, emissions));
        // Roots are real or in pairs.
        assert_eq!((found.counts.complex - found.counts.real) % 2, 0, "seed {seed}: {:?}", found.counts);
        // Of several networks with different constants one may be flat.
        let is_flat = |warning: &MinimalWarning| {
            matches!(warning, MinimalWarning::NearlyInOneLine { .. } | MinimalWarning::NearlyInOnePlane { .. })
        };
        let is_known = emissions == Emissions::Known;
        if found.counts.complex != paths || found.warnings.iter().any(|warning| is_known || !is_flat(warning)) {
            incomplete.push((seed, found.paths, found.warnings.clone()));
        }
        for candidate in &found.candidates {
            let offsets = &candidate.network.offsets;
            assert!(offsets.iter().all(|offset| *offset == offsets[0]), "seed {seed}: {offsets:?}");
            if is_known {
                assert!(candidate.physical && offsets[0] == 0.0, "seed {seed}: {candidate:?}");
            }
            // Of candidates that are not physical some distances are minus what was measured.
            assert!(candidate.residual < 1e-9 || !candidate.physical, "seed {seed}: {candidate:?}");
            // Networks with other constants may be much larger than the true one.
            let near = if is_known { 1e-9 } else { 1e-9 * (1.0 + candidate.network.size()) };
            assert!(candidate.network.receivers[0].iter().all(|x| x.abs() < near), "seed {seed}: {candidate:?}");
        }
        let error = nearest(&found, &truth);
        if error > 1e-6 {
            missed.push((seed, error));
        }
    }
    assert!(missed.is_empty() && incomplete.is_empty(), "{m}r/{n}s: missed {missed:?}, incomplete {incomplete:?}");
}

/// 8 is half the number of realisations of K_3,3, 38 and 42 are those of Kuang, Burgess, Torstensson & Astrom.
#[test]
fn networks_of_the_smallest_sizes() {
    all_are_found::<2>(Emissions::Known, Solver::new(), (3, 3), 8, 400);
    all_are_found::<3>(Emissions::Known, spatial::Solver::new(), (4, 6), 38, 200);
    all_are_found::<3>(Emissions::Known, spatial::Solver::new(), (6, 4), 38, 200);
    all_are_found::<3>(Emissions::Known, spatial::Solver::new(), (5, 5), 42, 200);
}

/// Larger networks are the only ones, for m + n > 6 in the plane and m + n > 10 in space: Connelly, "On generic global
/// rigidity" (1991), for m, n > D.
pub(super) fn larger_are_the_only_ones<const D: usize>(
    emissions: Emissions,
    mut solver: impl Solves<D>,
    sizes: &[(usize, usize, &str)],
) {
    for &(m, n, through) in sizes {
        for seed in 0..40 {
            let truth: Network<D> = network_of(emissions, m, n, seed);
            let found = solver.solved(&measured(&truth), &options_of(emissions)).unwrap();
            assert_eq!((&*found.configuration, found.solver), (&*format!("{m}r/{n}s"), through));
            assert!(found.candidates.len() == 1 && found.warnings.is_empty(), "{m}r/{n}s, seed {seed}: {found:?}");
            assert!(found.candidates[0].residual < 1e-9 && nearest(&found, &truth) < 1e-6, "{m}r/{n}s, seed {seed}");
        }
    }
}

#[test]
fn larger_networks() {
    larger_are_the_only_ones::<2>(
        Emissions::Known,
        Solver::new(),
        &[(3, 4, "3r/3s"), (5, 3, "3r/3s"), (8, 7, "3r/3s")],
    );
    let sizes = [(6, 5, "5r/5s"), (4, 7, "4r/6s"), (8, 4, "6r/4s"), (7, 9, "5r/5s")];
    larger_are_the_only_ones::<3>(Emissions::Known, spatial::Solver::new(), &sizes);
}

/// Receivers as transmitters have the same networks.
pub(super) fn exchanged_networks<const D: usize>(emissions: Emissions, mut solver: impl Solves<D>, m: usize, n: usize) {
    for seed in 0..30 {
        let truth: Network<D> = network_of(emissions, m, n, seed);
        let turned = Network::new(truth.transmitters.clone(), truth.receivers.clone(), vec![truth.offsets[0]; m]);
        let [found, others] =
            [&truth, &turned].map(|network| solver.solved(&measured(network), &options_of(emissions)).unwrap());
        assert_eq!(found.counts, others.counts, "seed {seed}");
        for Candidate { network, .. } in others.candidates {
            let back = Network::new(network.transmitters, network.receivers, vec![network.offsets[0]; n]);
            let error = nearest(&found, &back);
            assert!(error < 1e-6, "{m}r/{n}s, seed {seed}: {error}");
        }
    }
}

#[test]
fn receivers_and_transmitters_are_exchanged() {
    exchanged_networks::<2>(Emissions::Known, Solver::new(), 3, 3);
    exchanged_networks::<3>(Emissions::Known, spatial::Solver::new(), 4, 6);
    exchanged_networks::<3>(Emissions::Known, spatial::Solver::new(), 5, 5);
}

/// Noise far below the tolerance is none, and noise above it is told where a measurement is to spare.
#[test]
fn noise_is_told() {
    let truth: Network<3> = network(5, 5, 3);
    let noisy = |size: f64| {
        let values = truth.pseudoranges().into_iter().enumerate().map(|(k, f)| f + size * (7.0 * k as f64).sin());
        Pseudoranges::new(5, 5, values.collect()).unwrap()
    };
    let solved =
        |size: f64, tolerance: f64| spatial::solve(&noisy(size), &MinimalOptions { tolerance, ..options() }).unwrap();
    assert!(solved(1e-9, 1e-6).warnings.is_empty());
    assert!(matches!(solved(1e-3, 1e-6).warnings[..], [MinimalWarning::NotExplained { .. }]));
    let found = solved(1e-3, 1e-2);
    assert!(found.warnings.is_empty() && nearest(&found, &truth) < 0.1, "{found:?}");
}

#[test]
fn a_known_network_is_adjusted() {
    let truth: Network<3> = network(4, 6, 8);
    let mut start = truth.clone();
    start.receivers[1][0] += 1e-3;
    let found = adjust(&measured(&truth), &start, &options()).unwrap();
    assert!(found.residual < 1e-10 && found.network.offsets == vec![0.0; 6], "{found:?}");
    assert!(position_error(&found.network, &truth) < 1e-8);
}

/// A network with some nodes moved.
fn moved<const D: usize>(m: usize, n: usize, change: impl Fn(&mut Network<D>)) -> Pseudoranges {
    let mut network: Network<D> = network(m, n, 1);
    change(&mut network);
    measured(&network)
}

#[test]
fn nodes_in_special_position_are_refused() {
    let line = |p: &mut [f64; 2]| p[1] = 0.5 * p[0] - 1.0;
    let floor = |p: &mut [f64; 3]| p[2] = 0.5 * p[0] - p[1] + 1.0;
    for (m, n) in [(3, 3), (4, 5)] {
        let refused = |measured: &Pseudoranges| solve(measured, &options()).unwrap_err();
        assert_eq!(refused(&moved::<2>(m, n, |w| w.receivers.iter_mut().for_each(line))), MinimalError::InOneLine);
        assert_eq!(refused(&moved::<2>(m, n, |w| w.transmitters.iter_mut().for_each(line))), MinimalError::InOneLine);
        let twice = moved::<2>(m, n, |w| w.receivers[2] = w.receivers[0]);
        assert!(matches!(refused(&twice), MinimalError::IdenticalReceivers { .. }));
        let twice = moved::<2>(m, n, |w| w.transmitters[2] = w.transmitters[1]);
        assert!(matches!(refused(&twice), MinimalError::IdenticalTransmitters { .. }));
    }
    for (m, n) in [(4, 6), (6, 4), (5, 5), (6, 7)] {
        let refused = |measured: &Pseudoranges| spatial::solve(measured, &options()).unwrap_err();
        assert_eq!(refused(&moved::<3>(m, n, |w| w.receivers.iter_mut().for_each(floor))), MinimalError::InOnePlane);
        assert_eq!(refused(&moved::<3>(m, n, |w| w.transmitters.iter_mut().for_each(floor))), MinimalError::InOnePlane);
        let twice = moved::<3>(m, n, |w| w.receivers[2] = w.receivers[0]);
        assert!(matches!(refused(&twice), MinimalError::IdenticalReceivers { .. }));
    }
}

/// Where all receivers or transmitters but one lie in one plane, 5r/5s is not determined; with more nodes other parts
/// are solved.
#[test]
fn all_nodes_but_one_in_one_plane() {
    let receivers = |w: &mut Network<3>| (0..4).for_each(|i| w.receivers[i][2] = 1.0);
    let transmitters = |w: &mut Network<3>| (1..5).for_each(|j| w.transmitters[j][2] = 1.0);
    for measured in [moved(5, 5, receivers), moved(5, 5, transmitters)] {
        assert_eq!(spatial::solve(&measured, &options()), Err(MinimalError::SpecialPosition));
    }
    for seed in 0..20 {
        let mut truth: Network<3> = network(6, 6, seed);
        receivers(&mut truth);
        transmitters(&mut truth);
        let found = spatial::solve(&measured(&truth), &options()).unwrap();
        assert!(nearest(&found, &truth) < 1e-6, "seed {seed}: {found:?}");
    }
}

#[test]
fn what_is_no_network_of_ranges_is_refused() {
    let truth: Network<3> = network(4, 5, 1);
    let error = spatial::solve(&measured(&truth), &options()).unwrap_err();
    let size = MinimalError::Underdetermined {
        dimensions: 3,
        emissions: Emissions::Known,
        configuration: "4r/5s".into(),
        constraints: 20,
        unknowns: 21,
    };
    assert_eq!(error, size);
    assert!(error.to_string().contains("are 6 receivers with 4 transmitters, 5 with 5, and 4 with 6"), "{error}");
    let error = solve(&measured(&network::<2>(2, 9, 1)), &options()).unwrap_err();
    assert!(error.to_string().contains("18 ranges for 19 unknowns"), "{error}");
    assert!(error.to_string().contains("are 3 receivers with 3 transmitters"), "{error}");
    let truth: Network = network(3, 3, 1);
    let mut values = truth.pseudoranges();
    values[4] = -values[4];
    let negative = solve(&Pseudoranges::new(3, 3, values.clone()).unwrap(), &options());
    assert!(matches!(negative, Err(MinimalError::NegativeRange { .. })), "{negative:?}");
    values[4] = f64::NAN;
    let missing = solve(&Pseudoranges::new(3, 3, values).unwrap(), &options());
    assert!(matches!(missing, Err(MinimalError::Missing { .. })), "{missing:?}");
    let polyhedral = MinimalOptions { start: MinimalStart::Polyhedral, ..options() };
    assert!(matches!(solve(&measured(&truth), &polyhedral), Err(MinimalError::StoredOnly { .. })));
    // The triangle inequality does not hold.
    let mut values = truth.pseudoranges();
    values[0] += 100.0;
    let found = solve(&Pseudoranges::new(3, 3, values).unwrap(), &options()).unwrap();
    assert!(found.candidates.is_empty() && found.counts.complex == 8, "{found:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn no_table_makes_it_panic(values in prop::collection::vec(prop_oneof![
        0.0..1e3f64, Just(0.0), Just(1.0), Just(1e12), Just(1e200), Just(1e-200)
    ], 30)) {
        for (m, n) in [(3, 3), (3, 4), (4, 6), (6, 4), (5, 5), (5, 6)] {
            let Ok(measured) = Pseudoranges::new(m, n, values[..m * n].to_vec()) else { continue };
            let found = solve(&measured, &options());
            prop_assert!(found.ok().is_none_or(|found| found.candidates.iter().all(|c| c.network.is_finite())));
            let found = spatial::solve(&measured, &options());
            prop_assert!(found.ok().is_none_or(|found| found.candidates.iter().all(|c| c.network.is_finite())));
        }
    }
}
