//! Sums, products, derivatives and values of polynomials.

use super::terms::{Polynomial, Ring, Terms, accumulate};
use crate::monomial::Monomial;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

impl<R: Ring> Polynomial<R> {
    /// Merges two descending lists of terms; `convert` is applied to the coefficients of the
    /// second.
    fn merged(&self, other: &Polynomial<R>, convert: impl Fn(&R) -> R) -> Polynomial<R> {
        assert_eq!(self.variables, other.variables, "polynomials in equally many unknowns");
        let mut terms = Vec::with_capacity(self.len() + other.len());
        let (mut a, mut b) = (self.terms.iter().peekable(), other.terms.iter().peekable());
        loop {
            let order = match (a.peek(), b.peek()) {
                (Some((m, _)), Some((n, _))) => m.cmp(n),
                (Some(_), None) => Ordering::Greater,
                (None, Some(_)) => Ordering::Less,
                (None, None) => break,
            };
            match order {
                Ordering::Greater => terms.extend(a.next().cloned()),
                Ordering::Less => terms.extend(b.next().map(|(m, c)| (m.clone(), convert(c)))),
                Ordering::Equal => {
                    if let (Some((m, c)), Some((_, d))) = (a.next(), b.next()) {
                        let sum = c.clone() + convert(d);
                        if !sum.is_zero() {
                            terms.push((m.clone(), sum));
                        }
                    }
                }
            }
        }
        Polynomial { variables: self.variables, terms }
    }

    /// The product; `None` if it has more than `limit` terms at some point or an exponent leaves
    /// the range of 32 bits.
    pub(crate) fn checked_mul(&self, other: &Polynomial<R>, limit: usize) -> Option<Polynomial<R>> {
        assert_eq!(self.variables, other.variables, "polynomials in equally many unknowns");
        let mut sum = Terms::default();
        for (m, c) in &self.terms {
            for (n, d) in &other.terms {
                accumulate(&mut sum, m.checked_mul(n)?, c.clone() * d.clone());
            }
            if sum.len() > limit {
                return None;
            }
        }
        Some(Polynomial::from_sum(self.variables, sum))
    }

    /// The derivative by one unknown.
    pub fn derivative(&self, index: usize) -> Polynomial<R> {
        let terms = self.terms.iter().filter_map(|(monomial, c)| {
            let exponent = *monomial.exponents().get(index)?;
            let mut lowered: Monomial = monomial.clone();
            lowered.exponents_mut()[index] = exponent.checked_sub(1)?;
            let c = multiple(c, exponent);
            (!c.is_zero()).then_some((lowered, c))
        });
        // Lowering one exponent everywhere keeps terms distinct, but zero ones are gone: order is
        // kept.
        Polynomial { variables: self.variables, terms: terms.collect() }
    }

    /// The value at a point; `None` if an exponent is negative.
    ///
    /// # Panics
    /// If the point has fewer coordinates than the polynomial has unknowns.
    pub fn evaluate(&self, point: &[R]) -> Option<R> {
        let mut sum = R::zero();
        for (monomial, c) in &self.terms {
            let mut product = c.clone();
            for (&e, x) in monomial.exponents().iter().zip(&point[..self.variables]) {
                product = product * power(x, u32::try_from(e).ok()?);
            }
            sum = sum + product;
        }
        Some(sum)
    }
}

/// `k * c` by doubling.
fn multiple<R: Ring>(c: &R, k: i32) -> R {
    let mut sum = R::zero();
    let magnitude = k.unsigned_abs();
    for bit in (0..u32::BITS - magnitude.leading_zeros()).rev() {
        sum = sum.clone() + sum;
        if magnitude >> bit & 1 == 1 {
            sum = sum + c.clone();
        }
    }
    if k < 0 { -sum } else { sum }
}

/// `x^k` by squaring.
pub(super) fn power<R: Ring>(x: &R, k: u32) -> R {
    let mut value = R::one();
    for bit in (0..u32::BITS - k.leading_zeros()).rev() {
        value = value.clone() * value;
        if k >> bit & 1 == 1 {
            value = value * x.clone();
        }
    }
    value
}

impl<R: Ring> Add for &Polynomial<R> {
    type Output = Polynomial<R>;
    fn add(self, other: &Polynomial<R>) -> Polynomial<R> {
        self.merged(other, R::clone)
    }
}

impl<R: Ring> Sub for &Polynomial<R> {
    type Output = Polynomial<R>;
    fn sub(self, other: &Polynomial<R>) -> Polynomial<R> {
        self.merged(other, |c| -c.clone())
    }
}

impl<R: Ring> Neg for &Polynomial<R> {
    type Output = Polynomial<R>;
    fn neg(self) -> Polynomial<R> {
        self.map(|c| -c.clone())
    }
}

impl<R: Ring> Mul for &Polynomial<R> {
    type Output = Polynomial<R>;
    fn mul(self, other: &Polynomial<R>) -> Polynomial<R> {
        self.checked_mul(other, usize::MAX).expect("exponents of 32 bits")
    }
}
