//! Points on sets of positive dimension, recognised in little time: such a point can be moved along
//! the set.

use super::deflate::{DeflatedPoint, Profile, deflated, distance, moved, settled};
use super::eliminate::{Elimination, PivotLimit};
use super::equations::LocalEquations;
use super::number::Number;
use crate::random::{Random, Stream};
use crate::tolerances::structure;

const MOVES: u32 = 3;

/// A solution on a set of positive dimension near `start`, at a distance of at most `near` (a
/// logarithm to base 2).
///
/// The point is refined with the ranks that are seen there, and moved along the solutions of the
/// same ranks. Near an isolated solution at which at most `paths` paths end, the equations are about as
/// large as the power `paths` of the distance, or larger: too large for the moved point to count.
/// `None` tells nothing.
pub(crate) fn on_sheet<S: Number>(
    local: &LocalEquations<'_, S>,
    start: &[S],
    paths: usize,
    near: f64,
) -> Option<Vec<S>> {
    let leads_on = |found: &DeflatedPoint<S>, order: usize| {
        let near = !found.profile.is_regular() && distance(start, &found.point) <= near;
        near && if found.profile.remaining == 0 {
            is_touched(local, &found.point, paths)
        } else {
            leads_on_somewhere(local, found, order, paths)
        }
    };
    for rank in ranks(local, start) {
        let profile = Profile { ranks: vec![rank], remaining: start.len() - rank };
        let found = settled(local, start.to_vec(), 1, &profile, f64::INFINITY);
        if let Some(found) = found.filter(|found| leads_on(found, 1)) {
            return Some(found.point);
        }
    }
    let mut tried = Vec::new();
    let mut found = structure::SHEET_RANKS.iter().filter_map(|&(order, tolerance)| {
        deflated(local, start, order, tolerance, &mut tried).filter(|found| leads_on(found, order))
    });
    found.next().map(|found| found.point)
}

/// Ranks that the Jacobian may have at a point of a reduced set nearby, the highest first.
fn ranks<S: Number>(local: &LocalEquations<'_, S>, start: &[S]) -> Vec<usize> {
    let (_, jacobian) = local.jacobian(start);
    let sizes = Elimination::new(jacobian, start.len(), PivotLimit::Below(structure::CLEAR * S::BITS)).sizes;
    let others = |rank: usize| sizes.get(rank).copied().unwrap_or(f64::NEG_INFINITY);
    (1..=sizes.len().min(start.len() - 1)).rev().filter(|&rank| others(rank) <= structure::DOUBTFUL_PIVOT).collect()
}

/// Most paths at a point for which [`is_touched`] tells something: near an isolated solution of higher
/// multiplicity, the equations are too small at the least distance.
const FEW: usize = 3;
const STARTS: usize = 20;
/// Dimensions of sets that are sought.
const DIMENSIONS: usize = 2;

/// Whether a solution lies on a reduced set although ranks are lower there than nearby, for example
/// where a curve crosses itself: at all distances there are solutions of a common rank. False tells
/// nothing.
fn is_touched<S: Number>(local: &LocalEquations<'_, S>, point: &[S], paths: usize) -> bool {
    if paths > FEW {
        return false;
    }
    let variables = point.len();
    let mut random = Random::of(0, Stream::Beside);
    let mut is_beside = |dimension: usize, away: f64| {
        let profile = Profile { ranks: vec![variables - dimension], remaining: dimension };
        (0..STARTS).any(|_| {
            let start: Vec<S> = point.iter().map(|z| S::add(z, &S::from_c64(random.unit() * away.exp2()))).collect();
            settled(local, start, 1, &profile, f64::INFINITY).is_some_and(|found| {
                let reached = distance(point, &found.point);
                (away - 5.0..away + 3.0).contains(&reached)
                    && local.residual(&found.point) <= structure::UNSEEN * S::BITS
            })
        })
    };
    (1..=DIMENSIONS.min(variables - 1)).any(|d| structure::DISTANCES.iter().all(|&away| is_beside(d, away)))
}

/// Whether solutions of the same ranks lead on from this one; if it is isolated, its multiplicity is at
/// most `multiplicity`.
pub(crate) fn leads_on_somewhere<S: Number>(
    local: &LocalEquations<'_, S>,
    found: &DeflatedPoint<S>,
    order: usize,
    multiplicity: usize,
) -> bool {
    // The distance that is reached, to the power of the multiplicity, must be visible.
    let is_visible = |stride: f64| multiplicity as f64 * stride.log2() > structure::VISIBLE * S::BITS;
    structure::STRIDES.iter().any(|&stride| is_visible(stride) && leads_on(local, found, order, stride))
}

/// Whether the point can be moved by some strides, each to another solution of the same ranks.
fn leads_on<S: Number>(local: &LocalEquations<'_, S>, found: &DeflatedPoint<S>, order: usize, stride: f64) -> bool {
    let mut point = found.point.clone();
    for _ in 0..MOVES {
        let Some(next) = moved(local, &point, order, &found.profile, stride) else { return false };
        let way = distance(&point, &next);
        if !(way >= stride.log2() - 3.0 && way <= stride.log2() + 3.0)
            || local.residual(&next) > structure::UNSEEN * S::BITS
        {
            return false;
        }
        point = next;
    }
    distance(&found.point, &point) > stride.log2() - 1.0
}
