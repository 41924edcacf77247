//! Two equations in two unknowns by elimination, for use where paths fail: slower, but exact until
//! the very end.
//!
//! After a change of coordinates `u = x + t y`, the roots of the resultant with respect to `y` are
//! the `u` of all solutions, with their multiplicities (van der Waerden, Modern Algebra, section
//! 83). Two such changes give both coordinates.

use crate::singular;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero, pow};
use poly::{ComplexMulti, Exact, Monomial, Polynomial, Scalar};

/// Systems of more paths are left to these.
const PATHS: usize = 150;
/// Pairs of changes of coordinates, the next where one does not tell all solutions apart.
const CHANGES: [[i32; 2]; 3] = [[3, -5], [7, -4], [11, -9]];
/// What is left of an equation at a solution, relative to its terms, at most, and how much more it is
/// at any other pair of roots: logarithms to base 2.
const SOLVES: f64 = -100.0;
const CLEARER: f64 = 16.0;

/// Numbers of 77 digits, for solutions that paths do not tell.
pub(super) type Digits = ComplexMulti<4>;

/// The value of a term.
pub(super) fn term(monomial: &Monomial, c: &Exact, point: &[Digits]) -> Digits {
    let powers = monomial.exponents().iter().zip(point);
    powers.fold(Digits::from_exact(c), |product, (&e, z)| (0..e).fold(product, |product, _| Digits::mul(&product, z)))
}

/// All roots of a polynomial in one unknown to many digits, with their multiplicities, if they are all
/// clear.
pub(super) fn roots(polynomial: &Polynomial<Exact>) -> Option<Vec<(Digits, usize)>> {
    let found = singular::roots_with_multiplicities(polynomial, 0)?;
    let count: usize = found.iter().map(|(_, multiplicity)| multiplicity).sum();
    let digits = |(root, multiplicity): ([_; 3], usize)| {
        (root.iter().fold(Digits::zero(), |sum, &part| Digits::add(&sum, &Digits::from_c64(part))), multiplicity)
    };
    (i64::try_from(count).ok() == polynomial.degree()).then(|| found.into_iter().map(digits).collect())
}

/// All common roots of two polynomials in two unknowns to many digits, with their multiplicities, if
/// they are few, isolated and clear.
pub(super) fn points(polynomials: &[Polynomial<Exact>]) -> Option<Vec<(Vec<Digits>, usize)>> {
    let [f, g] = polynomials else { return None };
    let equations = [integers(f)?, integers(g)?];
    CHANGES.iter().find_map(|changes| changed(&equations, polynomials, changes))
}

/// A polynomial in two unknowns, times a common denominator; `None` if coefficients are not real or
/// exponents negative.
fn integers(polynomial: &Polynomial<Exact>) -> Option<Polynomial<BigInt>> {
    let denominator = polynomial.terms().iter().fold(BigInt::one(), |product, (_, c)| {
        let next = BigRational::new(product.clone(), c.re.denom().clone());
        product * next.denom()
    });
    let term = |(monomial, c): &(Monomial, Exact)| {
        let polynomial = c.im.is_zero() && monomial.exponents().iter().all(|&e| e >= 0);
        polynomial.then(|| (monomial.clone(), (&c.re * &denominator).to_integer()))
    };
    let terms: Vec<(Monomial, BigInt)> = polynomial.terms().iter().map(term).collect::<Option<_>>()?;
    (polynomial.variables() == 2).then(|| Polynomial::from_terms(2, terms))
}

/// The same by these changes of coordinates.
fn changed(
    equations: &[Polynomial<BigInt>; 2],
    polynomials: &[Polynomial<Exact>],
    changes: &[i32; 2],
) -> Option<Vec<(Vec<Digits>, usize)>> {
    let [first, second] = changes.map(|t| roots(&eliminated(equations, t)?));
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
        if size > SOLVES || next < size + CLEARER || std::mem::replace(&mut taken[k], true) {
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

/// The resultant with respect to `y` of the equations in `x = u - t y`; `None` where it is zero or too
/// large, or the change of coordinates is not a general one.
fn eliminated(equations: &[Polynomial<BigInt>; 2], t: i32) -> Option<Polynomial<Exact>> {
    let degree = |equation: &Polynomial<BigInt>| usize::try_from(equation.degree()?).ok();
    let [d, e] = [degree(&equations[0])?, degree(&equations[1])?];
    let paths = d.checked_mul(e).filter(|paths| (1..=PATHS).contains(paths))?;
    let [u, y]: [Polynomial<BigInt>; 2] = [0, 1].map(|k| Polynomial::variable(2, k));
    let x = &u - &y.scaled(&BigInt::from(t));
    let [f, g] = [equations[0].substitute(0, &x)?, equations[1].substitute(0, &x)?];
    let mut values = Vec::with_capacity(paths + 1);
    for u in 0..=paths {
        let [f, g] = [line(&f, u, d), line(&g, u, e)];
        if f.len() != d + 1 || g.len() != e + 1 {
            return None;
        }
        values.push(resultant(f, g));
    }
    // Newton's divided differences at integers, of integers.
    let mut whole = Polynomial::zero(1);
    for order in 1..=paths {
        for k in (order..=paths).rev() {
            values[k] = &values[k] - &values[k - 1];
        }
    }
    let real = |q: BigRational| Exact { re: q, im: BigRational::zero() };
    let u: Polynomial<Exact> = Polynomial::variable(1, 0);
    let mut factorial = (1..=paths).fold(BigInt::one(), |product, k| product * BigInt::from(k));
    for k in (0..=paths).rev() {
        let place = Polynomial::constant(1, real(BigRational::from_integer(BigInt::from(k))));
        let value = BigRational::new(values[k].clone(), factorial.clone());
        whole = &(&whole * &(&u - &place)) + &Polynomial::constant(1, real(value));
        factorial /= BigInt::from(k.max(1));
    }
    (!whole.is_empty()).then_some(whole)
}

/// A polynomial of a degree in `u` and `y` at a value of `u`, by ascending powers of `y`, the last not
/// zero.
fn line(polynomial: &Polynomial<BigInt>, u: usize, degree: usize) -> Vec<BigInt> {
    let powers: Vec<BigInt> = (0..=degree).map(|e| pow(BigInt::from(u), e)).collect();
    let mut whole = vec![BigInt::zero(); degree + 1];
    for (monomial, c) in polynomial.terms() {
        if let [a, b] = *monomial.exponents() {
            whole[b as usize] += c * &powers[a as usize];
        }
    }
    trimmed(whole)
}

fn trimmed(mut a: Vec<BigInt>) -> Vec<BigInt> {
    while a.last().is_some_and(Zero::is_zero) {
        a.pop();
    }
    a
}

/// The resultant of two polynomials by subresultants (Cohen 1993, A Course in Computational Algebraic
/// Number Theory, algorithm 3.3.7), which stay integers.
fn resultant(mut a: Vec<BigInt>, mut b: Vec<BigInt>) -> BigInt {
    let mut sign = BigInt::one();
    if a.len() < b.len() {
        if a.len().is_multiple_of(2) && b.len().is_multiple_of(2) {
            sign = -sign;
        }
        std::mem::swap(&mut a, &mut b);
    }
    let (mut g, mut h) = (BigInt::one(), BigInt::one());
    while b.len() > 1 {
        let steps = a.len() - b.len();
        if a.len().is_multiple_of(2) && b.len().is_multiple_of(2) {
            sign = -sign;
        }
        let divisor = &g * pow(h.clone(), steps);
        let rest = remainder(a, &b).into_iter().map(|c| c / &divisor).collect();
        a = std::mem::replace(&mut b, rest);
        g = a.last().cloned().unwrap_or_default();
        if steps > 0 {
            h = pow(g.clone(), steps) / pow(h, steps - 1);
        }
    }
    let Some(last) = b.last() else { return BigInt::zero() };
    match a.len() - 1 {
        0 => sign,
        degree => sign * pow(last.clone(), degree) / pow(h, degree - 1),
    }
}

/// The remainder of `a`, times the leading coefficient of `b` to the power of one more than their
/// degrees differ.
fn remainder(mut a: Vec<BigInt>, b: &[BigInt]) -> Vec<BigInt> {
    let Some(leading) = b.last() else { return a };
    while a.len() >= b.len() {
        let (place, Some(last)) = (a.len() - b.len(), a.pop()) else { break };
        for c in &mut a {
            *c *= leading;
        }
        for (c, d) in a[place..].iter_mut().zip(b) {
            *c -= &last * d;
        }
    }
    trimmed(a)
}

#[cfg(test)]
mod tests {
    use super::{eliminated, integers, points, resultant};
    use num_bigint::BigInt;
    use poly::parse::phcpack;
    use proptest::prelude::{prop, prop_assert_eq, proptest};

    proptest! {
        /// The product of the differences of all roots.
        #[test]
        fn resultants_are_those_of_the_roots(
            a in prop::collection::vec(-9i64..9, 0..5),
            b in prop::collection::vec(-9i64..9, 0..5),
            leading in (1i64..5, 1i64..5),
        ) {
            let with = |leading: i64, roots: &[i64]| roots.iter().fold(vec![BigInt::from(leading)], |p, &root| {
                let below = p.iter().map(|c| -c * root).chain([BigInt::ZERO]);
                below.zip(std::iter::once(BigInt::ZERO).chain(p.clone())).map(|(a, b)| a + b).collect()
            });
            let mut want = BigInt::from(leading.0).pow(b.len() as u32) * BigInt::from(leading.1).pow(a.len() as u32);
            for x in &a {
                for y in &b {
                    want *= x - y;
                }
            }
            prop_assert_eq!(resultant(with(leading.0, &a), with(leading.1, &b)), want);
        }
    }

    /// Real and imaginary parts of coordinates with multiplicities, sorted.
    fn found(text: &str) -> Option<Vec<(f64, f64, usize)>> {
        let polynomials = phcpack(text).unwrap().expand(&Default::default()).unwrap();
        let points = points(&polynomials)?;
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
        assert_eq!(found("2\nx*i-1;\ny;"), None);
    }

    #[test]
    fn degrees_are_those_of_finite_solutions() {
        let polynomials = phcpack("2\nx*y-1;\nx+3/4;").unwrap().expand(&Default::default()).unwrap();
        let equations = [integers(&polynomials[0]).unwrap(), integers(&polynomials[1]).unwrap()];
        assert_eq!(eliminated(&equations, 3).unwrap().degree(), Some(1));
    }
}
