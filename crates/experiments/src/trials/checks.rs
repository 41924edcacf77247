//! Checks of the minimal solvers on clean data by other means: interval proofs of the roots, the
//! polyhedral route beside the stored start, what the options for callers in a hurry save and lose,
//! and what becomes of paths that fail.

use serde::Serialize;
use std::time::Instant;
use tdoa::Simulation;
use tdoa::accuracy::position_error;
use tdoa::minimal::{MinimalError, MinimalOptions, MinimalStart, RootProofs, Solver};
use tdoa::{MinimalSolution, PathCounts, RootCounts};

/// A candidate this near the truth (relative to the network's size) is the truth.
const FOUND: f64 = 1e-4;

/// Solves one clean instance and proves its roots; with the number of roots that the solver counts
/// as real.
///
/// # Errors
/// If the solver refuses the instance.
pub fn proof_trial(solver: &mut Solver, simulation: &Simulation) -> Result<(RootProofs, usize), MinimalError> {
    let solution = solver.solve(&simulation.pseudoranges, &MinimalOptions::default())?;
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
pub fn route_trial(solver: &mut Solver, simulation: &Simulation) -> Result<RouteTrial, MinimalError> {
    let mut options = MinimalOptions::default();
    let stored = solver.solve(&simulation.pseudoranges, &options)?;
    options.start = MinimalStart::Polyhedral;
    let polyhedral = solver.solve(&simulation.pseudoranges, &options)?;
    let agree = same_networks(&stored, &polyhedral);
    Ok(RouteTrial { stored: stored.counts, polyhedral: polyhedral.counts, paths: polyhedral.paths, agree })
}

/// One instance, and what became of its paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ChartTrial {
    /// How the paths ended.
    pub paths: PathCounts,
    /// Evaluations of the Jacobian in the first starts of all paths and what follows these.
    pub jacobians: usize,
    /// Whether the real roots, of which there are as many as all roots up to pairs, are odd in
    /// number: then a path has jumped unseen, or a real root was called complex.
    pub odd: bool,
    /// Seconds.
    pub seconds: f64,
}

/// Solves one clean instance, with so many more rounds for the paths that fail.
///
/// # Errors
/// If the solver refuses the instance.
pub fn chart_trial(solver: &mut Solver, simulation: &Simulation, retries: u32) -> Result<ChartTrial, MinimalError> {
    let mut options = MinimalOptions::default();
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
fn same_networks(a: &MinimalSolution, b: &MinimalSolution) -> bool {
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
    /// Real networks found in full.
    pub networks_full: usize,
    /// Real networks found in a hurry.
    pub networks: usize,
    /// Whether the true network is among those of the full search.
    pub truth_full: bool,
    /// Whether the true network is among those of the hurried search.
    pub truth: bool,
}

/// Solves one clean instance in full and with `hurried` options.
///
/// # Errors
/// If the solver refuses the instance.
pub fn hurry_trial(
    solver: &mut Solver,
    simulation: &Simulation,
    hurried: &MinimalOptions,
) -> Result<HurryTrial, MinimalError> {
    let mut timed = |options: &MinimalOptions| {
        let started = Instant::now();
        let solution = solver.solve(&simulation.pseudoranges, options)?;
        let seconds = started.elapsed().as_secs_f64();
        let near = |s: &MinimalSolution| {
            let mut physical = s.candidates.iter().filter(|c| c.physical);
            physical.any(|c| position_error(&c.network, &simulation.network) < FOUND)
        };
        let truth = near(&solution);
        Ok::<_, MinimalError>((solution, seconds, truth))
    };
    let (full, seconds_full, truth_full) = timed(&MinimalOptions::default())?;
    let (fast, seconds, truth) = timed(hurried)?;
    Ok(HurryTrial {
        seconds_full,
        seconds,
        tracked: fast.paths.tracked,
        networks_full: full.counts.positive_definite,
        networks: fast.counts.positive_definite,
        truth_full,
        truth,
    })
}

#[cfg(test)]
mod tests {
    use super::hurry_trial;
    use tdoa::minimal::{MinimalOptions, Solver};
    use tdoa::{Layout, SimulateOptions, simulate};

    #[test]
    fn a_hurried_search_finds_no_more_than_a_full_one() {
        let mut simulated = SimulateOptions::default();
        (simulated.receivers, simulated.transmitters) = (6, 3);
        simulated.layout = Layout::Normal;
        let mut options = MinimalOptions::default();
        options.first_under = Some(1e-9);
        let trial = hurry_trial(&mut Solver::new(), &simulate(&simulated).unwrap(), &options).unwrap();
        assert!(trial.tracked <= 180 && trial.truth_full, "{trial:?}");
        assert!(trial.networks <= trial.networks_full, "{trial:?}");
    }
}
