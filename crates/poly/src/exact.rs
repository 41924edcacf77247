//! Exact complex constants and their conversion to floating point.

use num_bigint::BigInt;
use num_complex::{Complex, Complex64};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// A complex number with rational parts.
///
/// Constants of formulas and coefficients of parsed polynomials are exact until they become
/// floating point.
pub type Exact = Complex<BigRational>;

/// Numbers with an exact value, which can be constants of formulas and coefficients of polynomials.
pub trait ToExact {
    /// The exact value; `None` if the number is not finite.
    fn to_exact(&self) -> Option<Exact>;
}

impl<T: ToExact + ?Sized> ToExact for &T {
    fn to_exact(&self) -> Option<Exact> {
        (**self).to_exact()
    }
}
impl ToExact for f64 {
    fn to_exact(&self) -> Option<Exact> {
        BigRational::from_float(*self).map(real)
    }
}
impl ToExact for Complex64 {
    fn to_exact(&self) -> Option<Exact> {
        Some(Complex::new(BigRational::from_float(self.re)?, BigRational::from_float(self.im)?))
    }
}
impl ToExact for i32 {
    fn to_exact(&self) -> Option<Exact> {
        Some(from_i64(i64::from(*self)))
    }
}
impl ToExact for i64 {
    fn to_exact(&self) -> Option<Exact> {
        Some(from_i64(*self))
    }
}
impl ToExact for BigInt {
    fn to_exact(&self) -> Option<Exact> {
        Some(real(BigRational::from_integer(self.clone())))
    }
}
impl ToExact for BigRational {
    fn to_exact(&self) -> Option<Exact> {
        Some(real(self.clone()))
    }
}
impl ToExact for Exact {
    fn to_exact(&self) -> Option<Exact> {
        Some(self.clone())
    }
}

/// Constants are folded only while numerators and denominators stay below this many bits, so that a
/// short text such as `9^9^9` cannot ask for unbounded memory.
pub(crate) const FOLD_BITS: u64 = 1 << 12;

/// The rational as an unevaluated sum `high + low` of two doubles, about 32 digits; the low part is
/// zero only where the high part is exact (intervals rely on it).
pub(crate) fn to_parts(q: &BigRational) -> [f64; 2] {
    let high = q.to_f64().unwrap_or(f64::NAN);
    let Some(h) = BigRational::from_float(high) else { return [high, 0.0] };
    let rest = q - h;
    let low = rest.to_f64().unwrap_or(0.0);
    let underflow = low == 0.0 && !rest.is_zero();
    [high, if underflow { f64::from_bits(1).copysign(if rest.is_negative() { -1.0 } else { 1.0 }) } else { low }]
}

fn real(value: BigRational) -> Exact {
    Complex::new(value, BigRational::zero())
}

/// An integer constant.
pub(crate) fn from_i64(k: i64) -> Exact {
    from_integer(&BigInt::from(k))
}

/// An integer constant of any size.
pub(crate) fn from_integer(k: &BigInt) -> Exact {
    real(BigRational::from_integer(k.clone()))
}

/// Whether the constant is real.
pub(crate) fn is_real(z: &Exact) -> bool {
    z.im.is_zero()
}

/// An integer power; the caller must exclude zero to a negative power.
pub(crate) fn pow(z: &Exact, k: i32) -> Exact {
    if !is_real(z) {
        return z.powi(k);
    }
    // Powers of coprime numbers are coprime, so nothing needs to be cancelled.
    real(num_traits::Pow::pow(&z.re, k))
}

fn rational_bits(q: &BigRational) -> u64 {
    q.numer().bits() + q.denom().bits()
}

/// Total size of numerators and denominators in bits.
pub(crate) fn bits(z: &Exact) -> u64 {
    rational_bits(&z.re) + rational_bits(&z.im)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_a_third() {
        let third = BigRational::new(1.into(), 3.into());
        let [high, low] = to_parts(&third);
        assert_eq!(high, 1.0 / 3.0);
        let sum = BigRational::from_float(high).unwrap() + BigRational::from_float(low).unwrap();
        let error = (sum - third).to_f64().unwrap().abs();
        assert!(error < 1e-32, "{error}");
    }
}
