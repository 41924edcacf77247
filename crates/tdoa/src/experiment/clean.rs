//! Trials of the minimal solvers on clean data: is the true network among the candidates, how accurate, and how many roots are
//! there (the paper's Table 2 and the upper row of its figure 1).

use crate::align::align;
use crate::minimal::{SolveError, SolveOptions, Solver};
use crate::network::{Network, PathCounts, RootCounts};
use crate::plane::spread;
use crate::simulate::Simulation;
use serde::Serialize;

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
    /// `|X^ - X| / |X - mean X|` over all nodes after the best rigid alignment (reflection allowed), for the candidate nearest to the truth.
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
    options: &SolveOptions,
) -> Result<CleanTrial, SolveError> {
    let solution = solver.solve(&simulation.pseudoranges, options)?;
    let truth = &simulation.network;
    let (mut position_error, mut offset_error) = (f64::INFINITY, f64::INFINITY);
    for candidate in solution.candidates.iter().filter(|c| c.physical) {
        let position = position_error_of(&candidate.network, truth);
        if position < position_error {
            (position_error, offset_error) = (position, offset_error_of(&candidate.network, truth));
        }
    }
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

/// `|X^ - X| / |X - mean X|` over the positions X of all nodes, after the best rigid alignment (reflection allowed).
pub fn position_error_of(found: &Network, truth: &Network) -> f64 {
    let nodes = |n: &Network| n.receivers.iter().chain(&n.transmitters).copied().collect::<Vec<_>>();
    let (found, truth) = (nodes(found), nodes(truth));
    align(&found, &truth, false).map_or(f64::INFINITY, |alignment| alignment.rms / spread(truth.iter()))
}

/// `|o^ - o| / |o|` over the offsets o.
pub fn offset_error_of(found: &Network, truth: &Network) -> f64 {
    let difference: f64 = found.offsets.iter().zip(&truth.offsets).map(|(a, b)| (a - b).powi(2)).sum();
    (difference / truth.offsets.iter().map(|o| o * o).sum::<f64>()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{CleanTrial, clean_trial};
    use crate::minimal::{SolveOptions, Solver};
    use crate::simulate::{Layout, SimulateOptions, simulate};

    /// Solves `count` networks of a size: no path is lost, the truth is found, and with at most 1e-12 of error in the median.
    fn trials(receivers: usize, transmitters: usize, count: u64) -> Vec<CleanTrial> {
        let mut solver = Solver::new();
        let one = |seed| {
            let options = SimulateOptions {
                receivers,
                transmitters,
                layout: Layout::Normal,
                noise: 0.0,
                seed,
                ..SimulateOptions::default()
            };
            clean_trial(&mut solver, &simulate(&options).unwrap(), &SolveOptions::default()).unwrap()
        };
        let trials: Vec<_> = (0..count).map(one).collect();
        let size = format!("{receivers}r/{transmitters}s");
        assert!(trials.iter().all(|t| t.paths.failed == 0 && t.found), "{size}: {trials:?}");
        for error in [|t: &CleanTrial| t.position_error, |t: &CleanTrial| t.offset_error] {
            let mut errors: Vec<f64> = trials.iter().map(error).collect();
            errors.sort_by(f64::total_cmp);
            assert!(errors[errors.len() / 2] < 1e-12, "{size}: {errors:?}");
        }
        trials
    }

    #[test]
    fn families_are_solved_completely() {
        // Root counts by Groebner bases over a prime field and by monodromy with the trace test; real networks come in pairs.
        for (receivers, transmitters, roots, count) in [(6, 3, 180, 60), (5, 4, 152, 40), (4, 5, 344, 25)] {
            let trials = trials(receivers, transmitters, count);
            assert!(trials.iter().all(|t| t.counts.positive_definite.is_multiple_of(2)));
            assert!(trials.iter().all(|t| t.counts.complex == roots || t.paths.at_infinity > 0));
        }
    }

    #[test]
    fn larger_networks_are_solved_through_smaller_ones() {
        let sizes = [(7, 3), (9, 3), (6, 4), (6, 5), (5, 5), (4, 6), (4, 8), (5, 6), (6, 6), (7, 4), (10, 20)];
        for (receivers, transmitters) in sizes {
            trials(receivers, transmitters, 12);
        }
    }
}
