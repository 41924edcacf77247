//! The eliminant of two polynomials in two unknowns, over Gaussian integers or modulo a prime.
//!
//! In coordinates `u = x + t y` and `y`, the resultant with respect to `y` is a polynomial in `u`. Its
//! roots are the `u` of all common roots, with the same multiplicities (van der Waerden, Modern
//! Algebra, section 83). It is interpolated: the resultant on each of as many lines `u = 0, 1, 2 ...`
//! as its degree needs.

use super::subresultants::{self, Gaussian};
use crate::singular::{Residue, resultant, trimmed};
use num_bigint::BigInt;
use num_traits::{One, Zero};
use poly::{Exact, Polynomial};
use std::ops::Sub;

/// Coefficients whose resultants are computed without rounding.
pub(super) trait Domain: Clone + Zero + One + Sub<Output = Self> {
    /// A whole number.
    fn whole(number: u32) -> Self;

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
            let [f, g] = [(&f, d), (&g, e)].map(|(terms, degree)| on_line(terms, degree, &T::whole(u), t));
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
            whole[j - 1] = whole[j - 1].clone() - T::whole(k) * whole[j].clone();
        }
        whole[0] = whole[0].clone() + value * factor.clone();
        if k > 0 {
            factor = factor * T::whole(k);
        }
    }
    let coefficients = trimmed(whole);
    (!coefficients.is_empty()).then_some(Eliminant { coefficients, factor })
}

impl Domain for Residue {
    fn whole(number: u32) -> Residue {
        Residue::from(number)
    }

    fn resultant(a: Vec<Residue>, b: Vec<Residue>) -> Residue {
        resultant(a, b)
    }
}

impl Domain for Gaussian {
    fn whole(number: u32) -> Gaussian {
        BigInt::from(number).into()
    }

    fn resultant(a: Vec<Gaussian>, b: Vec<Gaussian>) -> Gaussian {
        subresultants::resultant(&a, &b)
    }
}
