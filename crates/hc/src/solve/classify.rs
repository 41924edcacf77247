//! From the ends of paths to solutions: multiplicities, and which singular ends are isolated.

use super::ends::Ends;
use super::excess::Excess;
use super::infinity::Line;
use super::solutions::{Direction, Solution, Solutions, Unresolved, is_real};
use crate::distinct::coincidences;
use crate::family::PathCounts;
use crate::monitor::Monitor;
use crate::refine::Refined;
use crate::singular::Given;
use crate::start::PathSystem;
use crate::tolerances::ENDS;
use num_complex::Complex64;
use poly::{Exact, Polynomial};

/// The result of all ends of paths.
#[derive(Debug, Default)]
pub(super) struct Classified {
    /// Isolated solutions.
    pub(super) solutions: Vec<Solution>,
    /// Points on components of positive dimension.
    pub(super) component_points: Vec<Vec<Complex64>>,
    /// Number of paths that end on components.
    pub(super) on_components: usize,
    /// Number of paths that end at points that were not requested.
    pub(super) excess: usize,
    pub(super) infinite: usize,
    pub(super) directions: Vec<Direction>,
    /// Number of paths whose ends are not known, including those at unresolved ends.
    pub(super) lost: usize,
    pub(super) dropped: usize,
    pub(super) unresolved: Vec<Unresolved>,
}

impl Classified {
    /// The solutions, without data about the start system. `tracked` paths were tracked, and
    /// `retracked` of these were tracked again.
    pub(super) fn solutions(self, tracked: usize, retracked: usize) -> Solutions {
        Solutions {
            paths: self.counts(tracked, retracked),
            on_components: self.on_components,
            component_points: self.component_points,
            excess: self.excess,
            directions: self.directions,
            solutions: self.solutions,
            unresolved: self.unresolved,
            ..Solutions::default()
        }
    }

    /// How `tracked` paths ended; `retracked` tracks were run again.
    fn counts(&self, tracked: usize, retracked: usize) -> PathCounts {
        PathCounts {
            tracked,
            finite: tracked.saturating_sub(self.infinite + self.lost + self.dropped),
            at_infinity: self.infinite,
            failed: self.lost,
            dropped: self.dropped,
            retracked,
        }
    }
}

/// A system that was tracked, and the given equations, by which its ends are judged.
pub(super) struct Tracked<'a> {
    pub(super) given: &'a Given,
    /// The work that may be done for the ends.
    pub(super) work: u64,
    /// The same equations as polynomials.
    pub(super) polynomials: &'a [Polynomial<Exact>],
    /// As many equations as unknowns, with their parameters.
    pub(super) system: &'a PathSystem,
    pub(super) target: &'a [Complex64],
    /// The same as supports and coefficients, where these move along a straight line.
    pub(super) line: Option<Line<'a>>,
    /// Whether the coefficients that were tracked are exactly those that were given.
    pub(super) exact: bool,
    pub(super) monitor: &'a Monitor,
    /// How to solve the equations of a cluster; `None` deep enough within such solves.
    pub(super) solve_cluster: Option<&'a ClusterSolver<'a>>,
}

/// Solves the equations of a cluster of ends, as part of the work on the given equations.
pub(super) type ClusterSolver<'a> = dyn Fn(&[Polynomial<Exact>], &Given) -> Option<Solutions> + Sync + 'a;

/// Sorts ends into solutions. Without `tracked`, singular ends are lost.
pub(super) fn classify(tracked: Option<&Tracked<'_>>, all: &Ends, excess: &Excess<'_>, coincidence: f64) -> Classified {
    let mut out = Classified::default();
    let regular: Vec<&Refined> = all.regular.values().collect();
    let mut repeated = vec![false; regular.len()];
    for group in coincidences(regular.iter().enumerate().map(|(k, r)| (k, &r.point[..])), coincidence) {
        group[1..].iter().for_each(|&k| repeated[k] = true);
    }
    for (refined, _) in regular.iter().zip(&repeated).filter(|(_, again)| !**again) {
        if excess.contains_regular(&refined.point) {
            out.excess += 1;
        } else {
            out.solutions.push(regular_solution(refined));
        }
    }
    (out.lost, out.dropped) = (all.lost, all.dropped);
    out.infinite = all.directions.iter().map(|(_, _, paths)| paths).sum();
    let directions = all.directions.iter().cloned();
    out.directions =
        directions.map(|(valuations, denominator, paths)| Direction { valuations, denominator, paths }).collect();
    let Some(tracked) = tracked else {
        out.lost += all.singular.len();
        return out;
    };
    let impossible = tracked.line.as_ref().map_or(0, |line| line.impossible(all));
    (out.infinite, out.lost) = (out.infinite - impossible, out.lost + impossible);
    let doubtful = out.correct_rounded(tracked);
    out.add_singular(tracked, all, &doubtful, excess);
    out
}

fn regular_solution(refined: &Refined) -> Solution {
    Solution {
        value: refined.point.clone(),
        multiplicity: 1,
        winding_number: 1,
        singular: false,
        is_real: is_real(&refined.point, ENDS.real),
        residual: refined.residual,
        condition: refined.condition,
        certified: None,
    }
}
