//! Two equations in two unknowns by elimination, for use where paths fail: slower, but exact until
//! the very end.
//!
//! The roots of an [eliminant](Eliminant) after a change of coordinates `u = x + t y` are the `u` of
//! all solutions, with their multiplicities. Two such changes give both coordinates.

use super::eliminant::Eliminant;
use super::roots::{Digits, roots_with_multiplicities};
use super::subresultants::{Gaussian, common_denominator};
use crate::tolerances::structure;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use poly::{Exact, Monomial, Polynomial, Scalar};

/// Systems of more paths are left to these.
const PATHS: usize = 150;
/// Pairs of changes of coordinates, the next where one does not tell all solutions apart.
const CHANGES: [[i32; 2]; 3] = [[3, -5], [7, -4], [11, -9]];

/// The value of a term.
pub(super) fn term(monomial: &Monomial, c: &Exact, point: &[Digits]) -> Digits {
    let powers = monomial.exponents().iter().zip(point);
    powers.fold(Digits::from_exact(c), |product, (&e, z)| (0..e).fold(product, |product, _| Digits::mul(&product, z)))
}

/// All common roots of two polynomials in two unknowns to many digits, with their multiplicities, if
/// they are few, isolated and clear.
pub(super) fn points(polynomials: &[Polynomial<Exact>], seed: u64) -> Option<Vec<(Vec<Digits>, usize)>> {
    let equations: Vec<Polynomial<Exact>> = polynomials.iter().map(without_denominators).collect();
    CHANGES.iter().find_map(|changes| changed(&equations, polynomials, changes, seed))
}

/// A polynomial times a common denominator of its coefficients.
fn without_denominators(polynomial: &Polynomial<Exact>) -> Polynomial<Exact> {
    let denominator = common_denominator(polynomial.terms().iter().map(|(_, c)| c));
    polynomial.scaled(&Exact { re: denominator.into(), im: BigRational::zero() })
}

/// The common roots by these changes of coordinates.
fn changed(
    equations: &[Polynomial<Exact>],
    polynomials: &[Polynomial<Exact>],
    changes: &[i32; 2],
    seed: u64,
) -> Option<Vec<(Vec<Digits>, usize)>> {
    let [first, second] = changes.map(|t| roots_with_multiplicities(&eliminated(equations, t)?, seed));
    let (first, second) = (first?, second?);
    let [t, s] = changes.map(f64::from);
    let mut taken = vec![false; second.len()];
    let mut points = Vec::new();
    for (u, multiplicity) in first {
        // The root of the other change that makes a solution of it.
        let mut ways: Vec<(f64, usize, Vec<Digits>)> = Vec::new();
        for (k, (v, other)) in second.iter().enumerate() {
            let scaled = |z: &Digits, factor: f64| Digits::scale(z, factor);
            let below = Digits::from_c64((s - t).into());
            let x = Digits::div(&Digits::sub(&scaled(&u, s), &scaled(v, t)), &below);
            let y = Digits::div(&Digits::sub(v, &u), &below);
            let point = vec![x, y];
            if *other == multiplicity {
                ways.push((left(polynomials, &point), k, point));
            }
        }
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        let next = ways.get(1).map_or(f64::INFINITY, |way| way.0);
        let (size, k, point) = ways.into_iter().next()?;
        if size > structure::PLANE_SOLVES
            || next < size + structure::PLANE_CLEARER
            || std::mem::replace(&mut taken[k], true)
        {
            return None;
        }
        points.push((point, multiplicity));
    }
    taken.iter().all(|&t| t).then_some(points)
}

/// The largest value of an equation at a point relative to its terms, as a logarithm to base 2.
fn left(polynomials: &[Polynomial<Exact>], point: &[Digits]) -> f64 {
    let of = |polynomial: &Polynomial<Exact>| {
        let terms: Vec<Digits> = polynomial.terms().iter().map(|(monomial, c)| term(monomial, c, point)).collect();
        let largest = terms.iter().map(|z| z.log2()).fold(f64::NEG_INFINITY, f64::max);
        let value = terms.iter().fold(Digits::zero(), |sum, z| Digits::add(&sum, z));
        if largest == f64::NEG_INFINITY { largest } else { value.log2() - largest }
    };
    // Exact zeros are not clearer than others.
    polynomials.iter().map(of).fold(f64::NEG_INFINITY, f64::max).max(-250.0)
}

/// The eliminant of the equations after the change of coordinates `x = u - t y`; `None` where it is
/// zero or too large, or the change of coordinates is not a general one.
fn eliminated(equations: &[Polynomial<Exact>], t: i32) -> Option<Polynomial<Exact>> {
    let is_whole = |c: &Exact| c.re.is_integer() && c.im.is_integer();
    let whole = |c: &Exact| is_whole(c).then(|| Gaussian::new(c.re.to_integer(), c.im.to_integer()));
    let Eliminant { coefficients, factor } = Eliminant::new(equations, &BigInt::from(t).into(), PATHS, whole)?;
    // The factor is real.
    let exact =
        |c: Gaussian| Exact::new(BigRational::new(c.re, factor.re.clone()), BigRational::new(c.im, factor.re.clone()));
    let terms = (0..).zip(coefficients).map(|(exponent, c)| (Monomial::new([exponent]), exact(c)));
    Some(Polynomial::from_terms(1, terms))
}

#[cfg(test)]
mod tests {
    use super::{eliminated, points, without_denominators};
    use poly::parse::phcpack;

    /// Real and imaginary parts of coordinates with multiplicities, sorted.
    fn found(text: &str) -> Option<Vec<(f64, f64, usize)>> {
        let polynomials = phcpack(text).unwrap().expand(&Default::default()).unwrap();
        let points = points(&polynomials, 0)?;
        let mut all: Vec<_> = points.iter().map(|(p, m)| (p[0].to_c64().re, p[1].to_c64().re, *m)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        Some(all)
    }

    #[test]
    fn points_with_multiplicities() {
        assert_eq!(found("2\n(x-1)^2*(x+2);\ny-x^2+1/2;").unwrap(), [(-2.0, 3.5, 1), (1.0, 0.5, 2)]);
        // Two circles: others are at infinity.
        assert_eq!(found("2\nx^2+y^2-25;\n(x-6)^2+y^2-25;").unwrap(), [(3.0, -4.0, 1), (3.0, 4.0, 1)]);
        let curve = "(x-y+1-5*(3*x-4*y+4)^2)";
        let sixfold = found(&format!("2\n{curve};\n(3*x-4*y+4)^6+{curve}*(x+2*y-3);")).unwrap();
        assert_eq!(sixfold, [(0.0, 1.0, 6)]);
        assert_eq!(found("2\nx*y;\nx*(y-1);"), None);
        assert_eq!(found("2\nx*i-1;\ny;").unwrap(), [(0.0, 0.0, 1)]);
        // x^2 = 2 i, y = i x: 1 + i, i - 1, and their opposites, where the curves touch.
        let touching = "2\n(y-i*x)^2;\nx^2+(2-i)*(y-i*x)-2*i;";
        assert_eq!(found(touching).unwrap(), [(-1.0, 1.0, 2), (1.0, -1.0, 2)]);
    }

    #[test]
    fn degrees_are_those_of_finite_solutions() {
        let polynomials = phcpack("2\nx*y-1;\nx+3/4;").unwrap().expand(&Default::default()).unwrap();
        let equations: Vec<_> = polynomials.iter().map(without_denominators).collect();
        assert_eq!(eliminated(&equations, 3).unwrap().degree(), Some(1));
    }
}
