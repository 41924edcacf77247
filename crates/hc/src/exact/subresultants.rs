//! Euclid's algorithm for polynomials whose coefficients are Gaussian integers, without fractions.
//!
//! Remainders are divided by what is known to divide them (Cohen 1993, A Course in Computational Algebraic Number
//! Theory, algorithms 3.3.1 and 3.3.7). Fractions would be reduced after every operation, a hundred times the work.

use crate::singular::trimmed;
use num_bigint::BigInt;
use num_complex::Complex;
use num_rational::BigRational;
use num_traits::{Num, One, Zero, pow};
use poly::Exact;

/// Whole numbers as real and imaginary parts.
pub(super) type Gaussian = Complex<BigInt>;

/// The resultant of two polynomials by ascending powers, their last coefficients not zero.
pub(super) fn resultant(a: &[Gaussian], b: &[Gaussian]) -> Gaussian {
    match (real(a), real(b)) {
        (Some(a), Some(b)) => remainders(a, b).resultant().into(),
        _ => remainders(a.to_vec(), b.to_vec()).resultant(),
    }
}

/// A greatest common divisor of two polynomials, not both zero.
pub(super) fn divisor(a: &[Gaussian], b: &[Gaussian]) -> Vec<Gaussian> {
    match (real(a), real(b)) {
        (Some(a), Some(b)) => remainders(a, b).divisor().into_iter().map(Gaussian::from).collect(),
        _ => remainders(a.to_vec(), b.to_vec()).divisor(),
    }
}

/// The least common denominator of the real and imaginary parts of numbers.
pub(super) fn common_denominator<'a>(numbers: impl Iterator<Item = &'a Exact>) -> BigInt {
    let denominators = numbers.flat_map(|c| [c.re.denom(), c.im.denom()]);
    denominators.fold(BigInt::one(), |common, next| {
        let missing = BigRational::new(common.clone(), next.clone());
        common * missing.denom()
    })
}

/// The real parts, if the imaginary parts are zero: their products take a quarter of the work.
fn real(a: &[Gaussian]) -> Option<Vec<BigInt>> {
    a.iter().map(|c| c.im.is_zero().then(|| c.re.clone())).collect()
}

/// The end of the sequence of remainders.
struct Remainders<T> {
    /// The last one that is no constant, or the constant with which all began.
    last: Vec<T>,
    /// The one after it: a constant, or nothing for zero.
    rest: Vec<T>,
    /// What the resultant is divided by.
    scale: T,
    is_negative: bool,
}

fn remainders<T: Clone + Num>(mut a: Vec<T>, mut b: Vec<T>) -> Remainders<T> {
    let is_odd = |a: &[T], b: &[T]| a.len().is_multiple_of(2) && b.len().is_multiple_of(2);
    let mut is_negative = false;
    if a.len() < b.len() {
        is_negative = is_odd(&a, &b);
        std::mem::swap(&mut a, &mut b);
    }
    let (mut g, mut h) = (T::one(), T::one());
    while b.len() > 1 {
        let steps = a.len() - b.len();
        is_negative ^= is_odd(&a, &b);
        let content = g * pow(h.clone(), steps);
        let rest = remainder(a, &b).into_iter().map(|c| c / content.clone()).collect();
        a = std::mem::replace(&mut b, rest);
        g = a.last().cloned().unwrap_or_else(T::zero);
        if steps > 0 {
            h = pow(g.clone(), steps) / pow(h, steps - 1);
        }
    }
    Remainders { last: a, rest: b, scale: h, is_negative }
}

impl<T: Clone + Num> Remainders<T> {
    fn resultant(self) -> T {
        let Some(rest) = self.rest.into_iter().next() else { return T::zero() };
        let size = match self.last.len().saturating_sub(1) {
            0 => T::one(),
            degree => pow(rest, degree) / pow(self.scale, degree - 1),
        };
        if self.is_negative { T::zero() - size } else { size }
    }

    fn divisor(self) -> Vec<T> {
        if self.rest.is_empty() { self.last } else { vec![T::one()] }
    }
}

/// The remainder of `a`, times the leading coefficient of `b` to the power of one more than their
/// degrees differ.
fn remainder<T: Clone + Num>(mut a: Vec<T>, b: &[T]) -> Vec<T> {
    let Some(leading) = b.last() else { return a };
    while a.len() >= b.len() {
        let (place, Some(last)) = (a.len() - b.len(), a.pop()) else { break };
        for c in &mut a {
            *c = c.clone() * leading.clone();
        }
        for (c, d) in a[place..].iter_mut().zip(b) {
            *c = c.clone() - last.clone() * d.clone();
        }
    }
    trimmed(a)
}

#[cfg(test)]
mod tests {
    use super::{Gaussian, divisor, resultant};
    use num_traits::{One, Zero, pow};
    use proptest::prelude::{prop, prop_assert_eq, proptest};

    fn number((re, im): (i64, i64)) -> Gaussian {
        Gaussian::new(re.into(), im.into())
    }

    /// The polynomial with this leading coefficient and these roots.
    fn with(leading: &Gaussian, roots: &[Gaussian]) -> Vec<Gaussian> {
        roots.iter().fold(vec![leading.clone()], |p, root| {
            let below = p.iter().map(|c| -(c * root)).chain([Gaussian::zero()]);
            below.zip(std::iter::once(Gaussian::zero()).chain(p.clone())).map(|(a, b)| a + b).collect()
        })
    }

    proptest! {
        /// The product of the differences of all roots; of the common roots, each as often as in both.
        #[test]
        fn resultants_and_divisors_are_those_of_the_roots(
            a in prop::collection::vec((-9i64..9, -2i64..3), 0..5),
            b in prop::collection::vec((-9i64..9, -2i64..3), 0..5),
            common in prop::collection::vec((-3i64..4, 0i64..2), 1..3),
            leading in ((1i64..5, 0i64..2), (1i64..5, -1i64..1)),
            is_real: bool,
        ) {
            let of = |roots: &[(i64, i64)]| -> Vec<Gaussian> {
                roots.iter().map(|&(re, im)| number((re, if is_real { 0 } else { im }))).collect()
            };
            let (a, b, common) = (of(&a), of(&b), of(&common));
            let leading = [leading.0, leading.1].map(|(re, im)| number((re, if is_real { 0 } else { im })));
            let mut want = pow(leading[0].clone(), b.len()) * pow(leading[1].clone(), a.len());
            for x in &a {
                for y in &b {
                    want *= x - y;
                }
            }
            prop_assert_eq!(resultant(&with(&leading[0], &a), &with(&leading[1], &b)), want);
            let [long, other] = [[&a[..], &common].concat(), [&b[..], &common].concat()];
            prop_assert_eq!(resultant(&with(&leading[0], &long), &with(&leading[1], &other)), Gaussian::zero());
            // What both have, counted with multiplicity.
            let mut left = other.clone();
            let shared: Vec<Gaussian> = long
                .iter()
                .filter(|x| left.iter().position(|y| y == *x).map(|k| left.swap_remove(k)).is_some())
                .cloned()
                .collect();
            let found = divisor(&with(&leading[0], &long), &with(&leading[1], &other));
            let scale = found.last().unwrap().clone();
            prop_assert_eq!(found, with(&scale, &shared));
            prop_assert_eq!(divisor(&with(&leading[0], &long), &[Gaussian::one()]).len(), 1);
        }
    }
}
