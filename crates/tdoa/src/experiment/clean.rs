//! Trials of the minimal solvers on clean data: is the true network among the candidates, how accurate, and how many roots are
//! there (the paper's Table 2 and the upper row of its figure 1).

use crate::align::align;
use crate::minimal::{SolveError, SolveOptions, Solver};
use crate::network::{Network, PathCounts, RootCounts};
use crate::simulate::Simulation;
use serde::Serialize;
use std::time::Instant;

/// A candidate this near the truth (relative, positions and offsets) is the truth.
const FOUND: f64 = 1e-4;

/// One instance, solved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CleanTrial {
    /// Seed of the instance.
    pub seed: u64,
    /// How the paths ended.
    pub paths: PathCounts,
    /// How many roots passed each test.
    pub counts: RootCounts,
    /// Whether real networks come in pairs with this solver, so that an odd number betrays a lost path.
    pub paired: bool,
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
    /// Seconds on one thread.
    pub seconds: f64,
}

/// Solves one clean instance.
///
/// # Errors
/// If the solver refuses the instance.
pub fn clean_trial(
    solver: &mut Solver,
    simulation: &Simulation,
    seed: u64,
    options: &SolveOptions,
) -> Result<CleanTrial, SolveError> {
    let started = Instant::now();
    let solution = solver.solve(&simulation.pseudoranges, options)?;
    let seconds = started.elapsed().as_secs_f64();
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
        seed,
        paths: solution.paths,
        counts: solution.counts,
        paired: matches!(solution.solver, "6r/3s" | "5r/4s" | "4r/5s"),
        found: position_error < FOUND && offset_error < FOUND,
        position_error,
        offset_error,
        steps: records.iter().map(|r| r.accepted).sum(),
        rejected: records.iter().map(|r| r.rejected).sum(),
        jacobians: records.iter().map(|r| r.jacobians).sum(),
        seconds,
    })
}

/// `|X^ - X| / |X - mean X|` over the positions X of all nodes, after the best rigid alignment (reflection allowed).
pub fn position_error_of(found: &Network, truth: &Network) -> f64 {
    let nodes = |n: &Network| n.receivers.iter().chain(&n.transmitters).copied().collect::<Vec<_>>();
    let (found, truth) = (nodes(found), nodes(truth));
    let count = truth.len() as f64;
    let centre = [0, 1].map(|k| truth.iter().map(|p| p[k]).sum::<f64>() / count);
    let size =
        (truth.iter().map(|p| (p[0] - centre[0]).powi(2) + (p[1] - centre[1]).powi(2)).sum::<f64>() / count).sqrt();
    align(&found, &truth, false).map_or(f64::INFINITY, |alignment| alignment.rms / size)
}

/// `|o^ - o| / |o|` over the offsets o.
pub fn offset_error_of(found: &Network, truth: &Network) -> f64 {
    let difference: f64 = found.offsets.iter().zip(&truth.offsets).map(|(a, b)| (a - b).powi(2)).sum();
    (difference / truth.offsets.iter().map(|o| o * o).sum::<f64>()).sqrt()
}

/// What many clean trials say together.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CleanSummary {
    /// Instances.
    pub instances: usize,
    /// Instances in which every path ended well.
    pub complete: usize,
    /// Paths lost after all fallbacks.
    pub paths_lost: usize,
    /// Paths that went to infinity.
    pub paths_at_infinity: usize,
    /// Paths tracked a second time or more often.
    pub paths_retracked: usize,
    /// Instances in which some path was.
    pub instances_retracked: usize,
    /// Instances whose truth is among the candidates.
    pub found: usize,
    /// Instances with an odd number of real networks where they come in pairs: each would betray a lost path.
    pub odd: usize,
    /// Least, largest, mean and standard deviation of the number of roots with H > 0.
    pub positive_definite: [f64; 4],
    /// The same for the physical ones among them.
    pub physical: [f64; 4],
    /// Median and 99th percentile of the position error.
    pub position_error: [f64; 2],
    /// Median and 99th percentile of the offset error.
    pub offset_error: [f64; 2],
    /// Accepted steps, rejected steps and Jacobians a path.
    pub per_path: [f64; 3],
    /// Median and 99th percentile of the seconds.
    pub seconds: [f64; 2],
}

/// Sums up clean trials, of which there must be some.
pub fn summarise(trials: &[CleanTrial]) -> CleanSummary {
    let count = |test: &dyn Fn(&CleanTrial) -> bool| trials.iter().filter(|t| test(t)).count();
    let sum = |value: &dyn Fn(&CleanTrial) -> usize| trials.iter().map(value).sum::<usize>();
    let tracked = sum(&|t| t.paths.tracked).max(1) as f64;
    CleanSummary {
        instances: trials.len(),
        complete: count(&|t| t.paths.failed == 0),
        paths_lost: sum(&|t| t.paths.failed),
        paths_at_infinity: sum(&|t| t.paths.at_infinity),
        paths_retracked: sum(&|t| t.paths.retracked),
        instances_retracked: count(&|t| t.paths.retracked > 0),
        found: count(&|t| t.found),
        odd: count(&|t| t.paired && t.counts.positive_definite % 2 == 1),
        positive_definite: moments(trials.iter().map(|t| t.counts.positive_definite)),
        physical: moments(trials.iter().map(|t| t.counts.physical)),
        position_error: quantiles(trials.iter().map(|t| t.position_error)),
        offset_error: quantiles(trials.iter().map(|t| t.offset_error)),
        per_path: [sum(&|t| t.steps), sum(&|t| t.rejected), sum(&|t| t.jacobians)].map(|v| v as f64 / tracked),
        seconds: quantiles(trials.iter().map(|t| t.seconds)),
    }
}

/// Least, largest, mean, standard deviation.
fn moments(values: impl Iterator<Item = usize>) -> [f64; 4] {
    let values: Vec<f64> = values.map(|v| v as f64).collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(0.0, f64::max);
    [least, largest, mean, variance.sqrt()]
}

/// Median and 99th percentile.
fn quantiles(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [50, 99].map(|percent| values.get(values.len() * percent / 100).copied().unwrap_or(f64::NAN))
}

#[cfg(test)]
mod tests {
    use super::{CleanSummary, CleanTrial, clean_trial, summarise};
    use crate::minimal::{SolveOptions, Solver};
    use crate::simulate::{Layout, SimulateOptions, simulate};

    fn trials(receivers: usize, transmitters: usize, count: u64) -> (Vec<CleanTrial>, CleanSummary) {
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
            clean_trial(&mut solver, &simulate(&options).unwrap(), seed, &SolveOptions::default()).unwrap()
        };
        let trials: Vec<_> = (0..count).map(one).collect();
        let summary = summarise(&trials);
        (trials, summary)
    }

    #[test]
    fn families_are_solved_completely() {
        // Root counts by Groebner bases over a prime field and by monodromy with the trace test.
        for (receivers, transmitters, roots, count) in [(6, 3, 180, 60), (5, 4, 152, 40), (4, 5, 344, 25)] {
            let (trials, summary) = trials(receivers, transmitters, count);
            let all = count as usize;
            assert_eq!((summary.complete, summary.found, summary.odd), (all, all, 0), "{summary:?}");
            assert!(trials.iter().all(|t| t.counts.complex == roots || t.paths.at_infinity > 0));
            assert!(summary.position_error[0] < 1e-12 && summary.offset_error[0] < 1e-12, "{summary:?}");
        }
    }

    #[test]
    fn larger_networks_are_solved_through_smaller_ones() {
        let sizes = [(7, 3), (9, 3), (6, 4), (6, 5), (5, 5), (4, 6), (4, 8), (5, 6), (6, 6), (7, 4), (10, 20)];
        for (receivers, transmitters) in sizes {
            let (_, summary) = trials(receivers, transmitters, 12);
            let size = format!("{receivers}r/{transmitters}s");
            assert_eq!((summary.complete, summary.found, summary.odd), (12, 12, 0), "{size}: {summary:?}");
            assert!(summary.position_error[0] < 1e-12 && summary.offset_error[0] < 1e-12, "{size}: {summary:?}");
        }
    }
}
