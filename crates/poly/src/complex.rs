//! Complex numbers of double precision, one at a time.

use crate::dd::{ComplexDd, Dd};
use crate::scalar::{Lane, Scalar};
use crate::simd::Isa;
use num_complex::Complex64;

impl Scalar for Complex64 {
    const STRAIGHT: Option<Isa> = Some(Isa::Portable);
    const TAYLOR_COMPILED: bool = true;

    #[inline(always)]
    fn zero() -> Self {
        Complex64::new(0.0, 0.0)
    }
    #[inline(always)]
    fn one() -> Self {
        Complex64::new(1.0, 0.0)
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        z
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        Complex64::new(a.re + b.re, a.im + b.im)
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        Complex64::new(a.re - b.re, a.im - b.im)
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        Complex64::new(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re)
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        let r = 1.0 / (b.re * b.re + b.im * b.im);
        let (re, im) = (b.re * r, -b.im * r);
        Complex64::new(a.re * re - a.im * im, a.re * im + a.im * re)
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        Complex64::new(-a.re, -a.im)
    }
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        let cross = a.re * a.im;
        Complex64::new((a.re + a.im) * (a.re - a.im), cross + cross)
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        let r = 1.0 / (a.re * a.re + a.im * a.im);
        Complex64::new(a.re * r, -a.im * r)
    }
    #[inline(always)]
    fn scale(a: &Self, r: f64) -> Self {
        Complex64::new(a.re * r, a.im * r)
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        Complex64::new(a.re * r.re, a.im * r.re)
    }
}

impl Lane for Complex64 {
    const LANES: usize = 1;
    type Real = [f64; 1];
    type Extended = ComplexDd;
    #[inline(always)]
    fn extended(high: &Self, low: &Self) -> ComplexDd {
        ComplexDd { re: Dd { high: high.re, low: low.re }, im: Dd { high: high.im, low: low.im } }
    }
    #[inline(always)]
    fn set_extended(numbers: &mut ComplexDd, _: usize, re: [f64; 2], im: [f64; 2]) {
        *numbers = ComplexDd::from_parts(re, im);
    }
    #[inline(always)]
    fn rounded(numbers: &ComplexDd) -> Self {
        numbers.high()
    }
    #[inline(always)]
    fn real(r: f64) -> [f64; 1] {
        [r]
    }
    #[inline(always)]
    fn select_equal(a: &Self, b: &Self, labels: &[f64; 1], label: f64) -> Self {
        if labels[0] == label { *b } else { *a }
    }
    #[inline(always)]
    fn norm_sqr(&self) -> [f64; 1] {
        [self.re * self.re + self.im * self.im]
    }
    #[inline(always)]
    fn scale_by(&self, r: &[f64; 1]) -> Self {
        Complex64::new(self.re * r[0], self.im * r[0])
    }
    #[inline(always)]
    fn get(&self, _: usize) -> Complex64 {
        *self
    }
    #[inline(always)]
    fn set(&mut self, _: usize, z: Complex64) {
        *self = z;
    }
    #[inline(always)]
    fn select(a: &Self, b: &Self, mask: u16) -> Self {
        if mask & 1 == 1 { *b } else { *a }
    }
}
