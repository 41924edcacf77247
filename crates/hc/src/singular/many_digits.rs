//! Regular solutions to many digits, by the exact coefficients: whether more equations than unknowns are all zero there,
//! and whether the coordinates are real.
//!
//! As many of the equations as there are unknowns determine a regular solution near a point, and Newton's
//! method finds it to any number of digits. Every other equation is then zero there, to as many digits, or it
//! is not; and so is every imaginary part.

use super::deflate::distance;
use super::eliminate::{Elimination, PivotLimit};
use super::equations::{ExactEquations, LocalEquations, Precision};
use super::kinds::residual;
use super::number::{Number, largest};
use crate::tolerances::structure;
use num_complex::Complex64;
use poly::{ComplexDd, ComplexMulti, Scalar};

/// Newton iterations at most: each doubles the digits, of which a double has sixteen.
const ITERATIONS: usize = 16;

/// What more equations than unknowns say of a regular solution of combinations of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Consistency {
    /// All are zero, to three hundred digits.
    Solves,
    /// One is bounded away from zero.
    Misses,
    /// Neither is shown: the equations do not determine the point to enough digits.
    Unclear,
}

/// What the equations, which are more than their unknowns, say of a point that solves combinations of them to all
/// digits of a double.
pub(crate) fn consistency(given: &ExactEquations, point: &[Complex64]) -> Consistency {
    let size = residual(given, point);
    if size.is_nan() || size >= structure::MISSES {
        return Consistency::Misses;
    }
    let Some(rows) = determining(given, point) else { return Consistency::Unclear };
    // What few digits show is not looked at with many.
    if violated::<ComplexDd>(given, point, &rows) == Some(true) {
        return Consistency::Misses;
    }
    match violated::<ComplexMulti<16>>(given, point, &rows) {
        Some(true) => Consistency::Misses,
        Some(false) => Consistency::Solves,
        None => Consistency::Unclear,
    }
}

/// Whether the regular solution near a point is real; `None` if three hundred digits do not show it.
pub(crate) fn is_real(given: &ExactEquations, point: &[Complex64]) -> Option<bool> {
    let Refined { x, error, .. } = refined::<ComplexMulti<16>>(given, point, &determining(given, point)?)?;
    let imaginary: Vec<_> = x.iter().map(|z| Scalar::sub(z, &z.conjugate())).collect();
    Some(largest(&imaginary) <= error + 1.0)
}

/// As many equations as unknowns that determine a solution near the point, by the largest pivots.
fn determining(given: &ExactEquations, point: &[Complex64]) -> Option<Vec<usize>> {
    let near = given.near_within::<ComplexDd>(point, structure::OWN_UNITS);
    let (_, jacobian) = near.jacobian(&near.scaled(point));
    let rows = Elimination::new(jacobian, point.len(), PivotLimit::Below(f64::NEG_INFINITY)).rows;
    (rows.len() == point.len()).then_some(rows)
}

/// Whether some equation is not zero at the solution of the equations `rows` near the point.
fn violated<S: Precision>(given: &ExactEquations, point: &[Complex64], rows: &[usize]) -> Option<bool> {
    let Refined { local, x, error, slope } = refined::<S>(given, point, rows)?;
    Some(local.residual(&x) > error + slope)
}

/// A solution in the units of the equations near it.
struct Refined<'a, S> {
    local: LocalEquations<'a, S>,
    x: Vec<S>,
    /// Logarithms to base 2 of how large its error is at most, and of the slopes of the equations.
    error: f64,
    slope: f64,
}

/// The solution of the equations `rows` near the point. `None` if numbers of this precision do not show it to half of
/// their digits.
fn refined<'a, S: Precision>(given: &'a ExactEquations, point: &[Complex64], rows: &[usize]) -> Option<Refined<'a, S>> {
    let local = given.near_within::<S>(point, structure::OWN_UNITS);
    let start = local.scaled(point);
    let (mut x, mut before) = (start.clone(), f64::INFINITY);
    for _ in 0..ITERATIONS {
        let (values, jacobian) = local.jacobian(&x);
        let matrix: Vec<Vec<S>> = rows.iter().map(|&i| jacobian[i].clone()).collect();
        let side: Vec<S> = rows.iter().map(|&i| values[i]).collect();
        let pivots = Elimination::new(matrix, x.len(), PivotLimit::Below(f64::NEG_INFINITY));
        // What rounding leaves of the values, and of the solution.
        let error = structure::ROUNDED_VALUES - S::BITS - pivots.smallest.min(0.0);
        if pivots.rank() < x.len() || error > -0.5 * S::BITS {
            return None;
        }
        let correction = largest(&pivots.solve(&side));
        x = pivots.newton_step(&x, &side);
        // Written so that what is no number is far away.
        let is_near = distance(&start, &x) <= structure::NEAR.log2();
        if !is_near || correction > before - 1.0 {
            return None;
        }
        if correction <= error {
            let slope = largest(jacobian.iter().flatten()).max(0.0);
            return Some(Refined { local, x, error, slope });
        }
        before = correction;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{Consistency, consistency, is_real};
    use crate::singular::ExactEquations;
    use num_complex::Complex64;

    fn equations(text: &str) -> ExactEquations {
        let system: poly::System = text.parse().unwrap();
        ExactEquations::new(&system.expand(&Default::default()).unwrap(), vec![0; system.variables().len()])
    }

    fn at(text: &str, point: &[f64]) -> Consistency {
        consistency(&equations(text), &point.iter().map(|&x| Complex64::new(x, 0.0)).collect::<Vec<_>>())
    }

    /// The last equation is zero where the others are, or off by as much as it says.
    #[test]
    fn equations_are_as_exact_as_they_are_written() {
        let root = 2f64.sqrt();
        for (third, expected) in [
            ("x*y = 2", Consistency::Solves),
            ("x*y = 2 + 1e-14", Consistency::Misses),
            ("x*y = 2 + 1e-40", Consistency::Misses),
            ("x*y = 2 - 1e-290", Consistency::Misses),
            ("10^18*(x*y - 2) = 1e-12", Consistency::Misses),
            ("10^18*(x*y - 2) = 0", Consistency::Solves),
            ("(10^9*x*y - 2*10^9)^2 = 1e-20", Consistency::Misses),
        ] {
            assert_eq!(at(&format!("x^2 = 2; y = x; {third}"), &[root, root]), expected, "{third}");
        }
        // Coordinates that vanish, and ones of very different size.
        assert_eq!(at("x^2 = x; y^2 = y; x*y = 10^18*(x - 1)*(y - 1) + 1", &[1.0, 1.0]), Consistency::Solves);
        assert_eq!(at("x^2 = x; y^2 = y; x*y = 10^18*(x - 1)*(y - 1) + 1", &[0.0, 1.0]), Consistency::Misses);
        assert_eq!(at("x = 1e-12; y = 1e12; x*y = 1", &[1e-12, 1e12]), Consistency::Solves);
        assert_eq!(at("x = 1e-12; y = 1e12; x*y = 1 + 1e-30", &[1e-12, 1e12]), Consistency::Misses);
    }

    #[test]
    fn what_is_not_determined_is_not_told() {
        assert_eq!(at("(x - 1)^2 = 0; (y - 1)^2 = 0; x = y", &[1.0, 1.0]), Consistency::Unclear);
    }

    /// The roots are those of quadratic equations.
    #[test]
    fn imaginary_parts_are_zero_or_not() {
        let real = |text: &str, re: f64, im: f64| is_real(&equations(text), &[Complex64::new(re, im)]);
        assert_eq!(real("x^2 - 6*x + 9 + 1e-20", 3.0, 1e-10), Some(false));
        assert_eq!(real("x^2 - 6*x + 9 - 1e-20", 3.0 + 1e-10, 1e-18), Some(true));
        assert_eq!(real("x - 3 - 1e-60*i", 3.0, 0.0), Some(false));
        assert_eq!(real("x^3 - 2", 2f64.cbrt(), 1e-17), Some(true));
        assert_eq!(real("(x - 3)^2", 3.0, 0.0), None);
    }
}
