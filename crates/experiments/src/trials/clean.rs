//! Trials of the minimal solvers on clean data: is the true network among the candidates, how
//! accurate, and how many roots are there (the paper's Table 2 and the upper row of its figure 1).

use serde::Serialize;
use tdoa::Simulation;
use tdoa::accuracy::{offset_error, position_error};
use tdoa::minimal::{MinimalError, MinimalOptions, Solver};
use tdoa::{PathCounts, RootCounts};

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
    /// Accepted steps over all paths.
    pub steps: usize,
    /// Rejected steps over all paths.
    pub rejected: usize,
    /// Evaluations of the Jacobian over all paths.
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
    let truth = &simulation.network;
    let mut errors = [f64::INFINITY; 2];
    for candidate in solution.candidates.iter().filter(|c| c.physical) {
        let position = position_error(&candidate.network, truth);
        if position < errors[0] {
            errors = [position, offset_error(&candidate.network, truth)];
        }
    }
    let [position_error, offset_error] = errors;
    let records = solver.records();
    Ok(CleanTrial {
        paths: solution.paths,
        counts: solution.counts,
        found: position_error < FOUND && offset_error < FOUND,
        position_error,
        offset_error,
        steps: records.iter().map(|r| r.accepted).sum(),
        rejected: records.iter().map(|r| r.rejected).sum(),
        jacobians: records.iter().map(|r| r.jacobians).sum(),
    })
}
