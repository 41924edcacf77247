//! From the ends of paths to solutions: regular ends, directions to infinity, and then singular ends.

use super::ends::{End, Ends};
use super::excess::Excess;
use super::infinity::Line;
use super::solutions::{Solution, Solutions, is_real_in_doubt};
use crate::distinct::coincidences;
use crate::endgame::SingularEnd;
use crate::exact::{Digits, SmallSystem};
use crate::monitor::Monitor;
use crate::refine::{Refined, Refiner};
use crate::singular::{self, Census, Consistency, ExactEquations, census};
use crate::start::PathSystem;
use crate::threads::IntoParallelRefIterator;
#[cfg(feature = "threads")]
use crate::threads::ParallelIterator;
use crate::tolerances::{ends, equations};
use num_complex::Complex64;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
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
    /// Whether all coefficients are real.
    is_real: bool,
    /// The equations in one unknown or two, once they are asked for.
    small: OnceLock<Option<SmallSystem>>,
    /// The numbers of all solutions, once they are asked for.
    census: OnceLock<Option<Census>>,
}

impl<'a> Expanded<'a> {
    /// Takes polynomials in unknowns whose units have these logarithms to base 2, and a seed for primes.
    pub(super) fn new(
        polynomials: impl Into<Cow<'a, [Polynomial<Exact>]>>,
        units: Vec<i64>,
        exact: bool,
        seed: u64,
        monitor: &Monitor,
    ) -> Expanded<'a> {
        let polynomials = polynomials.into();
        let given = ExactEquations::new(&polynomials, units).seeded(seed).stopped_by(monitor);
        let is_real = polynomials.iter().flat_map(|p| p.terms()).all(|(_, c)| c.im.is_zero());
        Expanded { polynomials, given, exact, is_real, small: OnceLock::new(), census: OnceLock::new() }
    }

    /// The equations, if they come down to one unknown or two.
    pub(super) fn small(&self) -> Option<&SmallSystem> {
        self.small.get_or_init(|| SmallSystem::new(&self.polynomials, self.given.seed())).as_ref()
    }

    /// Whether coefficients are so different in size, or so long, that solutions may lie beyond where paths to infinity
    /// are followed.
    pub(super) fn may_have_far_solutions(&self) -> bool {
        let bits = |q: &BigRational| q.numer().bits().max(q.denom().bits());
        let mut coefficients = self.polynomials.iter().flat_map(|p| p.terms()).map(|(_, c)| c);
        if coefficients.any(|c| bits(&c.re).max(bits(&c.im)) > equations::LONG) {
            return true;
        }
        let span = |p: &Polynomial<Exact>| {
            let sizes = p.terms().iter().filter_map(|(_, c)| Some(c.re.to_f64()?.hypot(c.im.to_f64()?).log2()));
            let (low, high) = sizes.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (s.min(a), s.max(b)));
            (high - low).max(0.0)
        };
        self.polynomials.iter().map(span).sum::<f64>() > equations::FAR_RATIOS
    }

    /// Where paths end that do not end at solutions, if there are no components: at infinity, or at points that solve only
    /// combinations of more equations than unknowns.
    pub(super) fn elsewhere(&self) -> End {
        if self.given.len() > self.given.unknowns() { End::EXCESS } else { End::INFINITE }
    }

    /// How many solutions there are of each multiplicity, if they have been counted.
    pub(super) fn counted(&self) -> Option<&Census> {
        self.census.get()?.as_ref()
    }

    /// How many solutions there are of each multiplicity, with zero coordinates too, if these are finitely many and
    /// `work` products modulo a prime tell.
    fn census(&self, work: u64, monitor: &Monitor) -> Option<&Census> {
        let count = || {
            if self.polynomials.iter().any(Polynomial::is_laurent) { None } else { census(&self.given, work, monitor) }
        };
        self.census.get_or_init(count).as_ref()
    }
}

/// A system that was tracked, and what its ends are judged by.
pub(super) struct Tracked<'a> {
    pub(super) expanded: &'a Expanded<'a>,
    /// The work that may be done for the ends.
    pub(super) work: u64,
    /// Products modulo a prime that may be done to count all solutions; none where it does not matter, or the number
    /// of solutions is not that of those that were asked for.
    pub(super) census_work: u64,
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
    /// How many solutions there are of each multiplicity, as far as that is known.
    pub(super) fn census(&self) -> Option<&Census> {
        if self.census_work == 0 { None } else { self.expanded.census(self.census_work, self.monitor) }
    }

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
        let (mut solutions, mut unclear) = (Vec::new(), Vec::new());
        let ends: Vec<(usize, Refined)> = regular.into_iter().filter(|(path, _)| !repeated.contains(path)).collect();
        let asked: Vec<Consistency> = ends.par_iter().map(|(_, end)| excess.of_regular(&end.point)).collect();
        for ((path, end), asked) in ends.into_iter().zip(asked) {
            let Refined { point, residual, condition, .. } = end;
            match asked {
                Consistency::Misses => self.set(path, End::EXCESS),
                Consistency::Solves => solutions.push((path, Solution::new(point, 1, 1, false, residual, condition))),
                Consistency::Unclear => {
                    self.set(path, End::SINGULAR);
                    unclear.push((path, SingularEnd { point, winding: 1, error: ends::ROUNDED }));
                }
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
        unclear.extend(self.correct_rounded(solutions, tracked));
        self.add_singular(tracked, unclear, excess);
        self
    }

    /// Decides by many digits which regular solutions are real, where their imaginary parts are neither rounding errors
    /// nor clearly not zero.
    pub(super) fn decide_real(mut self, expanded: &Expanded<'_>) -> Ends {
        let decided: Vec<Option<bool>> = (self.solutions.par_iter())
            .map(|s| {
                let in_doubt = !s.singular && is_real_in_doubt(&s.value, s.condition, expanded.is_real);
                in_doubt.then(|| singular::is_real(&expanded.given, &s.value)).flatten()
            })
            .collect();
        for (solution, is_real) in self.solutions.iter_mut().zip(decided) {
            solution.is_real = is_real.unwrap_or(solution.is_real);
        }
        self
    }
}
