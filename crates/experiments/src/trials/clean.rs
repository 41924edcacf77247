//! Trials of the minimal solvers on clean data: is the true network among the candidates, how
//! accurate, and how many roots are there (the paper's Table 2 and the upper row of its figure 1).

use serde::Serialize;
use tdoa::Simulation;
use tdoa::accuracy::{offset_error, position_error};
use tdoa::minimal::{Candidate, MinimalError, MinimalOptions, Solver, spatial};
use tdoa::{Network, PathCounts, RootCounts};

/// A candidate this near the truth (relative, positions and offsets) is the truth.
const FOUND: f64 = 1e-4;

/// One instance, solved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CleanTrial {
    /// How the paths ended.
    pub paths: PathCounts,
    /// How many roots passed each test.
    pub counts: RootCounts,
    /// Whether the true network is among the physical candidates.
    pub found: bool,
    /// `|X^ - X| / |X - mean X|` over all nodes after the best rigid alignment (reflection
    /// allowed), for the candidate nearest to the truth.
    pub position_error: f64,
    /// `|o^ - o| / |o|` of the same candidate.
    pub offset_error: f64,
    /// The steps of all paths; `None` where solvers keep no records.
    pub steps: Option<Steps>,
}

/// Work, summed over paths.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Steps {
    /// Accepted steps.
    pub accepted: usize,
    /// Rejected steps.
    pub rejected: usize,
    /// Evaluations of the Jacobian.
    pub jacobians: usize,
}

/// Solves one clean instance.
///
/// # Errors
/// If the solver refuses the instance.
pub fn clean_trial(
    solver: &mut Solver,
    simulation: &Simulation,
    options: &MinimalOptions,
) -> Result<CleanTrial, MinimalError> {
    let solution = solver.solve(&simulation.pseudoranges, options)?;
    let records = solver.records();
    let steps = Steps {
        accepted: records.iter().map(|r| r.accepted).sum(),
        rejected: records.iter().map(|r| r.rejected).sum(),
        jacobians: records.iter().map(|r| r.jacobians).sum(),
    };
    Ok(CleanTrial {
        steps: Some(steps),
        ..judged(&solution.candidates, solution.paths, solution.counts, &simulation.network)
    })
}

/// Solves one clean instance in space. If no network is found, the truth is not.
///
/// # Errors
/// If the solver refuses the instance.
pub fn clean_trial_in_space(simulation: &Simulation<3>, options: &MinimalOptions) -> Result<CleanTrial, MinimalError> {
    let truth = &simulation.network;
    match spatial::solve(&simulation.pseudoranges, options) {
        Ok(solution) => Ok(judged(&solution.candidates, solution.paths, solution.counts, truth)),
        Err(MinimalError::NoNetwork | MinimalError::SpecialPosition | MinimalError::InOnePlane) => {
            Ok(judged(&[], PathCounts::default(), RootCounts::default(), truth))
        }
        Err(error) => Err(error),
    }
}

fn judged<const D: usize>(
    candidates: &[Candidate<D>],
    paths: PathCounts,
    counts: RootCounts,
    truth: &Network<D>,
) -> CleanTrial {
    let mut errors = [f64::INFINITY; 2];
    for candidate in candidates.iter().filter(|c| c.physical) {
        let position = position_error(&candidate.network, truth);
        if position < errors[0] {
            errors = [position, offset_error(&candidate.network, truth)];
        }
    }
    let [position_error, offset_error] = errors;
    CleanTrial {
        paths,
        counts,
        found: position_error < FOUND && offset_error < FOUND,
        position_error,
        offset_error,
        steps: None,
    }
}
