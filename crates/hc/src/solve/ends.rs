//! Where all paths of the coefficient stage end.

use super::solutions::{Direction, Solution, Solutions, Unresolved};
use crate::endgame::SingularEnd;
use crate::family::PathCounts;
use crate::refine::Refined;
use crate::store::Records;
use num_complex::Complex64;
use std::collections::BTreeMap;

/// Where a path ends, in four bytes, because there is one for each path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct End(u32);

impl End {
    /// Not known, or not told.
    pub(super) const LOST: End = End(0);
    /// At an isolated solution.
    pub(super) const SOLUTION: End = End(1);
    /// At a point at which the Jacobian is singular, and which is still to be judged.
    pub(super) const SINGULAR: End = End(2);
    /// No longer sought, because all solutions are known ([`SolveOptions::known`](crate::SolveOptions::known)).
    pub(super) const DROPPED: End = End(3);
    /// On a component of positive dimension.
    pub(super) const COMPONENT: End = End(4);
    /// At a point that was not requested.
    pub(super) const EXCESS: End = End(5);
    /// At infinity, in a direction without a number.
    pub(super) const INFINITE: End = End(6);

    /// At infinity, in the direction of this number.
    pub(super) fn infinite(direction: usize) -> End {
        End(u32::try_from(direction).map_or(u32::MAX, |direction| direction.saturating_add(7)))
    }

    /// The number of the direction, if the path ends at infinity in one.
    pub(super) fn direction(self) -> Option<usize> {
        self.0.checked_sub(7).map(|direction| direction as usize)
    }
}

/// Where each path ends, and what is there. A judge of ends reassigns paths; they are counted once, in
/// the end. No points are kept for paths to infinity.
#[derive(Default)]
pub(super) struct Ends {
    /// Number of paths.
    pub(super) paths: usize,
    list: Records,
    /// Paths that must end at solutions, if these are more than all paths that are lost.
    pub(super) missing: usize,
    /// The regular ends by the numbers of their paths, until they are judged.
    pub(super) regular: BTreeMap<usize, Refined>,
    /// The singular ends by the numbers of their paths, until they are judged.
    pub(super) singular: BTreeMap<usize, SingularEnd>,
    /// The directions of paths to infinity by their numbers.
    pub(super) directions: Vec<Direction>,
    /// Isolated solutions.
    pub(super) solutions: Vec<Solution>,
    /// Points on components of positive dimension.
    pub(super) component_points: Vec<Vec<Complex64>>,
    /// Ends whose nature is not known. Their paths are lost.
    pub(super) unresolved: Vec<Unresolved>,
    /// Whether it was digits alone that showed some end to be singular.
    pub(super) by_digits: bool,
    /// Paths to such ends for which no work was left.
    pub(super) unexamined: usize,
    /// How often a path was tracked again.
    pub(super) retracked: usize,
    /// Whether doubtful paths are left because no more may be tracked again.
    pub(super) bounded: bool,
    /// Whether the paths were given up on trial; the ends are then not a result.
    pub(super) abandoned: bool,
}

impl Ends {
    /// So many paths, none of whose ends is known.
    pub(super) fn new(paths: usize) -> Ends {
        Ends { paths, list: Records::new(4), ..Ends::default() }
    }

    pub(super) fn get(&mut self, path: usize) -> End {
        End(self.list.get(path).iter().fold(0, |end, &byte| end << 8 | u32::from(byte)))
    }

    pub(super) fn set(&mut self, path: usize, end: End) {
        self.list.set(path, &end.0.to_be_bytes());
    }

    /// Assigns paths to an end.
    pub(super) fn assign(&mut self, paths: &[usize], end: End) {
        paths.iter().for_each(|&path| self.set(path, end));
    }

    /// Forgets where a path ends.
    pub(super) fn lose(&mut self, path: usize) {
        self.set(path, End::LOST);
        self.regular.remove(&path);
        self.singular.remove(&path);
    }

    /// Assigns paths from one end to another, as many as there are up to a number.
    pub(super) fn reassign(&mut self, number: usize, from: End, to: End) {
        let mut left = number;
        for path in 0..self.paths {
            if left == 0 {
                break;
            }
            if self.get(path) == from {
                self.set(path, to);
                left -= 1;
            }
        }
    }

    /// The number of paths with such an end.
    pub(super) fn count(&mut self, is_such: impl Fn(End) -> bool) -> usize {
        (0..self.paths).filter(|&path| is_such(self.get(path))).count()
    }

    /// The number of paths that go to infinity.
    pub(super) fn infinite(&mut self) -> usize {
        self.count(|end| end == End::INFINITE || end.direction().is_some())
    }

    /// The number of paths whose ends are not known, including those at unresolved ends.
    pub(super) fn lost(&mut self) -> usize {
        self.count(|end| end == End::LOST).max(self.missing)
    }

    /// Adds solutions at which lost paths end.
    pub(super) fn add_missed(&mut self, solutions: Vec<Solution>) {
        self.reassign(solutions.len(), End::LOST, End::SOLUTION);
        self.missing = self.missing.saturating_sub(solutions.len());
        self.solutions.extend(solutions);
    }

    /// Replaces all that paths have found by all isolated solutions. Paths that end at none of them go
    /// to infinity.
    pub(super) fn with_all(self, solutions: Vec<Solution>) -> Ends {
        let mut ends = Ends::new(self.paths);
        ends.reassign(solutions.iter().map(|s| s.multiplicity).sum(), End::LOST, End::SOLUTION);
        ends.reassign(ends.paths, End::LOST, End::INFINITE);
        Ends { solutions, ..ends }
    }

    /// The solutions, without data about the start system. `retracked` paths were tracked again.
    pub(super) fn solutions(mut self, retracked: usize) -> Solutions {
        let (tracked, failed) = (self.paths, self.lost());
        let (at_infinity, dropped) = (self.infinite(), self.count(|end| end == End::DROPPED));
        let finite = tracked.saturating_sub(at_infinity + failed + dropped);
        let (on_components, excess) = (self.count(|end| end == End::COMPONENT), self.count(|end| end == End::EXCESS));
        self.directions.retain(|direction| direction.paths > 0);
        self.directions.sort_by(|a, b| (&a.valuations, a.denominator).cmp(&(&b.valuations, b.denominator)));
        Solutions {
            paths: PathCounts { tracked, finite, at_infinity, failed, dropped, retracked },
            on_components,
            component_points: self.component_points,
            excess,
            directions: self.directions,
            solutions: self.solutions,
            unresolved: self.unresolved,
            ..Solutions::default()
        }
    }
}
