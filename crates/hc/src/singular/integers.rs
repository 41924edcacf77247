//! Resultants of polynomials with integer coefficients.

use super::eliminant::{Domain, trimmed};
use num_bigint::BigInt;
use num_traits::{One, Zero, pow};

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
