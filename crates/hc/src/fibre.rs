//! Parameter families: from all solutions for one generic parameter point to all solutions for any other.

use crate::distinct::Coincidences;
use crate::homotopy::Segment;
use crate::refine::Refiner;
use crate::tracker::{OptionError, PathEnd, PathResult, PathSet, TrackerOptions, track};
use num_complex::Complex64;
use poly::Evaluate;
use serde::Serialize;

/// The solutions of a family for one parameter point.
#[derive(Clone, Debug, PartialEq)]
pub struct Fibre {
    /// The parameter point.
    pub parameters: Vec<Complex64>,
    /// Number of unknowns `n`.
    pub dimension: usize,
    /// The solutions, `n` coordinates each, one after the other.
    pub solutions: Vec<Complex64>,
}

impl Fibre {
    /// A fibre from pairs `[re, im]`, as generated modules store them: the parameters, and the solutions one after the other.
    pub fn from_pairs(parameters: &[[f64; 2]], dimension: usize, solutions: &[[f64; 2]]) -> Fibre {
        let numbers = |pairs: &[[f64; 2]]| pairs.iter().map(|&[re, im]| Complex64::new(re, im)).collect();
        Fibre { parameters: numbers(parameters), dimension, solutions: numbers(solutions) }
    }

    /// Number of solutions.
    pub fn len(&self) -> usize {
        self.solutions.len().checked_div(self.dimension).unwrap_or(0)
    }

    /// Whether there are no solutions.
    pub fn is_empty(&self) -> bool {
        self.solutions.is_empty()
    }

    /// The `k`-th solution.
    pub fn solution(&self, k: usize) -> &[Complex64] {
        &self.solutions[k * self.dimension..(k + 1) * self.dimension]
    }
}

/// Settings for tracking whole fibres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FibreOptions {
    /// Settings of the tracker in the first pass.
    pub tracker: TrackerOptions,
    /// How often jumped and failed paths are tracked again, each time with steps half as long. Default 4.
    pub retries: u32,
    /// Relative distance below which two endpoints are one point. Default 1e-8.
    pub coincidence: f64,
}

impl Default for FibreOptions {
    fn default() -> Self {
        FibreOptions { tracker: TrackerOptions::default(), retries: 4, coincidence: 1e-8 }
    }
}

impl FibreOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        self.tracker.validate()?;
        OptionError::positive(&[("coincidence", self.coincidence)])
    }
}

/// How the paths of a fibre ended; `tracked` is the sum of the next four.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PathCounts {
    /// Paths tracked, one a start solution.
    pub tracked: usize,
    /// Paths that ended at a regular solution of their own.
    pub finite: usize,
    /// Paths that are shown to diverge.
    pub at_infinity: usize,
    /// Paths that ended otherwise, those included that still share their end with another.
    pub failed: usize,
    /// Paths given up on request: because they would hardly become real ([`crate::tracker::TrackerOptions::drop_complex`]), or since
    /// all solutions are known ([`crate::solve::SolveOptions::known`]).
    pub dropped: usize,
    /// How many tracks were run a second time or more often.
    pub retracked: usize,
}

/// Tracks all solutions of a fibre to the parameters `target`, on the threads of the current rayon pool.
///
/// Regular endpoints that coincide prove that a path has jumped: all paths that share an end, and all that failed, are tracked
/// again with stricter steps. What is still not whole afterwards is counted as failed.
///
/// # Panics
/// If the system is not square or `target` or the fibre do not fit it.
pub fn track_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
) -> (PathSet, PathCounts) {
    let path = Segment::new(&fibre.parameters, target);
    let run = |which: &[usize], tracker: &TrackerOptions| {
        let mut paths = track(system, &path, &fibre.solutions, which, tracker);
        settle(&mut Refiner::new(system), target, &mut paths);
        paths
    };
    let mut which: Vec<usize> = (0..fibre.len()).collect();
    let mut paths = run(&which, &options.tracker);
    let mut retracked = 0;
    for level in 1..=options.retries {
        which = doubtful(&paths, options.coincidence);
        if which.is_empty() || options.tracker.monitor.is_cancelled() {
            break;
        }
        retracked += which.len();
        for (result, point) in run(&which, &options.tracker.stricter(level)).iter() {
            if result.end.is_good() || !paths.results()[result.path].end.is_good() {
                paths.replace(result.path, *result, point);
            }
        }
    }
    let lost = doubtful(&paths, options.coincidence).len();
    let at_infinity = paths.count(PathEnd::AtInfinity);
    let dropped = paths.count(PathEnd::Dropped);
    let counts = PathCounts {
        tracked: fibre.len(),
        finite: fibre.len() - at_infinity - lost - dropped,
        at_infinity,
        failed: lost,
        dropped,
        retracked,
    };
    (paths, counts)
}

/// The whole fibre at other parameters, every solution refined to the last digit; `None` if a path was lost.
///
/// # Panics
/// As [`track_fibre`].
pub fn move_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
) -> Option<Fibre> {
    let (ends, counts) = track_fibre(system, fibre, target, options);
    let mut refiner = Refiner::new(system);
    (counts.finite == fibre.len()).then(|| Fibre {
        parameters: target.to_vec(),
        dimension: fibre.dimension,
        solutions: ends.iter().flat_map(|(_, x)| refiner.refine(target, x).point).collect(),
    })
}

/// Ends that are known to fewer digits than this are refined before they are compared: the error that is left is the square of the last
/// correction, times the Lipschitz constant of Newton's method.
const VAGUE: f64 = 1e-7;
/// After that the last correction must be below this.
const SETTLED: f64 = 1e-10;

/// Coordinates below this share of the largest, squared, are zero or suspicious.
const VANISHED_SQR: f64 = 1e-32;

/// Whether a path with this record has come to a regular solution `x` (one entry an unknown) for the parameters `target` (one entry a
/// parameter).
///
/// A system may have components of singular solutions besides its fibre, and Newton's method converges to them too, slowly, which does not show where
/// coordinates vanish. Ends with such coordinates or a singular Jacobian have to attract it from some distance, if need be in
/// double-double.
pub fn ends_regularly<E: Evaluate>(
    refiner: &mut Refiner<'_, E>,
    target: &[Complex64],
    result: &PathResult,
    x: &[Complex64],
) -> bool {
    let largest = x.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    let plain = || result.pivot > f64::EPSILON && x.iter().all(|z| z.norm_sqr() > VANISHED_SQR * largest);
    let mut attracts = || refiner.contracts(target, x) || refiner.contracts_precisely(target, x);
    result.end == PathEnd::Success && (plain() || attracts())
}

/// Refines the regular ends that the tracker leaves vague, so that those which coincide are seen to; where Newton's method does not settle,
/// or the end is no regular solution, the path becomes [`PathEnd::Singular`].
pub fn settle<E: Evaluate>(refiner: &mut Refiner<'_, E>, target: &[Complex64], paths: &mut PathSet) {
    let mut refined = std::mem::take(&mut refiner.spare);
    for k in 0..paths.len() {
        let result = paths.results()[k];
        if result.end != PathEnd::Success {
            continue;
        }
        if !ends_regularly(refiner, target, &result, paths.point(k)) {
            paths.replace_record(k, PathResult { end: PathEnd::Singular, ..result });
        } else if result.accuracy > VAGUE {
            refiner.refine_into(target, paths.point(k), &mut refined);
            let end = if refined.accuracy <= SETTLED { PathEnd::Success } else { PathEnd::Singular };
            paths.replace(k, PathResult { end, accuracy: refined.accuracy, ..result }, &refined.point);
        }
    }
    refiner.spare = refined;
}

/// Paths that failed or share a regular end with another, by index of their start solutions: what has to be tracked again.
///
/// `paths` must hold the paths `0 .. len` in order.
pub fn doubtful(paths: &PathSet, tolerance: f64) -> Vec<usize> {
    let mut which = Vec::new();
    doubtful_into(paths, tolerance, &mut Coincidences::default(), &mut which);
    which
}

/// [`doubtful`] with the memory of an earlier call.
pub fn doubtful_into(paths: &PathSet, tolerance: f64, memory: &mut Coincidences, which: &mut Vec<usize>) {
    which.clear();
    let results = paths.results();
    let regular = (0..paths.len()).filter(|&k| results[k].end == PathEnd::Success);
    memory.members(regular, |k| paths.point(k), tolerance, which);
    which.iter_mut().for_each(|k| *k = results[*k].path);
    which.extend(results.iter().filter(|r| !r.end.is_good()).map(|r| r.path));
    which.sort_unstable();
    which.dedup();
}
