//! Sixteen complex numbers of single precision side by side, in planes: sixteen real parts, then sixteen
//! imaginary parts.

use crate::dd::ComplexDd;
use crate::dd_lanes::ComplexDdLanes;
use crate::lanes::{Lanes8, Reals};
use crate::scalar::{Lane, Scalar};
use crate::simd::Isa;
use num_complex::Complex64;

/// Sixteen independent complex numbers of single precision, one for each path: half the work of
/// [`Lanes8`] per path, for what needs no more than six digits.
///
/// Lanes never mix, and all instruction sets give the same bits. Sizes are measured in double precision.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Singles16 {
    /// Real parts.
    pub re: [f32; 16],
    /// Imaginary parts.
    pub im: [f32; 16],
}

/// Builds a result lane by lane from a formula for the real and one for the imaginary part.
macro_rules! lanes {
    ($l:ident => $re:expr, $im:expr) => {{
        let mut out = Singles16::zero();
        for $l in 0..16 {
            out.re[$l] = $re;
            out.im[$l] = $im;
        }
        out
    }};
}

impl Scalar for Singles16 {
    const WIDEST: Isa = Isa::Avx512;
    const STRAIGHT: Option<Isa> = Lanes8::STRAIGHT;
    const TAYLOR_COMPILED: bool = true;
    const TAYLOR_NARROWEST: Isa = Isa::Portable;

    #[inline(always)]
    fn zero() -> Self {
        Singles16 { re: [0.0; 16], im: [0.0; 16] }
    }
    #[inline(always)]
    fn one() -> Self {
        Singles16 { re: [1.0; 16], im: [0.0; 16] }
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        Singles16 { re: [z.re as f32; 16], im: [z.im as f32; 16] }
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        lanes!(l => a.re[l] + b.re[l], a.im[l] + b.im[l])
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        lanes!(l => a.re[l] - b.re[l], a.im[l] - b.im[l])
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        lanes!(l => a.re[l] * b.re[l] - a.im[l] * b.im[l], a.re[l] * b.im[l] + a.im[l] * b.re[l])
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        Self::mul(a, &Self::inv(b))
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        lanes!(l => -a.re[l], -a.im[l])
    }
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        lanes!(l => (a.re[l] + a.im[l]) * (a.re[l] - a.im[l]), a.re[l] * a.im[l] + a.re[l] * a.im[l])
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        let mut r = [0f32; 16];
        for l in 0..16 {
            r[l] = 1.0 / (a.re[l] * a.re[l] + a.im[l] * a.im[l]);
        }
        lanes!(l => a.re[l] * r[l], -a.im[l] * r[l])
    }
    #[inline(always)]
    fn scale(a: &Self, r: f64) -> Self {
        let r = r as f32;
        lanes!(l => a.re[l] * r, a.im[l] * r)
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        lanes!(l => a.re[l] * r.re[l], a.im[l] * r.re[l])
    }
}

impl Lane for Singles16 {
    const LANES: usize = 16;
    type Real = Reals<16>;
    type Extended = ComplexDdLanes<16>;
    #[inline(always)]
    fn extended(high: &Self, low: &Self) -> ComplexDdLanes<16> {
        let wide = |a: &[f32; 16]| a.map(f64::from);
        ComplexDdLanes::from_sums([&wide(&high.re), &wide(&low.re)], [&wide(&high.im), &wide(&low.im)])
    }
    #[inline(always)]
    fn set_extended(numbers: &mut ComplexDdLanes<16>, l: usize, re: [f64; 2], im: [f64; 2]) {
        numbers.set(l, ComplexDd::from_parts(re, im));
    }
    #[inline(always)]
    fn rounded(numbers: &ComplexDdLanes<16>) -> Self {
        let [re, im] = numbers.high().map(|part| part.map(|x| x as f32));
        Singles16 { re, im }
    }
    #[inline(always)]
    fn real(r: f64) -> Reals<16> {
        Reals([r; 16])
    }
    #[inline(always)]
    fn select_equal(a: &Self, b: &Self, labels: &Reals<16>, label: f64) -> Self {
        lanes!(l => if labels.0[l] == label { b.re[l] } else { a.re[l] },
            if labels.0[l] == label { b.im[l] } else { a.im[l] })
    }
    #[inline(always)]
    fn norm_sqr(&self) -> Reals<16> {
        let mut out = Reals([0.0; 16]);
        for l in 0..16 {
            let (re, im) = (f64::from(self.re[l]), f64::from(self.im[l]));
            out.0[l] = re * re + im * im;
        }
        out
    }
    #[inline(always)]
    fn scale_by(&self, r: &Reals<16>) -> Self {
        // Beyond the range of singles infinite, and the path fails.
        lanes!(l => self.re[l] * r.0[l] as f32, self.im[l] * r.0[l] as f32)
    }
    #[inline(always)]
    fn get(&self, l: usize) -> Complex64 {
        Complex64::new(self.re[l].into(), self.im[l].into())
    }
    #[inline(always)]
    fn set(&mut self, l: usize, z: Complex64) {
        self.re[l] = z.re as f32;
        self.im[l] = z.im as f32;
    }
    #[inline(always)]
    fn select(a: &Self, b: &Self, mask: u16) -> Self {
        lanes!(l => if mask >> l & 1 == 1 { b.re[l] } else { a.re[l] },
            if mask >> l & 1 == 1 { b.im[l] } else { a.im[l] })
    }
}

#[cfg(test)]
mod tests {
    use super::{Lane, Scalar, Singles16};
    use num_complex::{Complex32, Complex64};
    use proptest::prelude::*;

    fn pack(z: &[Complex32]) -> Singles16 {
        let mut out = Singles16::zero();
        for (l, z) in z.iter().enumerate() {
            out.set(l, Complex64::new(z.re.into(), z.im.into()));
        }
        out
    }

    fn numbers() -> impl Strategy<Value = Vec<Complex32>> {
        prop::collection::vec((-10f32..10.0, -10f32..10.0).prop_map(|(re, im)| Complex32::new(re, im)), 16)
    }

    /// Within a few rounding errors, measured by the sizes of what was combined.
    fn near(z: Complex64, expected: Complex32, size: f32) -> bool {
        (z - Complex64::new(expected.re.into(), expected.im.into())).norm() <= f64::from(4.0 * f32::EPSILON * size)
    }

    proptest! {
        #[test]
        fn lanes_compute_what_single_precision_computes(a in numbers(), b in numbers(), c in numbers()) {
            let (x, y, z) = (pack(&a), pack(&b), pack(&c));
            for l in 0..16 {
                let (a, b, c) = (a[l], b[l], c[l]);
                let product = a.norm() * b.norm();
                prop_assert!(near(Scalar::add(&x, &y).get(l), a + b, a.norm() + b.norm()));
                prop_assert!(near(Scalar::sub(&x, &y).get(l), a - b, a.norm() + b.norm()));
                prop_assert!(near(Scalar::neg(&x).get(l), -a, 0.0));
                prop_assert!(near(Scalar::mul(&x, &y).get(l), a * b, product));
                prop_assert!(near(Scalar::sqr(&x).get(l), a * a, a.norm_sqr()));
                prop_assert!(near(Scalar::mul_add(&x, &y, &z).get(l), a * b + c, product + c.norm()));
                prop_assert!(near(Scalar::sub_mul(&x, &y, &z).get(l), c - a * b, product + c.norm()));
                if b.norm() > 1e-3 {
                    prop_assert!(near(Scalar::inv(&y).get(l), b.inv(), b.inv().norm()));
                    prop_assert!(near(Scalar::div(&x, &y).get(l), a / b, (a / b).norm()));
                }
                let size = x.norm_sqr().as_ref()[l];
                prop_assert_eq!(size, Complex64::new(a.re.into(), a.im.into()).norm_sqr());
            }
        }

        #[test]
        fn masks_and_labels_choose_lanes(a in numbers(), b in numbers(), mask: u16) {
            let (x, y) = (pack(&a), pack(&b));
            let chosen = Singles16::select(&x, &y, mask);
            let mut labels = Singles16::real(0.0);
            for (l, label) in labels.as_mut().iter_mut().enumerate() {
                *label = f64::from(mask >> l & 1);
            }
            prop_assert_eq!(Singles16::select_equal(&x, &y, &labels, 1.0), chosen);
            prop_assert_eq!(Singles16::any_equal(&labels, 1.0), mask != 0);
            for l in 0..16 {
                prop_assert_eq!(chosen.get(l), if mask >> l & 1 == 1 { y.get(l) } else { x.get(l) });
            }
        }
    }

    #[test]
    fn sizes_do_not_overflow() {
        let big = Singles16::from_c64(Complex64::new(1e30, 0.0));
        assert!((big.norm_sqr().as_ref()[7] / 1e60 - 1.0).abs() < 1e-6);
    }
}
