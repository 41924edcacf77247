//! Double-double numbers: about 32 digits from pairs of doubles.
//!
//! Sums are error-free after Knuth, products by `f64::mul_add`. The algorithms for pairs are those
//! analysed in Joldes, Muller, Popescu, *Tight and rigorous error bounds for basic building blocks
//! of double-word arithmetic* (ACM TOMS 44, 2017). The comments below give their numbers there.

use crate::scalar::Scalar;
use crate::simd::Isa;
use num_complex::Complex64;

/// A double-double number: the unevaluated sum `high + low`, with `|low|` at most half an ulp of
/// `high`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dd {
    /// The double nearest to the sum.
    pub high: f64,
    /// The rest.
    pub low: f64,
}

/// `a + b` and its rounding error, exactly.
#[inline(always)]
fn two_sum(a: f64, b: f64) -> Dd {
    let high = a + b;
    let part = high - a;
    Dd { high, low: (a - (high - part)) + (b - part) }
}

/// `a + b` and its rounding error, exactly, where `|a| >= |b|` or `a` is zero.
#[inline(always)]
fn fast_two_sum(a: f64, b: f64) -> Dd {
    let high = a + b;
    Dd { high, low: b - (high - a) }
}

/// `a * b` and its rounding error, exactly (but for underflow).
#[inline(always)]
fn two_prod(a: f64, b: f64) -> Dd {
    let high = a * b;
    Dd { high, low: a.mul_add(b, -high) }
}

impl Dd {
    /// The double-double number that equals a double.
    #[inline(always)]
    pub fn new(high: f64) -> Dd {
        Dd { high, low: 0.0 }
    }

    /// `self + b`, relative error at most 3u^2 (algorithm 6).
    #[inline(always)]
    pub fn plus(self, b: Dd) -> Dd {
        let s = two_sum(self.high, b.high);
        let t = two_sum(self.low, b.low);
        let v = fast_two_sum(s.high, s.low + t.high);
        fast_two_sum(v.high, t.low + v.low)
    }

    /// `-self`
    #[inline(always)]
    pub fn negated(self) -> Dd {
        Dd { high: -self.high, low: -self.low }
    }

    /// `self - b`
    #[inline(always)]
    pub fn minus(self, b: Dd) -> Dd {
        self.plus(b.negated())
    }

    /// `self * b`, relative error at most 5u^2 (algorithm 12).
    #[inline(always)]
    pub fn times(self, b: Dd) -> Dd {
        let p = two_prod(self.high, b.high);
        let cross = self.low * b.low;
        let cross = self.high.mul_add(b.low, cross);
        let cross = self.low.mul_add(b.high, cross);
        fast_two_sum(p.high, p.low + cross)
    }

    /// `1 / self` by one Newton step from the double reciprocal, relative error of a few u^2.
    #[inline(always)]
    pub fn reciprocal(self) -> Dd {
        let r = 1.0 / self.high;
        // 1 - self * r: the high part is exact with one fused operation.
        let e = self.high.mul_add(-r, 1.0);
        let e = fast_two_sum(e, -self.low * r);
        let correction = e.times(Dd::new(r)).plus(e.times(e).times(Dd::new(r)));
        Dd::new(r).plus(correction)
    }
}

/// A complex number with double-double parts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ComplexDd {
    /// Real part.
    pub re: Dd,
    /// Imaginary part.
    pub im: Dd,
}

impl ComplexDd {
    /// The double-double number that equals a complex double.
    #[inline(always)]
    pub fn new(z: Complex64) -> ComplexDd {
        ComplexDd { re: Dd::new(z.re), im: Dd::new(z.im) }
    }

    /// The nearest complex double.
    #[inline(always)]
    pub fn high(&self) -> Complex64 {
        Complex64::new(self.re.high, self.im.high)
    }

    /// High and low part of the real part, and of the imaginary part.
    #[inline(always)]
    pub fn parts(&self) -> [[f64; 2]; 2] {
        [self.re, self.im].map(|part| [part.high, part.low])
    }

    /// The difference from [`high`](ComplexDd::high), as a complex double.
    #[inline(always)]
    pub fn low(&self) -> Complex64 {
        Complex64::new(self.re.low, self.im.low)
    }
}

impl From<Complex64> for ComplexDd {
    fn from(z: Complex64) -> ComplexDd {
        ComplexDd::new(z)
    }
}

impl From<ComplexDd> for Complex64 {
    fn from(z: ComplexDd) -> Complex64 {
        z.high()
    }
}

impl Scalar for ComplexDd {
    /// For its fused products.
    const WIDEST: Isa = Isa::Avx2;

    #[inline(always)]
    fn zero() -> Self {
        ComplexDd::default()
    }
    #[inline(always)]
    fn one() -> Self {
        ComplexDd { re: Dd::new(1.0), im: Dd::default() }
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        ComplexDd::new(z)
    }
    #[inline(always)]
    fn from_parts(re: [f64; 2], im: [f64; 2]) -> Self {
        ComplexDd { re: Dd { high: re[0], low: re[1] }, im: Dd { high: im[0], low: im[1] } }
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        ComplexDd { re: a.re.plus(b.re), im: a.im.plus(b.im) }
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        ComplexDd { re: a.re.minus(b.re), im: a.im.minus(b.im) }
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        ComplexDd { re: a.re.times(b.re).minus(a.im.times(b.im)), im: a.re.times(b.im).plus(a.im.times(b.re)) }
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        Self::mul(a, &Self::inv(b))
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        ComplexDd { re: a.re.negated(), im: a.im.negated() }
    }
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        let cross = a.re.times(a.im);
        ComplexDd {
            re: a.re.plus(a.im).times(a.re.minus(a.im)),
            im: Dd { high: 2.0 * cross.high, low: 2.0 * cross.low },
        }
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        let r = a.re.times(a.re).plus(a.im.times(a.im)).reciprocal();
        ComplexDd { re: a.re.times(r), im: a.im.times(r).negated() }
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        ComplexDd { re: a.re.times(r.re), im: a.im.times(r.re) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use num_traits::{One, Signed, ToPrimitive, Zero};
    use proptest::prelude::*;

    fn exact(a: Dd) -> BigRational {
        BigRational::from_float(a.high).unwrap() + BigRational::from_float(a.low).unwrap()
    }

    /// `|got - want| / |want|` in units of u^2 = 2^-106.
    fn error(got: Dd, want: &BigRational) -> f64 {
        if want.is_zero() {
            return exact(got).to_f64().unwrap().abs();
        }
        ((exact(got) - want) / want).abs().to_f64().unwrap() * 2f64.powi(106)
    }

    fn dd() -> impl Strategy<Value = Dd> {
        (-1e6..1e6f64, -1.0..1.0f64).prop_map(|(high, low)| two_sum(high, high * low * f64::EPSILON / 2.0))
    }

    proptest! {
        #[test]
        fn sums_and_products_meet_the_published_bounds(a in dd(), b in dd()) {
            prop_assert!(error(a.plus(b), &(exact(a) + exact(b))) <= 3.01);
            prop_assert!(error(a.times(b), &(exact(a) * exact(b))) <= 5.0);
        }

        #[test]
        fn reciprocals_are_accurate(a in dd()) {
            prop_assume!(a.high != 0.0);
            prop_assert!(error(a.reciprocal(), &(BigRational::one() / exact(a))) <= 16.0);
        }

        #[test]
        fn complex_quotients_undo_products(a in dd(), b in dd(), c in dd(), d in dd()) {
            let (z, w) = (ComplexDd { re: a, im: b }, ComplexDd { re: c, im: d });
            prop_assume!(w.high().norm() > 1e-3);
            let back = ComplexDd::div(&ComplexDd::mul(&z, &w), &w);
            let difference = ComplexDd::sub(&back, &z).high().norm();
            prop_assert!(difference <= 1e-29 * z.high().norm());
        }
    }
}
