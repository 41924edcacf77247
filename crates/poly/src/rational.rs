//! Exact rational arithmetic as a scalar: slow, for checks.

use crate::exact::{self, Exact, ToExact};
use crate::scalar::Scalar;
use num_complex::Complex64;
use num_traits::{One, Zero};

/// A complex number with rational parts; `None` after a division by zero.
///
/// Programs over this type give exact values.
#[derive(Clone, Debug, PartialEq)]
pub struct Rational(pub Option<Exact>);

impl Rational {
    /// The scalar with this exact value.
    pub fn new(value: Exact) -> Rational {
        Rational(Some(value))
    }

    /// The scalar with this integer value.
    pub fn integer(k: i64) -> Rational {
        Rational(Some(exact::from_i64(k)))
    }

    fn map2(a: &Rational, b: &Rational, f: impl Fn(&Exact, &Exact) -> Exact) -> Rational {
        Rational(a.0.as_ref().zip(b.0.as_ref()).map(|(a, b)| f(a, b)))
    }
}

impl Scalar for Rational {
    fn zero() -> Self {
        Rational(Some(Exact::zero()))
    }
    fn one() -> Self {
        Rational(Some(Exact::one()))
    }
    fn from_c64(z: Complex64) -> Self {
        Rational(z.to_exact())
    }
    fn from_exact(z: &Exact) -> Self {
        Rational(Some(z.clone()))
    }
    fn add(a: &Self, b: &Self) -> Self {
        Rational::map2(a, b, |a, b| a + b)
    }
    fn sub(a: &Self, b: &Self) -> Self {
        Rational::map2(a, b, |a, b| a - b)
    }
    fn mul(a: &Self, b: &Self) -> Self {
        Rational::map2(a, b, |a, b| a * b)
    }
    fn div(a: &Self, b: &Self) -> Self {
        if b.0.as_ref().is_none_or(Zero::is_zero) {
            return Rational(None);
        }
        Rational::map2(a, b, |a, b| a / b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Evaluate, Isa, parse};
    use proptest::prelude::*;

    #[test]
    fn division_by_zero_is_nothing() {
        assert_eq!(Rational::div(&Rational::one(), &Rational::zero()), Rational(None));
        assert_eq!(Rational::from_c64(Complex64::new(f64::NAN, 0.0)), Rational(None));
    }

    proptest! {
        /// Formula, compiled program, derivative and expansion agree exactly.
        #[test]
        fn programs_compute_what_expansion_says(x in proptest::collection::vec(-9i64..9, 3)) {
            let text = "3\n (x - 2*y)^3*(z + 1/3) - x*y/7 + 0.1;\n (x*y - z)^2*(x + y*z - 5)*(2 - 3*i);\n x^6*y^2 - (y - z)^5;";
            let system = parse::phcpack(text).unwrap();
            let f = system.compile().unwrap();
            let polynomials = system.expand(&Default::default()).unwrap();
            let point: Vec<Rational> = x.iter().map(|&k| Rational::integer(k)).collect();
            let exact: Vec<Exact> = x.iter().map(|&k| exact::from_i64(k)).collect();
            let mut memory = f.memory(Isa::Portable);
            let (mut v, mut j) = (vec![Rational::zero(); 3], vec![Rational::zero(); 9]);
            f.jacobian(&mut memory, &point, &[], &mut v, &mut j);
            for (i, p) in polynomials.iter().enumerate() {
                prop_assert_eq!(&v[i].0, &p.evaluate(&exact));
                for k in 0..3 {
                    prop_assert_eq!(&j[3 * k + i].0, &p.derivative(k).evaluate(&exact));
                }
            }
            f.values(&mut memory, &point, &[], &mut j[..3]);
            prop_assert_eq!(&v[..], &j[..3]);
        }
    }
}
