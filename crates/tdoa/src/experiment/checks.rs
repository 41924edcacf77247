//! Checks of the minimal solvers on clean data by other means: interval proofs of the roots, the polyhedral route beside the stored
//! start, what the options for callers in a hurry save and lose, and what becomes of paths that fail.

use super::clean::position_error_of;
use crate::minimal::{Fallback, RootProofs, SolveError, SolveOptions, Solver, Start};
use crate::network::{MinimalSolution, PathCounts, RootCounts};
use crate::simulate::Simulation;
use serde::Serialize;
use std::time::Instant;

/// A candidate this near the truth (relative to the network's size) is the truth.
const FOUND: f64 = 1e-4;

/// Solves one clean instance and proves its roots; with the number of roots that the solver counts as real.
///
/// # Errors
/// If the solver refuses the instance.
pub fn proof_trial(solver: &mut Solver, simulation: &Simulation) -> Result<(RootProofs, usize), SolveError> {
    let solution = solver.solve(&simulation.pseudoranges, &SolveOptions::default())?;
    Ok((solver.prove().unwrap_or_default(), solution.counts.real))
}

/// One instance by both routes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RouteTrial {
    /// Numbers of roots from the stored start.
    pub stored: RootCounts,
    /// Numbers of roots from a polyhedral start system.
    pub polyhedral: RootCounts,
    /// Paths of the polyhedral route.
    pub paths: PathCounts,
    /// Whether both give the same real networks, no more and no fewer.
    pub agree: bool,
}

/// Solves one clean instance from the stored start and from a polyhedral one.
///
/// # Errors
/// If the solver refuses the instance.
pub fn route_trial(solver: &mut Solver, simulation: &Simulation) -> Result<RouteTrial, SolveError> {
    let mut options = SolveOptions::default();
    let stored = solver.solve(&simulation.pseudoranges, &options)?;
    options.start = Start::Polyhedral;
    let polyhedral = solver.solve(&simulation.pseudoranges, &options)?;
    let agree = same_networks(&stored, &polyhedral);
    Ok(RouteTrial { stored: stored.counts, polyhedral: polyhedral.counts, paths: polyhedral.paths, agree })
}

/// One instance with one way to treat paths that fail.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ChartTrial {
    /// How the paths ended.
    pub paths: PathCounts,
    /// Evaluations of the Jacobian in the first starts of all paths and what follows these.
    pub jacobians: usize,
    /// Whether the real roots, of which there are as many as all roots up to pairs, are odd in number: then a path has jumped unseen, or a real root was
    /// called complex.
    pub odd: bool,
    /// Seconds.
    pub seconds: f64,
}

/// Solves one clean instance with a fallback and so many rounds of it.
///
/// # Errors
/// If the solver refuses the instance.
pub fn chart_trial(
    solver: &mut Solver,
    simulation: &Simulation,
    fallback: Fallback,
    retries: u32,
) -> Result<ChartTrial, SolveError> {
    let mut options = SolveOptions { fallback, ..SolveOptions::default() };
    options.paths.retries = retries;
    let started = Instant::now();
    let solution = solver.solve(&simulation.pseudoranges, &options)?;
    Ok(ChartTrial {
        paths: solution.paths,
        jacobians: solver.records().iter().map(|r| r.jacobians).sum(),
        odd: solution.counts.real % 2 == 1,
        seconds: started.elapsed().as_secs_f64(),
    })
}

/// Whether the offsets of all candidates agree, one to one.
pub(crate) fn same_networks(a: &MinimalSolution, b: &MinimalSolution) -> bool {
    let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6 * (1.0 + a.abs()));
    let mut left: Vec<&[f64]> = b.candidates.iter().map(|c| &c.network.offsets[..]).collect();
    let paired = a.candidates.iter().all(|c| {
        let at = left.iter().position(|other| near(&c.network.offsets, other));
        at.map(|k| left.swap_remove(k)).is_some()
    });
    paired && left.is_empty()
}

/// One instance solved in a hurry and in full.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HurryTrial {
    /// Seconds in full.
    pub seconds_full: f64,
    /// Seconds in a hurry.
    pub seconds: f64,
    /// Paths tracked in a hurry.
    pub tracked: usize,
    /// Of these, paths dropped because they would hardly become real.
    pub dropped: usize,
    /// Real networks found in full.
    pub networks_full: usize,
    /// Real networks found in a hurry.
    pub networks: usize,
    /// Whether the true network is among those of the full search.
    pub truth_full: bool,
    /// Whether it is among those of the hurried one.
    pub truth: bool,
}

/// Solves one clean instance in full and with `hurried` options.
///
/// # Errors
/// If the solver refuses the instance.
pub fn hurry_trial(
    solver: &mut Solver,
    simulation: &Simulation,
    hurried: &SolveOptions,
) -> Result<HurryTrial, SolveError> {
    let mut timed = |options: &SolveOptions| {
        let started = Instant::now();
        let solution = solver.solve(&simulation.pseudoranges, options)?;
        let seconds = started.elapsed().as_secs_f64();
        let near = |s: &MinimalSolution| {
            let mut physical = s.candidates.iter().filter(|c| c.physical);
            physical.any(|c| position_error_of(&c.network, &simulation.network) < FOUND)
        };
        let truth = near(&solution);
        Ok::<_, SolveError>((solution, seconds, truth))
    };
    let (full, seconds_full, truth_full) = timed(&SolveOptions::default())?;
    let (fast, seconds, truth) = timed(hurried)?;
    Ok(HurryTrial {
        seconds_full,
        seconds,
        tracked: fast.paths.tracked,
        dropped: fast.paths.dropped,
        networks_full: full.counts.positive_definite,
        networks: fast.counts.positive_definite,
        truth_full,
        truth,
    })
}

#[cfg(test)]
mod tests {
    use super::{chart_trial, hurry_trial, proof_trial};
    use crate::minimal::{Fallback, SolveOptions, Solver};
    use crate::simulate::{Layout, SimulateOptions, Simulation, simulate};

    fn clean(receivers: usize, transmitters: usize, seed: u64) -> Simulation {
        let options = SimulateOptions {
            receivers,
            transmitters,
            layout: Layout::Normal,
            noise: 0.0,
            seed,
            ..SimulateOptions::default()
        };
        simulate(&options).unwrap()
    }

    #[test]
    fn all_roots_are_proved_distinct() {
        let mut solver = Solver::new();
        for (receivers, transmitters, roots) in [(6, 3, 180), (5, 4, 152), (5, 6, 5)] {
            for seed in 0..2 {
                let (proofs, real) = proof_trial(&mut solver, &clean(receivers, transmitters, seed)).unwrap();
                assert_eq!((proofs.roots, proofs.proved, proofs.unseparated), (roots, roots, 0));
                assert_eq!(proofs.real, real);
            }
        }
    }

    /// The path to one of the real roots ends at a point whose imaginary part is more than 1e-4 of its size.
    #[test]
    fn real_roots_known_roughly_are_real() {
        let (proofs, real) = proof_trial(&mut Solver::new(), &clean(4, 6, 7315)).unwrap();
        assert_eq!((proofs.roots, proofs.proved, proofs.unseparated), (344, 344, 0));
        assert_eq!(proofs.real, real);
    }

    #[test]
    fn the_first_network_that_fits_ends_the_search() {
        // One equation more than unknowns: only the true network fits.
        let mut options = SolveOptions { first_under: Some(1e-9), ..SolveOptions::default() };
        let mut solver = Solver::new();
        let mut tracked = 0;
        for seed in 0..4 {
            let simulation = clean(5, 4, seed);
            let trial = hurry_trial(&mut solver, &simulation, &options).unwrap();
            assert!(trial.truth_full && trial.truth, "{trial:?}");
            tracked += trial.tracked;
            let solution = solver.solve(&simulation.pseudoranges, &options).unwrap();
            assert_eq!(solution.stopped_early, solution.paths.tracked < 152);
        }
        assert!(tracked < 4 * 152, "{tracked}");
        // What cannot be reached is no reason to give less than everything.
        options.first_under = Some(0.0);
        let simulation = clean(5, 4, 0);
        let all = solver.solve(&simulation.pseudoranges, &SolveOptions::default()).unwrap();
        assert_eq!(solver.solve(&simulation.pseudoranges, &options).unwrap(), all);
    }

    /// Some paths of this one pass so near to a singularity that one was lost, of 5,000 networks, before they went on in other charts.
    #[test]
    fn hard_paths_are_recovered() {
        let trial = chart_trial(&mut Solver::new(), &clean(5, 4, 1943), Fallback::OtherCharts, 4).unwrap();
        assert_eq!((trial.paths.failed, trial.paths.finite, trial.odd), (0, 152, false));
    }

    /// Real roots come with the parity of all. In these they were odd in number, and no path was reported lost: a path had ended at the
    /// root of another, or at none, too roughly to be seen before ends were refined, or had shrunk to the singular solutions with all
    /// receivers in one point (the last three).
    #[test]
    fn jumped_paths_are_seen() {
        let mut solver = Solver::new();
        for (receivers, transmitters, seed) in
            [(6, 3, 393), (6, 3, 4335), (4, 5, 209), (4, 5, 413), (4, 5, 3261), (4, 5, 3887), (4, 5, 6832)]
        {
            let simulation = clean(receivers, transmitters, seed);
            let trial = chart_trial(&mut solver, &simulation, Fallback::OtherCharts, 4).unwrap();
            assert!(trial.paths.failed == 0 && !trial.odd, "{receivers}r/{transmitters}s, seed {seed}: {trial:?}");
        }
    }

    #[test]
    fn dropped_paths_are_counted() {
        let mut options = SolveOptions::default();
        options.paths.tracker.drop_complex = Some(4.0);
        let trial = hurry_trial(&mut Solver::new(), &clean(6, 3, 0), &options).unwrap();
        assert_eq!(trial.tracked, 180);
        assert!(trial.dropped > 0 && trial.dropped + trial.networks <= 180, "{trial:?}");
        assert!(trial.networks <= trial.networks_full, "{trial:?}");
    }
}
