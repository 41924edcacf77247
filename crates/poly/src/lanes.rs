//! Eight complex numbers side by side, in planes: eight real parts, then eight imaginary parts.

use crate::dd::ComplexDd;
use crate::dd_lanes::ComplexDdLanes;
use crate::scalar::{Lane, Scalar};
use crate::simd::Isa;
use num_complex::Complex64;

/// Eight independent complex numbers, one for each path.
///
/// Each lane computes bit for bit what `Complex64` computes as a [`Scalar`]. Loops over lanes are
/// plain Rust: inside [`Isa::run`](crate::simd::Isa::run) the compiler turns each loop into one or
/// two vector instructions.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes8 {
    /// Real parts.
    pub re: [f64; 8],
    /// Imaginary parts.
    pub im: [f64; 8],
}

/// Real numbers of double precision, one for each of `N` lanes.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Reals<const N: usize>(pub [f64; N]);

impl<const N: usize> AsRef<[f64]> for Reals<N> {
    #[inline(always)]
    fn as_ref(&self) -> &[f64] {
        &self.0
    }
}

impl<const N: usize> AsMut<[f64]> for Reals<N> {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut [f64] {
        &mut self.0
    }
}

/// Builds a result lane by lane from a formula that mirrors the one-lane type.
macro_rules! lanes {
    ($l:ident => $z:expr) => {{
        let mut out = Lanes8::zero();
        for $l in 0..8 {
            let z: Complex64 = $z;
            out.re[$l] = z.re;
            out.im[$l] = z.im;
        }
        out
    }};
}

impl Lanes8 {
    #[inline(always)]
    fn lane(&self, l: usize) -> Complex64 {
        Complex64::new(self.re[l], self.im[l])
    }
}

impl Scalar for Lanes8 {
    const WIDEST: Isa = Isa::Avx512;
    /// On x86-64 nearly every machine has AVX2, and code for the others is the longest to compile.
    const STRAIGHT: Option<Isa> = Some(if cfg!(target_arch = "x86_64") { Isa::Avx2 } else { Isa::Portable });
    const TAYLOR_COMPILED: bool = true;

    #[inline(always)]
    fn zero() -> Self {
        Lanes8 { re: [0.0; 8], im: [0.0; 8] }
    }
    #[inline(always)]
    fn one() -> Self {
        Lanes8 { re: [1.0; 8], im: [0.0; 8] }
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        Lanes8 { re: [z.re; 8], im: [z.im; 8] }
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::add(&a.lane(l), &b.lane(l)))
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::sub(&a.lane(l), &b.lane(l)))
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul(&a.lane(l), &b.lane(l)))
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::div(&a.lane(l), &b.lane(l)))
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::neg(&a.lane(l)))
    }
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::sqr(&a.lane(l)))
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::inv(&a.lane(l)))
    }
    #[inline(always)]
    fn scale(a: &Self, r: f64) -> Self {
        lanes!(l => <Complex64 as Scalar>::scale(&a.lane(l), r))
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul_real(&a.lane(l), &r.lane(l)))
    }
    #[inline(always)]
    fn mul_real_add(a: &Self, r: &Self, c: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul_real_add(&a.lane(l), &r.lane(l), &c.lane(l)))
    }
    #[inline(always)]
    fn mul_add(a: &Self, b: &Self, c: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul_add(&a.lane(l), &b.lane(l), &c.lane(l)))
    }
    #[inline(always)]
    fn mul_sub(a: &Self, b: &Self, c: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul_sub(&a.lane(l), &b.lane(l), &c.lane(l)))
    }
    #[inline(always)]
    fn sub_mul(a: &Self, b: &Self, c: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::sub_mul(&a.lane(l), &b.lane(l), &c.lane(l)))
    }
    #[inline(always)]
    fn mul_mul_add(a: &Self, b: &Self, c: &Self, d: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul_mul_add(&a.lane(l), &b.lane(l), &c.lane(l), &d.lane(l)))
    }
    #[inline(always)]
    fn mul_mul_sub(a: &Self, b: &Self, c: &Self, d: &Self) -> Self {
        lanes!(l => <Complex64 as Scalar>::mul_mul_sub(&a.lane(l), &b.lane(l), &c.lane(l), &d.lane(l)))
    }
}

impl Lane for Lanes8 {
    const LANES: usize = 8;
    type Real = Reals<8>;
    type Extended = ComplexDdLanes<8>;
    #[inline(always)]
    fn extended(high: &Self, low: &Self) -> ComplexDdLanes<8> {
        ComplexDdLanes::from_sums([&high.re, &low.re], [&high.im, &low.im])
    }
    #[inline(always)]
    fn set_extended(numbers: &mut ComplexDdLanes<8>, l: usize, re: [f64; 2], im: [f64; 2]) {
        numbers.set(l, ComplexDd::from_parts(re, im));
    }
    #[inline(always)]
    fn rounded(numbers: &ComplexDdLanes<8>) -> Self {
        let [re, im] = numbers.high();
        Lanes8 { re: *re, im: *im }
    }
    #[inline(always)]
    fn real(r: f64) -> Reals<8> {
        Reals([r; 8])
    }
    #[inline(always)]
    fn select_equal(a: &Self, b: &Self, labels: &Reals<8>, label: f64) -> Self {
        lanes!(l => if labels.0[l] == label { b.lane(l) } else { a.lane(l) })
    }
    #[inline(always)]
    fn norm_sqr(&self) -> Reals<8> {
        let mut out = Reals([0.0; 8]);
        for l in 0..8 {
            out.0[l] = self.re[l] * self.re[l] + self.im[l] * self.im[l];
        }
        out
    }
    #[inline(always)]
    fn scale_by(&self, r: &Reals<8>) -> Self {
        lanes!(l => <Complex64 as Scalar>::scale(&self.lane(l), r.0[l]))
    }
    #[inline(always)]
    fn get(&self, l: usize) -> Complex64 {
        self.lane(l)
    }
    #[inline(always)]
    fn set(&mut self, l: usize, z: Complex64) {
        self.re[l] = z.re;
        self.im[l] = z.im;
    }
    #[inline(always)]
    fn select(a: &Self, b: &Self, mask: u16) -> Self {
        lanes!(l => if mask >> l & 1 == 1 { b.lane(l) } else { a.lane(l) })
    }
}
