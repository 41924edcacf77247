//! The eliminant of two polynomials in two unknowns, over integers or modulo a prime.
//!
//! In coordinates `u = x + t y` and `y`, the resultant with respect to `y` is a polynomial in `u`. Its
//! roots are the `u` of all common roots, with the same multiplicities (van der Waerden, Modern
//! Algebra, section 83). It is interpolated: the resultant on each of as many lines `u = 0, 1, 2 ...`
//! as its degree needs.

use crate::singular::{Residue, resultant, trimmed};
use num_bigint::BigInt;
use num_traits::{One, Zero, pow};
use poly::{Exact, Polynomial};
use std::ops::Sub;

/// Coefficients whose resultants are computed without rounding.
pub(super) trait Domain: Clone + Zero + One + Sub<Output = Self> + From<u32> {
    /// The resultant of two polynomials by ascending powers, their last coefficients not zero.
    fn resultant(a: Vec<Self>, b: Vec<Self>) -> Self;
}

/// A term in two unknowns: exponents and coefficient.
type PlaneTerm<T> = ([usize; 2], T);

/// The eliminant of polynomials whose coefficients have images in a domain.
pub(super) struct Eliminant<T> {
    /// The coefficients times [`factor`](Eliminant::factor), by ascending powers, the last not zero.
    pub(super) coefficients: Vec<T>,
    /// The factorial of the product of the degrees; the coefficients are divided by it.
    pub(super) factor: T,
}

impl<T: Domain> Eliminant<T> {
    /// The eliminant of two polynomials after the change of coordinates `x = u - t y`; `None` if it is
    /// zero, if there may be more than `most` common roots, if the change of coordinates is not a
    /// general one, or if a coefficient has no `image` or an exponent is negative.
    pub(super) fn new(
        polynomials: &[Polynomial<Exact>],
        t: &T,
        most: usize,
        image: impl Fn(&Exact) -> Option<T>,
    ) -> Option<Eliminant<T>> {
        let [f, g] = polynomials else { return None };
        let (f, g) = (terms(f, &image)?, terms(g, &image)?);
        let (d, e) = (degree(&f), degree(&g));
        let roots = d.checked_mul(e).filter(|roots| (1..=most).contains(roots))?;
        let value = |u: u32| {
            let [f, g] = [(&f, d), (&g, e)].map(|(terms, degree)| on_line(terms, degree, &T::from(u), t));
            Some(T::resultant(f?, g?))
        };
        interpolated((0..=u32::try_from(roots).ok()?).map(value).collect::<Option<_>>()?)
    }

    /// The degree: the number of common roots, with their multiplicities.
    pub(super) fn degree(&self) -> usize {
        self.coefficients.len().saturating_sub(1)
    }
}

fn terms<T>(polynomial: &Polynomial<Exact>, image: impl Fn(&Exact) -> Option<T>) -> Option<Vec<PlaneTerm<T>>> {
    let term = |exponents: &[i32], c: &Exact| {
        let [a, b] = *exponents else { return None };
        Some(([usize::try_from(a).ok()?, usize::try_from(b).ok()?], image(c)?))
    };
    polynomial.terms().iter().map(|(monomial, c)| term(monomial.exponents(), c)).collect()
}

fn degree<T>(terms: &[PlaneTerm<T>]) -> usize {
    terms.iter().map(|([a, b], _)| a + b).max().unwrap_or(0)
}

/// A polynomial of this degree on the line `x = u - t y`, by ascending powers of `y`; `None` if its
/// degree is less there.
fn on_line<T: Domain>(terms: &[PlaneTerm<T>], degree: usize, u: &T, t: &T) -> Option<Vec<T>> {
    let highest = terms.iter().map(|([a, _], _)| *a).max().unwrap_or(0);
    // By Horner's rule in x.
    let mut whole = vec![T::zero(); degree + 1];
    for a in (0..=highest).rev() {
        for k in (0..=degree).rev() {
            let below = if k > 0 { t.clone() * whole[k - 1].clone() } else { T::zero() };
            whole[k] = u.clone() * whole[k].clone() - below;
        }
        for ([_, b], c) in terms.iter().filter(|([exponent, _], _)| *exponent == a) {
            whole[*b] = whole[*b].clone() + c.clone();
        }
    }
    (!whole[degree].is_zero()).then_some(whole)
}

/// The polynomial with these values at 0, 1, 2 ..., by Newton's divided differences; `None` if it is
/// zero. Times the factorial of the degree it has no denominators.
fn interpolated<T: Domain>(mut values: Vec<T>) -> Option<Eliminant<T>> {
    let n = u32::try_from(values.len()).ok()?;
    for order in 1..values.len() {
        for k in (order..values.len()).rev() {
            values[k] = values[k].clone() - values[k - 1].clone();
        }
    }
    // The difference of order k is divided by k!, that is, multiplied by (k + 1) ... (n - 1).
    let mut factor = T::one();
    let mut whole: Vec<T> = Vec::with_capacity(values.len());
    for (k, value) in (0..n).zip(values).rev() {
        // whole * (u - k) + value
        whole.insert(0, T::zero());
        for j in 1..whole.len() {
            whole[j - 1] = whole[j - 1].clone() - T::from(k) * whole[j].clone();
        }
        whole[0] = whole[0].clone() + value * factor.clone();
        if k > 0 {
            factor = factor * T::from(k);
        }
    }
    let coefficients = trimmed(whole);
    (!coefficients.is_empty()).then_some(Eliminant { coefficients, factor })
}

impl Domain for Residue {
    fn resultant(a: Vec<Residue>, b: Vec<Residue>) -> Residue {
        resultant(a, b)
    }
}

impl Domain for BigInt {
    /// By subresultants (Cohen 1993, A Course in Computational Algebraic Number Theory, algorithm
    /// 3.3.7), which stay integers.
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
    use super::Domain;
    use num_bigint::BigInt;
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
            prop_assert_eq!(BigInt::resultant(with(leading.0, &a), with(leading.1, &b)), want);
        }
    }
}
