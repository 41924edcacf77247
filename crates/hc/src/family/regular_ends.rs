//! Which ends of tracked paths are regular solutions, and which are doubtful.

use crate::distinct::Coincidences;
use crate::refine::Refiner;
use crate::tolerances::FAMILIES;
use crate::tracker::{PathEnd, PathResult, PathSet};
use num_complex::Complex64;
use poly::Evaluate;

/// Whether a path with this record has reached a regular solution `x` (one entry per unknown) for
/// the parameters `target` (one entry per parameter).
///
/// A system may have components of singular solutions besides its fibre. Newton's method converges
/// to them too, slowly, and this does not show where coordinates vanish. Newton's method must
/// therefore return to an end with such coordinates, or with a singular Jacobian, from some
/// distance, if need be in double-double.
pub(super) fn ends_regularly<E: Evaluate>(
    refiner: &mut Refiner<'_, E>,
    target: &[Complex64],
    result: &PathResult,
    x: &[Complex64],
) -> bool {
    let largest = x.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    let plain = || result.pivot > f64::EPSILON && x.iter().all(|z| z.norm_sqr() > FAMILIES.vanished_sqr * largest);
    let mut attracts = || refiner.contracts(target, x) || refiner.contracts_precisely(target, x);
    result.end == PathEnd::Success && (plain() || attracts())
}

/// Refines the regular ends that the tracker leaves vague, so that coinciding ends can be
/// recognised. Where Newton's method does not settle, or the end is not a regular solution, the
/// path becomes [`PathEnd::Singular`].
pub(super) fn settle<E: Evaluate>(refiner: &mut Refiner<'_, E>, target: &[Complex64], paths: &mut PathSet) {
    let mut refined = std::mem::take(&mut refiner.spare);
    for k in 0..paths.len() {
        let result = paths.results()[k];
        if result.end != PathEnd::Success {
            continue;
        }
        if !ends_regularly(refiner, target, &result, paths.point(k)) {
            paths.replace_record(k, PathResult { end: PathEnd::Singular, ..result });
        } else if result.accuracy > FAMILIES.vague {
            refiner.refine_into(target, paths.point(k), &mut refined);
            let end = if refined.accuracy <= FAMILIES.settled { PathEnd::Success } else { PathEnd::Singular };
            paths.replace(k, PathResult { end, accuracy: refined.accuracy, ..result }, &refined.point);
        }
    }
    refiner.spare = refined;
}

/// Writes to `which` the paths that failed or share a regular end with another path, by the index
/// of their start solutions. These have to be tracked again.
///
/// `paths` must hold the paths `0 .. len` in order.
pub(super) fn doubtful(paths: &PathSet, tolerance: f64, memory: &mut Coincidences, which: &mut Vec<usize>) {
    which.clear();
    let results = paths.results();
    let regular = (0..paths.len()).filter(|&k| results[k].end == PathEnd::Success);
    memory.members(regular, |k| paths.point(k), tolerance, which);
    for k in which.iter_mut() {
        *k = results[*k].path;
    }
    which.extend(results.iter().filter(|r| !r.end.is_good()).map(|r| r.path));
    which.sort_unstable();
    which.dedup();
}
