//! What the end of a path is: a regular solution, an isolated multiple solution, a point on a set
//! of positive dimension, or no solution.

use super::deflate::{DeflatedPoint, Profile, Reduced, deflated, distance, ending};
use super::dual::{Count, count};
use super::eliminate::{Elimination, PivotLimit};
use super::equations::{ExactEquations, LocalEquations, Precision};
use super::kinds::{Effort, LocalStructure, UnresolvedReason, residual};
use super::many_digits::{Consistency, consistency};
use super::number::{Number, largest};
use super::rational::at_rational;
use super::sheet::{leads_on_somewhere, on_sheet};
use crate::distinct::relative_distance;
use crate::tolerances::structure;
use num_complex::Complex64;
use poly::{ComplexDd, ComplexMulti};
use std::cell::LazyCell;

/// Orders of the series that are tried.
const ORDERS: [usize; 16] = [2, 3, 4, 5, 6, 7, 8, 11, 16, 23, 32, 45, 64, 90, 128, 180];
/// Functionals are counted up to at least this number, whatever the number of paths, and up to the
/// second number where the point may be isolated with more functionals.
const FUNCTIONALS: usize = 12;
const MANY_FUNCTIONALS: usize = 80;
/// Where more paths than this end, what double-double takes for a set of positive dimension may be a solution
/// of high multiplicity.
const FEW: usize = 3;

/// The local structure at a point near which `paths` paths end. As far as is known, the relative error
/// of the point is at most `error`. At most `most` paths may end at any one point.
pub(crate) fn local_structure(
    given: &ExactEquations,
    point: &[Complex64],
    paths: usize,
    most: usize,
    error: f64,
    effort: Effort,
) -> LocalStructure {
    if point.iter().any(|z| !z.is_finite()) {
        return LocalStructure::Unresolved(UnresolvedReason::NoSolution);
    }
    let error = if error.is_finite() { error.abs() } else { structure::NEAR_SINGULAR };
    if is_no_solution(given, point, error) {
        return LocalStructure::NotASolution;
    }
    let rational = LazyCell::new(|| at_rational(given, point, error, most));
    let is_on_component = |found: &LocalStructure| matches!(found, LocalStructure::OnComponent { .. });
    // In this order, as far as one tells something. A rational point on a component counts only where more
    // digits show no regular solution, and no sheet that the path has rather come to.
    let attempts: [&dyn Fn() -> Option<LocalStructure>; 7] = [
        &|| regular_from(&given.near_within::<ComplexDd>(point, structure::OWN_UNITS), given, point, error),
        &|| rational.clone().filter(|found| !is_on_component(found)),
        &|| regular::<ComplexMulti<4>>(given, point, error),
        &|| sheet(given, point, paths, error),
        &|| rational.clone(),
        &|| regular::<ComplexMulti<8>>(given, point, error),
        &|| on_axes(given, point, error),
    ];
    if let Some(structure) = attempts.iter().find_map(|attempt| attempt()) {
        return structure;
    }
    let mut why = UnresolvedReason::NoSolution;
    // Zeros of one precision may be small numbers of the next.
    let mut before = None;
    let ways = [multiple::<ComplexDd>, multiple::<ComplexMulti<4>>, multiple::<ComplexMulti<8>>];
    let ways = &ways[..if effort == Effort::Little { 2 } else { 3 }];
    let mut left: Vec<usize> = (0..ways.len()).rev().collect();
    while let Some(way) = left.pop() {
        if given.is_exhausted() {
            return LocalStructure::Unresolved(UnresolvedReason::TooMuch);
        }
        match ways[way](given, point, paths, most, effort) {
            Ok(LocalStructure::Isolated { multiplicity, .. }) if before != Some(multiplicity) => {
                (before, why) = (Some(multiplicity), UnresolvedReason::Unclear);
            }
            // High powers of small numbers are zero up to the highest precision, which is next.
            Ok(LocalStructure::OnComponent { .. }) if paths > FEW && way + 1 < ways.len() => {
                why = UnresolvedReason::Unclear;
                left.reverse();
            }
            Ok(structure) => return structure,
            Err(reason) => why = reason,
        }
        if why == UnresolvedReason::TooLarge && point.len() > 1 {
            break;
        }
    }
    if effort == Effort::Little || given.is_exhausted() {
        return LocalStructure::Unresolved(why);
    }
    // Some regular solutions show only with very many digits.
    regular::<ComplexMulti<16>>(given, point, error).unwrap_or(LocalStructure::Unresolved(why))
}

/// Whether equations are too large at the end of a path for a solution nearby.
fn is_no_solution(given: &ExactEquations, point: &[Complex64], error: f64) -> bool {
    // A term changes by as many times the relative change of a point as its degree.
    let degree = given.degree() as f64;
    let local =
        given.near_within::<ComplexDd>(point, (1e3 * error).clamp(structure::SURELY_ZERO, structure::NEAR_SINGULAR));
    local.residual(&local.scaled(point)).exp2() > structure::NOT_ZERO.max(1e3 * degree * error).min(0.5)
}

/// Whether the given equations move a regular solution of rounded ones by more than its own
/// rounding error, or do not determine it.
pub(crate) fn is_moved(given: &ExactEquations, point: &[Complex64]) -> bool {
    let near = given.near::<ComplexDd>(point);
    let x = near.scaled(point);
    // Values need all digits, derivatives few, unless the Jacobian is nearly singular.
    let rough = near.rounded();
    let (_, jacobian) = rough.jacobian(&rough.scaled(point));
    let values: Vec<Complex64> = near.values(&x).iter().map(Number::to_c64).collect();
    let corrected = newton(&rough.scaled(point), &values, jacobian, structure::PLAIN_PIVOT)
        .map(|x| rough.unscaled(&x))
        .or_else(|| {
            let (values, jacobian) = near.jacobian(&x);
            let x = newton(&x, &values, jacobian, structure::FAINT_PIVOT)?;
            Some(near.unscaled(&x).iter().map(Number::to_c64).collect())
        });
    // Written so that what is no number is moved.
    !corrected.is_some_and(|corrected| relative_distance(point, &corrected) <= structure::STEADY)
}

/// A step of Newton's method, if all pivots of the Jacobian are larger than `smallest` (a logarithm to
/// base 2).
fn newton<S: Number>(x: &[S], values: &[S], jacobian: Vec<Vec<S>>, smallest: f64) -> Option<Vec<S>> {
    let pivots = Elimination::new(jacobian, x.len(), PivotLimit::Below(f64::NEG_INFINITY));
    (pivots.rank() == x.len() && pivots.smallest > smallest).then(|| pivots.newton_step(x, values))
}

/// The regular solution near a point, if there is one that numbers of this precision show.
fn regular<S: Precision>(given: &ExactEquations, point: &[Complex64], error: f64) -> Option<LocalStructure> {
    regular_from(&given.near::<S>(point), given, point, error)
}

/// The regular solution near a point, by the equations near it.
fn regular_from<S: Precision>(
    local: &LocalEquations<'_, S>,
    given: &ExactEquations,
    point: &[Complex64],
    error: f64,
) -> Option<LocalStructure> {
    let start = local.scaled(point);
    let found = deflated(local, &start, 1, f64::NEG_INFINITY, &mut Vec::new())?;
    if !found.profile.is_regular()
        || distance(&start, &found.point) > structure::NEAR.max(structure::NEAR_ERRORS * error).log2()
    {
        return None;
    }
    let (point, residual) = rounded(given, local, &found.point);
    // Digits that show a solution need not show that an equation more is not zero there.
    let consistency = if given.len() > point.len() { consistency(given, &point) } else { Consistency::Solves };
    Some(match consistency {
        Consistency::Solves => LocalStructure::Regular { point, residual },
        Consistency::Misses => LocalStructure::NotASolution,
        Consistency::Unclear => LocalStructure::Unresolved(UnresolvedReason::Unclear),
    })
}

/// A point on a set of positive dimension at the end of a path. The path seemed to lead to a
/// regular solution nearby, but another path leads to that solution.
pub(crate) fn on_set_nearby(
    given: &ExactEquations,
    point: &[Complex64],
    paths: usize,
    error: f64,
) -> Option<LocalStructure> {
    sheet(given, point, paths, error.max(structure::NEAR_SHEET_AT_MOST / structure::NEAR_SHEET_ERRORS))
}

/// The local structure at a point that can be moved along a set of solutions.
fn sheet(given: &ExactEquations, point: &[Complex64], paths: usize, error: f64) -> Option<LocalStructure> {
    if point.len() == 1 {
        return None;
    }
    let near =
        structure::NEAR_SHEET.max(structure::NEAR_SHEET_ERRORS * error).min(structure::NEAR_SHEET_AT_MOST).log2();
    let found = sheet_in::<ComplexDd>(given, point, paths, near)?;
    // High powers of small numbers are zero but in many digits.
    if paths > FEW { sheet_in::<ComplexMulti<8>>(given, point, paths, near) } else { Some(found) }
}

/// [`sheet`] in one precision.
fn sheet_in<S: Precision>(
    given: &ExactEquations,
    point: &[Complex64],
    paths: usize,
    near: f64,
) -> Option<LocalStructure> {
    let local = given.near::<S>(point);
    let point = on_sheet(&local, &local.scaled(point), paths, near)?;
    Some(LocalStructure::OnComponent { point: rounded(given, &local, &point).0, is_exact: false })
}

/// Logarithms of the tolerances at which ranks are read off, from what is clear in this precision on.
fn rank_tolerances<S: Number>() -> impl Iterator<Item = f64> {
    let finest = structure::CLEAR * S::BITS;
    let finer = (0..).map(move |k| finest + structure::FINER_RANKS * f64::from(k));
    finer.take_while(|&tolerance| tolerance < structure::RANKS[0]).chain(structure::RANKS)
}

/// The local structure at a point that is not a regular solution, in one precision. An error if the
/// precision is not enough, or, with little effort, if the point lies between several solutions.
fn multiple<S: Precision>(
    given: &ExactEquations,
    point: &[Complex64],
    paths: usize,
    most: usize,
    effort: Effort,
) -> Result<LocalStructure, UnresolvedReason> {
    let local = given.near::<S>(point);
    let start = local.scaled(point);
    let limit = (2 * paths + 2).max(FUNCTIONALS);
    if let Some(structure) = at_zeros(&local, &start, limit) {
        return Ok(structure);
    }
    let mut why = UnresolvedReason::NoSolution;
    for order in ORDERS.into_iter().take_while(|&order| order <= 2 * limit) {
        // What is told by the highest order counts.
        why = if why == UnresolvedReason::TooLarge { UnresolvedReason::Unclear } else { why };
        let mut tried: Vec<Profile> = Vec::new();
        for tolerance in rank_tolerances::<S>() {
            if given.is_exhausted() {
                return Err(UnresolvedReason::TooMuch);
            }
            let found = match ending(&local, &start, order, tolerance, &mut tried) {
                Some((found, true)) => found,
                Some(_) if effort == Effort::Little => return Err(UnresolvedReason::NoSolution),
                _ => continue,
            };
            if found.profile.is_regular() || distance(&start, &found.point) > structure::NEAR_SINGULAR.log2() {
                continue;
            }
            match by_series(&local, &found, order, limit, most) {
                Ok(multiplicity) => {
                    let (point, residual) = rounded(given, &local, &found.point);
                    return Ok(match multiplicity {
                        Some(multiplicity) => {
                            LocalStructure::Isolated { multiplicity, point, residual, is_exact: false }
                        }
                        None => LocalStructure::OnComponent { point, is_exact: false },
                    });
                }
                Err(UnresolvedReason::Unclear) if why == UnresolvedReason::TooLarge => {}
                Err(reason) => why = reason,
            }
        }
    }
    Err(why)
}

/// The local structure at a point with zeros in place of small coordinates, if one of the small ones may
/// take any value, whatever the nonzero coordinates are.
fn on_axes(given: &ExactEquations, point: &[Complex64], error: f64) -> Option<LocalStructure> {
    let small =
        structure::NEAR_SHEET_AT_MOST.max(structure::NEAR_SHEET_ERRORS * error).min(structure::NEAR_SINGULAR).log2();
    let local = given.near::<ComplexDd>(point);
    let start = local.scaled(point);
    let mut zero: Vec<bool> = start.iter().map(|z| z.log2() < small).collect();
    for j in 0..zero.len() {
        // A coordinate stays free if the other zeros suffice.
        zero[j] = zero[j] && {
            zero[j] = false;
            !given.vanish_where(&zero)
        };
    }
    let freed = |(z, zero): (&ComplexDd, &bool)| !zero && z.log2() < small;
    if !start.iter().zip(&zero).any(freed) {
        return None;
    }
    let kept = point.iter().zip(&zero).map(|(z, &zero)| if zero { Complex64::default() } else { *z });
    Some(LocalStructure::OnComponent { point: kept.collect(), is_exact: true })
}

/// The local structure if zeros in place of small coordinates give an exact solution, which needs no
/// refinement.
fn at_zeros<S: Number>(local: &LocalEquations<'_, S>, start: &[S], limit: usize) -> Option<LocalStructure> {
    let snapped: Vec<S> =
        start.iter().map(|z| if z.log2() < structure::NEAR_SINGULAR.log2() { S::zero() } else { *z }).collect();
    let (values, jacobian) = local.jacobian(&snapped);
    if !values.iter().all(Number::vanishes) {
        return None;
    }
    let pivots = Elimination::new(jacobian, snapped.len(), PivotLimit::Below(structure::ZERO * S::BITS));
    if pivots.smallest < structure::CLEAR * S::BITS || pivots.rank() == snapped.len() {
        return None;
    }
    for order in ORDERS {
        let reduced = Reduced::new(local, &snapped, &pivots, order)?;
        if let Count::All(multiplicity) = count(&reduced.basis, &reduced.equations, 4 * limit) {
            let point = local.unscaled(&snapped).iter().map(Number::to_c64).collect();
            return Some(LocalStructure::Isolated { multiplicity, point, residual: 0.0, is_exact: false });
        }
    }
    None
}

/// The multiplicity of a refined solution, as far as series up to an order tell; `None` if it lies on a
/// component. An error if ranks are not clear, or more orders are needed.
fn by_series<S: Number>(
    local: &LocalEquations<'_, S>,
    found: &DeflatedPoint<S>,
    order: usize,
    limit: usize,
    most: usize,
) -> Result<Option<usize>, UnresolvedReason> {
    let (_, jacobian) = local.jacobian(&found.point);
    let pivots = Elimination::new(jacobian, found.point.len(), PivotLimit::After(found.profile.ranks[0]));
    let reduced = Reduced::new(local, &found.point, &pivots, order).ok_or(UnresolvedReason::TooLarge)?;
    let counted = |bound: usize| {
        let functionals = count(&reduced.basis, &reduced.equations, bound);
        let many =
            if let Count::All(found) = functionals { found } else { bound.min(reduced.basis.count(order)) } as f64;
        let n = reduced.basis.variables() as f64;
        local.spend(order as f64 * (n * many).powi(2) * (0.5 * n + 1.0) * many / 3.0);
        functionals
    };
    let mut functionals = counted(limit);
    if functionals == Count::More {
        if leads_on_somewhere(local, found, order, limit) {
            return Ok(None);
        }
        // More paths may end at an isolated solution than do nearby.
        let bound = most.saturating_add(1).clamp(limit, MANY_FUNCTIONALS.max(4 * limit));
        functionals = if bound > limit { counted(bound) } else { functionals };
        if functionals == Count::More {
            return if bound > most { Ok(None) } else { Err(UnresolvedReason::TooLarge) };
        }
    }
    match functionals {
        Count::Unclear => Err(UnresolvedReason::Unclear),
        Count::All(multiplicity) if found.profile.remaining == 0 => Ok(Some(multiplicity)),
        Count::All(_) | Count::More | Count::Unfinished => Err(UnresolvedReason::TooLarge),
    }
}

/// A point as doubles, and the values of the equations there relative to their terms.
pub(super) fn rounded<S: Number>(
    given: &ExactEquations,
    local: &LocalEquations<'_, S>,
    point: &[S],
) -> (Vec<Complex64>, f64) {
    // Imaginary parts that are rounding errors of many digits are zero.
    let is_real =
        largest(&point.iter().map(|z| S::sub(z, &z.conjugate())).collect::<Vec<_>>()) < structure::ZERO * S::BITS;
    let real = |z: Complex64| if is_real { Complex64::from(z.re) } else { z };
    let point: Vec<Complex64> = local.unscaled(point).iter().map(|z| real(z.to_c64())).collect();
    let residual = residual(given, &point);
    (point, residual)
}

#[cfg(test)]
#[path = "local_structure_tests.rs"]
mod tests;
