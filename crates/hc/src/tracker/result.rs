//! How paths ended.

use crate::distinct::is_real;
use crate::tolerances::ends;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// Why a path ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum PathEnd {
    /// A regular solution of the target system, or at the end of a [piece](crate::homotopy::ParameterPath::pieces)
    /// of the system there.
    Success,
    /// Some coordinates grow without bound: their valuations are negative and settled.
    AtInfinity,
    /// The path stays bounded until `t` is nearly zero, but its end is not a regular solution.
    Singular,
    /// The path ended at a solution at which a factor vanishes that the family
    /// [declares nonzero](crate::family::Stated::nonzero), or that does not solve [all of its
    /// equations](crate::family::Stated::equations): it has jumped, or the parameters are degenerate.
    Degenerate,
    /// The start point is not a solution of the start system.
    InvalidStart,
    /// The Jacobian is so ill-conditioned that even residuals in double-double do not help.
    AccuracyLimit,
    /// The step size fell below the resolution of `t`.
    StepTooSmall,
    /// The step limit was reached.
    MaxSteps,
    /// The path was not tracked, because the work was cancelled before.
    #[default]
    Cancelled,
}

impl PathEnd {
    /// Whether the path ended well: at a regular solution or at infinity.
    pub fn is_good(self) -> bool {
        matches!(self, PathEnd::Success | PathEnd::AtInfinity)
    }
}

/// The record of one path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PathResult {
    /// Index of the start solution.
    pub path: usize,
    /// Why it ended.
    pub end: PathEnd,
    /// The value of `t` at the end: 0 if the target was reached. Paths in several
    /// [pieces](crate::homotopy::ParameterPath::pieces) also succeed at each `t` where a piece ends.
    pub t: f64,
    /// Size of the last correction relative to the point (weighted maximum norm): a bound on the
    /// relative error.
    pub accuracy: f64,
    /// Estimate of the Lipschitz constant `omega` of Newton's method at the end (a reciprocal
    /// relative length): no other solution lies much nearer than `1 / omega`.
    pub omega: f64,
    /// Smallest pivot of the last Jacobian, with rows and unknowns scaled. Below 2e-16 the Jacobian
    /// is singular as far as doubles can tell, for instance on a component of solutions of positive
    /// dimension.
    pub pivot: f64,
    /// Number of accepted steps.
    pub accepted: usize,
    /// Number of rejected steps.
    pub rejected: usize,
    /// Number of evaluations of the Jacobian, each with a factorisation.
    pub jacobians: usize,
    /// Whether residuals in double-double were used.
    pub extended: bool,
}

impl PathResult {
    /// The record of a path that was not tracked.
    pub(super) fn cancelled(path: usize) -> PathResult {
        PathResult { path, t: 1.0, ..PathResult::default() }
    }
}

/// The records and last points of some paths, in one piece of memory that can be used again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PathSet {
    dimension: usize,
    results: Vec<PathResult>,
    points: Vec<Complex64>,
}

impl PathSet {
    /// An empty set of paths in `dimension` unknowns.
    pub fn new(dimension: usize) -> Self {
        PathSet { dimension, ..Self::default() }
    }

    /// An empty set with room for `paths` paths.
    pub fn with_capacity(dimension: usize, paths: usize) -> Self {
        let (results, points) = (Vec::with_capacity(paths), Vec::with_capacity(paths.saturating_mul(dimension)));
        PathSet { dimension, results, points }
    }

    /// Number of unknowns.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// Number of paths.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// Whether there are no paths.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// The records, in the order in which they were stored.
    pub fn results(&self) -> &[PathResult] {
        &self.results
    }

    /// Last point of the `k`-th record.
    pub fn point(&self, k: usize) -> &[Complex64] {
        &self.points[k * self.dimension..(k + 1) * self.dimension]
    }

    /// The records with their last points.
    pub fn iter(&self) -> impl Iterator<Item = (&PathResult, &[Complex64])> {
        self.results.iter().enumerate().map(|(k, r)| (r, self.point(k)))
    }

    /// Whether the `k`-th path ended at a regular solution that is real: all imaginary parts are below 1e-10 of the
    /// largest coordinate, or of one.
    pub fn is_real(&self, k: usize) -> bool {
        self.results[k].end == PathEnd::Success && is_real(self.point(k), ends::REAL)
    }

    /// Number of paths with this kind of end.
    pub fn count(&self, end: PathEnd) -> usize {
        self.results.iter().filter(|r| r.end == end).count()
    }

    /// Forgets the paths but keeps the memory.
    pub fn clear(&mut self, dimension: usize) {
        self.dimension = dimension;
        self.results.clear();
        self.points.clear();
    }

    /// Adds a path; `point` has one entry per unknown.
    pub fn push(&mut self, result: PathResult, point: impl IntoIterator<Item = Complex64>) {
        self.results.push(result);
        self.points.extend(point);
        debug_assert_eq!(self.points.len(), self.results.len() * self.dimension);
    }

    /// Adds paths in as many unknowns.
    pub(crate) fn append(&mut self, others: &PathSet) {
        debug_assert!(others.is_empty() || others.dimension == self.dimension);
        self.results.extend_from_slice(&others.results);
        self.points.extend_from_slice(&others.points);
    }

    /// Replaces the `k`-th record.
    pub fn replace(&mut self, k: usize, result: PathResult, point: &[Complex64]) {
        self.results[k] = result;
        self.points[k * self.dimension..(k + 1) * self.dimension].copy_from_slice(point);
    }

    /// Replaces the `k`-th record, but not its point.
    pub(crate) fn replace_record(&mut self, k: usize, result: PathResult) {
        self.results[k] = result;
    }

    /// Sorts by the index of the start solution; the records of one path in the order in which they were taken.
    pub fn sort(&mut self) {
        // Mostly these are all numbers up to the largest: each record goes to its place, without
        // more memory.
        for k in 0..self.len() {
            loop {
                let place = self.results[k].path;
                if place == k {
                    break;
                }
                if place >= self.len() || self.results[place].path == place {
                    return self.sort_by_copying();
                }
                self.results.swap(k, place);
                for j in 0..self.dimension {
                    self.points.swap(k * self.dimension + j, place * self.dimension + j);
                }
            }
        }
    }

    fn sort_by_copying(&mut self) {
        let mut order: Vec<usize> = (0..self.len()).collect();
        let result = |k: usize| &self.results[k];
        order.sort_by(|&a, &b| result(a).path.cmp(&result(b).path).then(result(b).t.total_cmp(&result(a).t)));
        let results = order.iter().map(|&k| self.results[k]).collect();
        let points = order.iter().flat_map(|&k| self.point(k).iter().copied()).collect();
        self.results = results;
        self.points = points;
    }
}

#[cfg(test)]
mod tests {
    use super::{PathEnd, PathResult, PathSet};
    use num_complex::Complex64;
    use proptest::prelude::{Just, Strategy, prop, prop_assert, proptest};

    proptest! {
        #[test]
        fn sorted_paths_keep_their_points(paths in numbers()) {
            let mut set = PathSet::new(2);
            for &path in &paths {
                set.push(PathResult::cancelled(path), [1.0, 2.0].map(|z| (z * path as f64).into()));
            }
            set.sort();
            prop_assert!(set.results().is_sorted_by_key(|r| r.path));
            prop_assert!(set.iter().all(|(r, x)| x[0].re == r.path as f64 && x[1].re == 2.0 * r.path as f64));
            let mut sorted = paths;
            sorted.sort_unstable();
            prop_assert!(set.results().iter().map(|r| r.path).eq(sorted));
        }
    }

    /// Relative to coordinates above one; ends that are no solutions are not real.
    #[test]
    fn real_ends_are_regular_and_have_no_imaginary_parts() {
        let mut set = PathSet::new(2);
        let ends = [
            (PathEnd::Success, 1.0, 0.0, true),
            (PathEnd::Success, 1e-3, 9e-11, true),
            (PathEnd::Success, 1e6, 9e-5, true),
            (PathEnd::Success, 1.0, 2e-10, false),
            (PathEnd::Singular, 1.0, 0.0, false),
            (PathEnd::AtInfinity, 1.0, 0.0, false),
        ];
        for (k, &(end, re, im, _)) in ends.iter().enumerate() {
            set.push(PathResult { end, ..PathResult::cancelled(k) }, [Complex64::new(re, im), 0.0.into()]);
        }
        assert!(ends.iter().enumerate().all(|(k, end)| set.is_real(k) == end.3));
    }

    /// All numbers up to some, in any order, or any numbers.
    fn numbers() -> impl Strategy<Value = Vec<usize>> {
        let all = (0usize..40).prop_flat_map(|n| Just((0..n).collect::<Vec<usize>>()).prop_shuffle());
        proptest::prop_oneof![all, prop::collection::vec(0usize..30, 0..30)]
    }
}
