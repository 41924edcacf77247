//! Solutions that lie so close together that paths end between them: the equations near them, in
//! coordinates in which the solutions are apart.

use super::deflate::{Profile, Reduced, approached, deflated, distance};
use super::eliminate::{Elimination, PivotLimit};
use super::equations::{ExactEquations, LocalEquations};
use super::kinds::{Effort, LocalStructure};
use super::local_structure::{local_structure, rounded};
use super::number::{Number, largest};
use crate::tolerances::clusters;
use num_complex::Complex64;
use num_rational::BigRational;
use num_traits::Zero;
use poly::{ComplexMulti, Exact, Monomial, Polynomial, Scalar};

/// The numbers in which clusters are looked at: 154 digits, of which 77 tell solutions apart.
type ManyDigits = ComplexMulti<8>;

/// Orders of the series that are tried, with logarithms to base 2 of the tolerances at which ranks
/// are read off.
const ORDERS: [usize; 6] = [2, 3, 4, 6, 8, 12];
/// Most unknowns that may be left in the equations of a cluster.
const UNKNOWNS: usize = 5;
/// The series has this many orders more where only one unknown is left.
const SINGLE: usize = 24;

/// The equations near the centre of a cluster, without the unknowns that they determine at once, and
/// in units of its size.
pub(crate) struct ClusterEquations<'a> {
    given: &'a ExactEquations,
    local: LocalEquations<'a, ManyDigits>,
    reduced: Reduced<ManyDigits>,
    /// The logarithm to base 2 of the size.
    size: i64,
    /// The equations in the unknowns that are left, cut off at an order.
    pub(crate) polynomials: Vec<Polynomial<Exact>>,
}

impl<'a> ClusterEquations<'a> {
    /// All ways to look at the cluster near a point, the simplest first: with each way to read off
    /// which unknowns are determined.
    pub(crate) fn all(given: &'a ExactEquations, point: &[Complex64]) -> impl Iterator<Item = ClusterEquations<'a>> {
        let mut tried: Vec<(Profile, usize)> = Vec::new();
        let ways = ORDERS.into_iter().flat_map(|order| clusters::RANKS.map(|tolerance| (order, tolerance)));
        let point = point.to_vec();
        ways.filter_map(move |(order, tolerance)| ClusterEquations::new(given, &point, order, tolerance, &mut tried))
    }

    fn new(
        given: &'a ExactEquations,
        point: &[Complex64],
        order: usize,
        tolerance: f64,
        tried: &mut Vec<(Profile, usize)>,
    ) -> Option<ClusterEquations<'a>> {
        if given.is_exhausted() {
            return None;
        }
        let local = given.near::<ManyDigits>(point);
        let start = local.scaled(point);
        let (last, profile) = approached(&local, &start, order, tolerance, |profile| {
            if profile.remaining > 0 {
                return false;
            }
            let fresh = !profile.is_regular() && !tried.contains(&(profile.clone(), order));
            tried.push((profile.clone(), order));
            fresh
        })?;
        let centre = last.point;
        if distance(&start, &centre) > clusters::NEAR {
            return None;
        }
        let (_, jacobian) = local.jacobian(&centre);
        let pivots = Elimination::new(jacobian, centre.len(), PivotLimit::After(profile.ranks[0]));
        let left = centre.len() - pivots.rank();
        let order = if left == 1 { order + SINGLE } else { order };
        let reduced = (left <= UNKNOWNS).then(|| Reduced::new(&local, &centre, &pivots, order)).flatten()?;
        let size = size(&reduced)?;
        let polynomials: Vec<Polynomial<Exact>> =
            reduced.equations.iter().map(|series| in_units(&reduced, series, size)).collect::<Option<_>>()?;
        (polynomials.len() >= left).then_some(ClusterEquations { given, local, reduced, size, polynomials })
    }

    /// The number of unknowns that are left.
    pub(crate) fn unknowns(&self) -> usize {
        self.reduced.basis.variables()
    }

    /// What the given equations have at solutions of the equations of the cluster, at each of which so
    /// many paths end.
    pub(crate) fn structures<'p>(
        &self,
        solutions: impl Iterator<Item = (&'p Vec<Complex64>, usize)>,
        most: usize,
    ) -> Vec<LocalStructure> {
        let mut regular = Vec::new();
        solutions.filter_map(|(solution, paths)| self.structure(solution, paths, most, &mut regular)).collect()
    }

    /// What the given equations have at a solution at which `paths` paths end; nothing if it is among the
    /// `regular` ones that are known to all digits.
    fn structure(
        &self,
        solution: &[Complex64],
        paths: usize,
        most: usize,
        regular: &mut Vec<Vec<ManyDigits>>,
    ) -> Option<LocalStructure> {
        let unit = |z: &Complex64| ManyDigits::from_c64(*z).shifted(self.size);
        let start = self.reduced.at(&solution.iter().map(unit).collect::<Vec<_>>());
        let found = deflated(&self.local, &start, 1, f64::NEG_INFINITY, &mut Vec::new())
            .filter(|found| found.profile.is_regular())
            .filter(|found| distance(&start, &found.point) <= self.size as f64 + 1.0);
        if let Some(found) = found {
            let is_new = regular.iter().all(|known| distance(known, &found.point) > clusters::SAME);
            return is_new.then(|| {
                let (point, residual) = rounded(self.given, &self.local, &found.point);
                regular.push(found.point);
                LocalStructure::Regular { point, residual }
            });
        }
        let point: Vec<Complex64> = self.local.unscaled(&start).iter().map(Number::to_c64).collect();
        // As accurate as the equations of the cluster are.
        let error = 2f64.powi(2 * self.size as i32);
        let structure = local_structure(self.given, &point, paths, most, error, Effort::Little);
        matches!(structure, LocalStructure::Isolated { .. } | LocalStructure::OnComponent { .. }).then_some(structure)
    }
}

/// The logarithm to base 2 of about how far the solutions of the cluster are from its centre: at that
/// distance, lower terms of some equation are as large as those that are largest further outside. `None`
/// if there is no such distance: the equations have a multiple solution, or no cluster.
fn size(reduced: &Reduced<ManyDigits>) -> Option<i64> {
    let order = reduced.basis.order();
    let mut size = f64::NEG_INFINITY;
    for series in &reduced.equations {
        let sizes: Vec<f64> = (0..=order)
            .map(|k| {
                let from = if k == 0 { 0 } else { reduced.basis.count(k - 1) };
                Some(largest(&series[from..reduced.basis.count(k)]))
                    .filter(|&s| s > clusters::NOISE)
                    .unwrap_or(f64::NEG_INFINITY)
            })
            .collect();
        let outside = |k: &usize| sizes[*k] + *k as f64 * clusters::WIDEST;
        let leading = (0..=order).max_by(|a, b| outside(a).total_cmp(&outside(b)))?;
        for k in 0..leading {
            size = size.max((sizes[k] - sizes[leading]) / (leading - k) as f64);
        }
    }
    (size.is_finite() && size <= clusters::WIDEST).then(|| size.round() as i64)
}

/// An equation in units of a size, without the terms that do not matter.
fn in_units(reduced: &Reduced<ManyDigits>, series: &[ManyDigits], size: i64) -> Option<Polynomial<Exact>> {
    let exponents = reduced.basis.exponents();
    let degree = |k: usize| exponents[k].iter().map(|&e| i64::from(e)).sum::<i64>();
    let scaled: Vec<ManyDigits> = series.iter().enumerate().map(|(k, c)| c.shifted(degree(k) * size)).collect();
    let top = largest(&scaled);
    let kept = scaled.iter().enumerate().filter(|(_, c)| c.log2() > top + clusters::SMALL_TERM);
    let term = |(k, c): (usize, &ManyDigits)| {
        let monomial = Monomial::new(exponents[k].iter().map(|&e| i32::from(e)));
        Some((monomial, exact(&c.shifted(-top.round() as i64))?))
    };
    let terms: Vec<(Monomial, Exact)> = top.is_finite().then(|| kept.map(term).collect()).flatten()?;
    Some(Polynomial::from_terms(reduced.basis.variables(), terms)).filter(|p| p.terms().len() > 1)
}

/// The leading digits of a number of about unit size, exactly.
fn exact(z: &ManyDigits) -> Option<Exact> {
    let (mut rest, mut sum) = (*z, Exact::zero());
    for _ in 0..4 {
        let part = rest.to_c64();
        sum += Exact { re: BigRational::from_float(part.re)?, im: BigRational::from_float(part.im)? };
        rest = ManyDigits::sub(&rest, &ManyDigits::from_c64(part));
    }
    Some(sum)
}
