//! From the ends of paths to solutions: regular ends, directions to infinity, and then singular ends.

use super::ends::{End, Ends};
use super::excess::Excess;
use super::infinity::Line;
use super::solutions::{Solution, Solutions};
use crate::distinct::coincidences;
use crate::exact::{Digits, SmallSystem};
use crate::monitor::Monitor;
use crate::refine::{Refined, Refiner};
use crate::singular::{self, ExactEquations};
use crate::start::PathSystem;
use num_complex::Complex64;
use poly::{Exact, Polynomial};
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::OnceLock;

/// The given equations as polynomials, by which ends are judged.
pub(super) struct Expanded<'a> {
    polynomials: Cow<'a, [Polynomial<Exact>]>,
    pub(super) given: ExactEquations,
    /// Whether the coefficients that are tracked are exactly those that were given.
    pub(super) exact: bool,
    /// The equations in one unknown or two, once they are asked for.
    small: OnceLock<Option<SmallSystem>>,
}

impl<'a> Expanded<'a> {
    /// Takes polynomials in unknowns whose units have these logarithms to base 2.
    pub(super) fn new(
        polynomials: impl Into<Cow<'a, [Polynomial<Exact>]>>,
        units: Vec<i64>,
        exact: bool,
        monitor: &Monitor,
    ) -> Expanded<'a> {
        let polynomials = polynomials.into();
        let given = ExactEquations::new(&polynomials, units).stopped_by(monitor);
        Expanded { polynomials, given, exact, small: OnceLock::new() }
    }

    /// The equations, if they come down to one unknown or two.
    pub(super) fn small(&self) -> Option<&SmallSystem> {
        self.small.get_or_init(|| SmallSystem::new(&self.polynomials)).as_ref()
    }
}

/// A system that was tracked, and what its ends are judged by.
pub(super) struct Tracked<'a> {
    pub(super) expanded: &'a Expanded<'a>,
    /// The work that may be done for the ends.
    pub(super) work: u64,
    /// As many equations as unknowns, with their parameters.
    pub(super) system: &'a PathSystem,
    pub(super) target: &'a [Complex64],
    /// The supports and coefficients that were tracked, where these move along a straight line.
    pub(super) line: Option<Line<'a>>,
    pub(super) monitor: &'a Monitor,
    /// How to solve the equations of a cluster; `None` deep enough within such solves.
    pub(super) solve_cluster: Option<&'a ClusterSolver<'a>>,
}

impl Tracked<'_> {
    /// All solutions without paths, regular ones first, if the equations come down to one unknown or two.
    pub(super) fn solutions(&self) -> Option<Vec<Solution>> {
        let mut refiner = Refiner::new(self.system);
        let given = &self.expanded.given;
        let units = given.scales();
        let solution = |(values, multiplicity): (Vec<Digits>, usize)| {
            // Several may be one double.
            let value: Vec<Complex64> = values.iter().zip(units).map(|(z, &u)| z.shifted(-u).to_c64()).collect();
            let residual = singular::residual(given, &value);
            let condition = refiner.judged(self.target, &value).condition;
            Solution::new(value, multiplicity, multiplicity, multiplicity > 1, residual, condition)
        };
        let mut all: Vec<Solution> = self.expanded.small()?.solutions()?.into_iter().map(solution).collect();
        all.sort_by_key(|s| s.singular);
        Some(all)
    }
}

/// Solves the equations of a cluster of ends, as part of the work on the given equations.
pub(super) type ClusterSolver<'a> = dyn Fn(&[Polynomial<Exact>], &ExactEquations) -> Option<Solutions> + Sync + 'a;

impl Ends {
    /// Judges what all paths have found. Without `tracked`, paths to singular ends are lost.
    pub(super) fn judged(mut self, tracked: Option<&Tracked<'_>>, excess: &Excess<'_>, coincidence: f64) -> Ends {
        let regular = std::mem::take(&mut self.regular);
        let groups = coincidences(regular.iter().map(|(&path, r)| (path, &r.point[..])), coincidence);
        let repeated: BTreeSet<usize> = groups.iter().flat_map(|group| &group[1..]).copied().collect();
        let mut solutions = Vec::new();
        for (path, refined) in regular.into_iter().filter(|(path, _)| !repeated.contains(path)) {
            if excess.contains_regular(&refined.point) {
                self.set(path, End::EXCESS);
            } else {
                let Refined { point, residual, condition, .. } = refined;
                solutions.push((path, Solution::new(point, 1, 1, false, residual, condition)));
            }
        }
        let Some(tracked) = tracked else {
            self.solutions = solutions.into_iter().map(|(_, solution)| solution).collect();
            self.reassign(self.paths, End::SINGULAR, End::LOST);
            return self;
        };
        if let Some(line) = &tracked.line {
            for k in 0..self.directions.len() {
                self.reassign(line.impossible(&self.directions[k]), End::infinite(k), End::LOST);
            }
        }
        let doubtful = self.correct_rounded(solutions, tracked);
        self.add_singular(tracked, doubtful, excess);
        self
    }
}
