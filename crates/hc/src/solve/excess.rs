//! Solutions that were not requested.

use crate::singular::{Consistency, ExactEquations, consistency};
use crate::tolerances::ends;
use num_complex::Complex64;

/// Says of a regular end that no path leads there that has not jumped.
pub(crate) type Stray<'a> = dyn Fn(&[Complex64]) -> bool + Sync + 'a;

/// Which points were not requested.
pub(super) struct Excess<'a> {
    /// All equations, if there are more equations than unknowns.
    all: Option<&'a ExactEquations>,
    torus_only: bool,
    /// The coordinates that must not vanish there, the first ones.
    unknowns: usize,
    stray: Option<&'a Stray<'a>>,
}

impl<'a> Excess<'a> {
    /// What was not requested of given equations, of which the first `unknowns` unknowns count.
    pub(super) fn new(given: Option<&'a ExactEquations>, torus_only: bool, unknowns: usize) -> Excess<'a> {
        Excess { all: given.filter(|given| given.len() > given.unknowns()), torus_only, unknowns, stray: None }
    }

    /// No point is excess: every point that is found was requested.
    pub(super) fn none() -> Excess<'static> {
        Excess { all: None, torus_only: false, unknowns: 0, stray: None }
    }

    /// No point is excess, but paths that end at some have jumped.
    pub(super) fn with_stray(stray: Option<&'a Stray<'a>>) -> Excess<'a> {
        Excess { stray, ..Excess::none() }
    }

    /// Whether a path with this regular end has jumped.
    pub(super) fn is_stray(&self, point: &[Complex64]) -> bool {
        self.stray.is_some_and(|stray| stray(point))
    }

    /// Whether a regular end was requested: it solves all equations, and does not lie outside the torus.
    pub(super) fn of_regular(&self, point: &[Complex64]) -> Consistency {
        if self.outside(point) {
            return Consistency::Misses;
        }
        self.all.map_or(Consistency::Solves, |given| consistency(given, point))
    }

    /// Whether a point has a zero coordinate although only the torus was requested.
    pub(super) fn outside(&self, point: &[Complex64]) -> bool {
        let point = &point[..self.unknowns.min(point.len())];
        let largest = point.iter().map(|z| z.norm()).fold(0.0, f64::max);
        self.torus_only && point.iter().any(|z| z.norm() <= ends::TORUS * largest)
    }

    /// Whether there are more equations than unknowns.
    pub(super) fn overdetermined(&self) -> bool {
        self.all.is_some()
    }
}
