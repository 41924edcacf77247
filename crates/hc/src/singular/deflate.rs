//! Newton's method for singular solutions: deflation by elimination.
//!
//! Pivots of the Jacobian that are clearly not zero at a point near a solution tell which unknowns
//! the equations determine as power series in the other unknowns. What remains are equations in
//! these few unknowns (Lyapunov and Schmidt's reduction), whose linear part vanishes at the
//! solution. Their derivatives therefore vanish there too, and take their place. This gives a
//! system of smaller multiplicity (the deflation of Leykin, Verschelde & Zhao 2006, with minors in
//! place of new unknowns as in Hauenstein, Mourrain & Szanto 2017). The process may end with a
//! system that determines all unknowns, on which Newton's method doubles digits. Or it ends with a
//! system that is zero to the order at hand: the solution then lies on a set of positive dimension.

use super::eliminate::{Elimination, PivotLimit};
use super::equations::LocalEquations;
use super::number::{Number, largest};
use super::series::Basis;
use crate::tolerances::structure;
use num_complex::Complex64;

/// How many unknowns each level of a deflation determines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Profile {
    /// The ranks, level by level.
    pub(crate) ranks: Vec<usize>,
    /// How many unknowns no level determines.
    pub(crate) remaining: usize,
}

impl Profile {
    /// Whether this is the profile of a regular solution: all unknowns are determined at once.
    pub(crate) fn is_regular(&self) -> bool {
        self.remaining == 0 && self.ranks.len() == 1
    }
}

/// Most iterations; if they converge, corrections get small at once.
const ITERATIONS: usize = 14;
/// So many corrections may shrink by less than a factor of four.
const SLOW: usize = 4;
/// More equations than this are replaced by a basis of the space they span.
const MANY: usize = 24;

/// How ranks are decided.
#[derive(Clone, Copy)]
enum RankRule<'a> {
    /// Pivots of this size (logarithm to base 2) or less count as zero.
    Tolerance(f64),
    /// The ranks of this profile.
    Known(&'a Profile),
}

impl RankRule<'_> {
    fn stop(self, level: usize) -> PivotLimit {
        match self {
            RankRule::Tolerance(size) => PivotLimit::Below(size),
            RankRule::Known(profile) => PivotLimit::After(profile.ranks.get(level).copied().unwrap_or(0)),
        }
    }
}

/// Where a step of the iteration leads.
pub(crate) struct DeflatedPoint<S> {
    /// In the units of the local equations.
    pub(crate) point: Vec<S>,
    pub(crate) profile: Profile,
    /// The logarithm to base 2 of the smallest pivot.
    accepted: f64,
    /// The logarithm to base 2 of the largest number that was taken as zero.
    rejected: f64,
}

impl<S: Number> DeflatedPoint<S> {
    /// Whether the point solves the equations and what was taken as zero is clearly zero.
    fn is_solution(&self, local: &LocalEquations<'_, S>) -> bool {
        let clear = self.accepted >= structure::CLEAR * S::BITS && self.rejected <= structure::ZERO * S::BITS;
        clear && local.residual(&self.point) <= structure::SOLVED * S::BITS
    }
}

/// Finds the solution near `start` with the profile that pivots above `tolerance` (a logarithm to
/// base 2) show there, by series up to `order`; `None` if there is none to which the iteration
/// converges as Newton's method does, or the profile was `tried` before.
pub(crate) fn deflated<S: Number>(
    local: &LocalEquations<'_, S>,
    start: &[S],
    order: usize,
    tolerance: f64,
    tried: &mut Vec<Profile>,
) -> Option<DeflatedPoint<S>> {
    ending(local, start, order, tolerance, tried).filter(|(_, solves)| *solves).map(|(found, _)| found)
}

/// Where the iteration of [`deflated`] ends, and whether that is a solution: if it is not, it is a point
/// that the equations determine, between several solutions.
pub(crate) fn ending<S: Number>(
    local: &LocalEquations<'_, S>,
    start: &[S],
    order: usize,
    tolerance: f64,
    tried: &mut Vec<Profile>,
) -> Option<(DeflatedPoint<S>, bool)> {
    let is_new = |profile: &Profile| {
        let is_new = !tried.contains(profile);
        if is_new {
            tried.push(profile.clone());
        }
        is_new
    };
    let (last, profile) = approached(local, start, order, tolerance, is_new)?;
    let solves = last.is_solution(local);
    (solves || profile.remaining == 0).then_some((last, solves))
}

/// Iterates with the ranks of a profile, after a first correction of size `before`.
pub(crate) fn settled<S: Number>(
    local: &LocalEquations<'_, S>,
    point: Vec<S>,
    order: usize,
    profile: &Profile,
    before: f64,
) -> Option<DeflatedPoint<S>> {
    iterated(local, point, order, profile, before).filter(|last| last.is_solution(local))
}

/// The last step of the iteration from `start`, with the profile that pivots above `tolerance` (a
/// logarithm to base 2) show there, if that is `wanted`. Where the profile determines all unknowns, the
/// equations of the deflation vanish there: it is the centre of the solutions around it, if these are
/// several.
pub(super) fn approached<S: Number>(
    local: &LocalEquations<'_, S>,
    start: &[S],
    order: usize,
    tolerance: f64,
    wanted: impl FnOnce(&Profile) -> bool,
) -> Option<(DeflatedPoint<S>, Profile)> {
    let first = step(local, start, order, RankRule::Tolerance(tolerance)).filter(|first| wanted(&first.profile))?;
    let before = distance(start, &first.point);
    Some((iterated(local, first.point, order, &first.profile, before)?, first.profile))
}

/// The last step of an iteration that converges as Newton's method does.
fn iterated<S: Number>(
    local: &LocalEquations<'_, S>,
    mut point: Vec<S>,
    order: usize,
    profile: &Profile,
    mut before: f64,
) -> Option<DeflatedPoint<S>> {
    let mut slow = 0;
    for _ in 0..ITERATIONS {
        if local.given.is_exhausted() {
            return None;
        }
        let next = step(local, &point, order, RankRule::Known(profile))?;
        let correction = distance(&point, &next.point);
        point = next.point;
        // Corrections shrink fast once they are small on the scale on which solutions lie apart.
        slow += usize::from(correction > before - 2.0);
        if correction.is_nan() || correction > 2.0 || slow > SLOW {
            return None;
        }
        before = correction;
        if correction <= structure::CONVERGED * S::BITS {
            return step(local, &point, order, RankRule::Known(profile));
        }
    }
    None
}

/// The solution of the same profile to which the iteration leads from a point `stride` away, in a
/// direction in which the linear parts of the equations do not change; `None` if it does not
/// converge to one.
pub(crate) fn moved<S: Number>(
    local: &LocalEquations<'_, S>,
    point: &[S],
    order: usize,
    profile: &Profile,
    stride: f64,
) -> Option<Vec<S>> {
    let (_, jacobian) = local.jacobian(point);
    let pivots = Elimination::new(jacobian, point.len(), PivotLimit::After(profile.ranks[0]));
    let mut direction = vec![S::zero(); point.len()];
    for (k, vector) in pivots.null_space().iter().enumerate() {
        // Phases without a pattern.
        let factor = S::from_c64(Complex64::from_polar(1.0, 2.0 + 2.4 * k as f64));
        for (sum, z) in direction.iter_mut().zip(vector) {
            *sum = S::mul_add(&factor, z, sum);
        }
    }
    let size = largest(&direction);
    if !size.is_finite() {
        return None;
    }
    let factor = S::from_c64(Complex64::new(stride * (-size).exp2(), 0.0));
    let start = point.iter().zip(&direction).map(|(x, d)| S::mul_add(&factor, d, x)).collect();
    Some(settled(local, start, order, profile, f64::INFINITY)?.point)
}

/// The logarithm to base 2 of the largest difference of coordinates.
pub(crate) fn distance<S: Number>(a: &[S], b: &[S]) -> f64 {
    let differences: Vec<S> = a.iter().zip(b).map(|(a, b)| S::sub(a, b)).collect();
    largest(&differences)
}

fn step<S: Number>(
    local: &LocalEquations<'_, S>,
    x: &[S],
    order: usize,
    ranks: RankRule<'_>,
) -> Option<DeflatedPoint<S>> {
    let (values, jacobian) = local.jacobian(x);
    let pivots = Elimination::new(jacobian, x.len(), ranks.stop(0));
    let mut profile = Profile { ranks: vec![pivots.rank()], remaining: 0 };
    let mut accepted = pivots.smallest;
    if pivots.rank() == x.len() {
        let point = pivots.newton_step(x, &values);
        return Some(DeflatedPoint { point, profile, accepted, rejected: f64::NEG_INFINITY });
    }
    let mut rejected = pivots.rest;
    if order == 1 {
        // Nothing but the linear part: what it does not determine stays.
        let point = pivots.newton_step(x, &values);
        rejected = rejected.max(local.residual(&point));
        profile.remaining = x.len() - pivots.rank();
        return Some(DeflatedPoint { point, profile, accepted, rejected });
    }
    let reduced = Reduced::new(local, x, &pivots, order)?;
    let mut levels: Vec<(Basis, Vec<Vec<S>>)> = Vec::new();
    let mut basis = Basis::new(reduced.basis.variables(), order)?;
    let mut equations = reduced.equations.clone();
    rejected = rejected.max(largest(equations.iter().filter_map(|e| e.first())));
    let mut left = order;
    let shift = loop {
        // The linear part of the equations is zero at the solution: their derivatives take their
        // place, divided so that the derivatives of powers are binomials.
        let variables = basis.variables();
        let part = 1.0 / (order - left + 1) as f64;
        let slope = |e: &Vec<S>, j: usize| basis.derivative(e, j).iter().map(|z| S::scale(z, part)).collect::<Vec<S>>();
        equations = equations.iter().flat_map(|e| (0..variables).map(move |j| slope(e, j))).collect();
        left -= 1;
        let size = largest(equations.iter().flatten());
        let ends = match ranks {
            RankRule::Tolerance(limit) => size <= limit || left == 0,
            RankRule::Known(profile) => levels.len() + 1 >= profile.ranks.len(),
        };
        if ends || left == 0 {
            profile.remaining = variables;
            rejected = rejected.max(size);
            break vec![S::zero(); variables];
        }
        if equations.len() > MANY {
            equations = independent(equations);
        }
        let level = levels.len() + 1;
        let linear: Vec<Vec<S>> = equations.iter().map(|e| e[1..=variables].to_vec()).collect();
        let pivots = Elimination::new(linear, variables, ranks.stop(level));
        profile.ranks.push(pivots.rank());
        accepted = accepted.min(pivots.smallest);
        if pivots.rank() == variables {
            let values: Vec<S> = equations.iter().map(|e| e[0]).collect();
            let mut shift = vec![S::zero(); variables];
            for (&j, d) in pivots.columns.iter().zip(pivots.solve(&values)) {
                shift[j] = S::neg(&d);
            }
            break shift;
        }
        rejected = rejected.max(pivots.rest);
        let inner = Basis::new(variables - pivots.rank(), left)?;
        let (map, others) = implicit(&basis, &equations, &pivots, &inner, left);
        rejected = rejected.max(largest(others.iter().filter_map(|e| e.first())));
        levels.push((std::mem::replace(&mut basis, inner), map));
        equations = others;
    };
    let mut point = shift;
    for k in (0..levels.len()).rev() {
        let inner = levels.get(k + 1).map_or(&basis, |(basis, _)| basis);
        point = levels[k].1.iter().map(|series| inner.value(series, &point)).collect();
    }
    let point = reduced.at(&point);
    Some(DeflatedPoint { point, profile, accepted, rejected })
}

/// The given equations near a point, with the unknowns that they determine as series in the others.
pub(crate) struct Reduced<S> {
    pub(crate) basis: Basis,
    /// All unknowns as series in the differences of the others from the point.
    unknowns: Vec<Vec<S>>,
    /// The equations that are left.
    pub(crate) equations: Vec<Vec<S>>,
}

impl<S: Number> Reduced<S> {
    /// The point at these values of the unknowns that are left.
    pub(super) fn at(&self, left: &[S]) -> Vec<S> {
        self.unknowns.iter().map(|series| self.basis.value(series, left)).collect()
    }

    /// `None` if there are too many coefficients. `pivots` are those of the Jacobian at `x`.
    pub(crate) fn new(
        local: &LocalEquations<'_, S>,
        x: &[S],
        pivots: &Elimination<S>,
        order: usize,
    ) -> Option<Reduced<S>> {
        let free = pivots.free();
        let basis = Basis::new(free.len(), order)?;
        let mut unknowns: Vec<Vec<S>> = x.iter().map(|&z| basis.constant(z, order)).collect();
        for (k, &j) in free.iter().enumerate() {
            if order > 0 {
                unknowns[j][basis.variable(k)] = S::one();
            }
        }
        // Every round gains an order, and as many digits of the lower ones as the point is known
        // to.
        for round in 0..=order {
            if pivots.rank() == 0 {
                break;
            }
            let values = local.series(&pivots.rows, &basis, &unknowns, round.max(1).min(order));
            correct(&mut unknowns, &values, pivots);
        }
        let others: Vec<usize> = (0..local.given.len()).filter(|i| !pivots.rows.contains(i)).collect();
        let equations = local.series(&others, &basis, &unknowns, order);
        Some(Reduced { basis, unknowns, equations })
    }
}

/// Solves equations in series over `basis` for the unknowns of the pivots of their linear part:
/// these unknowns as series over `inner` in the others, and the equations that are left.
fn implicit<S: Number>(
    basis: &Basis,
    equations: &[Vec<S>],
    pivots: &Elimination<S>,
    inner: &Basis,
    order: usize,
) -> (Vec<Vec<S>>, Vec<Vec<S>>) {
    let mut map: Vec<Vec<S>> = vec![inner.constant(S::zero(), order); basis.variables()];
    for (k, &j) in pivots.free().iter().enumerate() {
        map[j][inner.variable(k)] = S::one();
    }
    let chosen: Vec<Vec<S>> = pivots.rows.iter().map(|&i| equations[i].clone()).collect();
    if pivots.rank() > 0 {
        for round in 0..=order {
            let values = basis.composed(&chosen, inner, &map, round.max(1));
            correct(&mut map, &values, pivots);
        }
    }
    let others = (0..equations.len()).filter(|i| !pivots.rows.contains(i)).map(|i| equations[i].clone());
    let others = basis.composed(&others.collect::<Vec<_>>(), inner, &map, order);
    (map, others)
}

/// Subtracts from the unknowns of the pivots the solution of the linear part for these values of the
/// pivots' equations, each of which is a series.
fn correct<S: Number>(unknowns: &mut [Vec<S>], values: &[Vec<S>], pivots: &Elimination<S>) {
    let length = values.first().map_or(0, Vec::len);
    let height = pivots.rows.iter().max().map_or(0, |m| m + 1);
    for place in 0..length {
        let mut side = vec![S::zero(); height];
        for (&i, series) in pivots.rows.iter().zip(values) {
            side[i] = series[place];
        }
        for (&j, d) in pivots.columns.iter().zip(pivots.solve(&side)) {
            unknowns[j][place] = S::sub(&unknowns[j][place], &d);
        }
    }
}

/// Some of the equations that span the same space as all, as far as digits tell.
fn independent<S: Number>(equations: Vec<Vec<S>>) -> Vec<Vec<S>> {
    let width = equations.first().map_or(0, Vec::len);
    let pivots = Elimination::new(equations.clone(), width, PivotLimit::Below(-0.8 * S::BITS));
    let mut rows = pivots.rows;
    rows.sort_unstable();
    rows.into_iter().map(|i| equations[i].clone()).collect()
}
