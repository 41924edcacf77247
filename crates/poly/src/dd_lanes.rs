//! Complex double-double numbers side by side.

use crate::dd::{ComplexDd, Dd};
use crate::scalar::Scalar;
use crate::simd::Isa;
use num_complex::Complex64;

/// `N` real double-double numbers: all high parts, then all low parts.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
struct DdLanes<const N: usize> {
    high: [f64; N],
    low: [f64; N],
}

/// `N` complex numbers with 32 digits, one for each path. Each lane is bit for bit what [`ComplexDd`]
/// computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexDdLanes<const N: usize> {
    re: DdLanes<N>,
    im: DdLanes<N>,
}

impl<const N: usize> DdLanes<N> {
    #[inline(always)]
    fn each(f: impl Fn(usize) -> Dd) -> Self {
        let mut out = DdLanes { high: [0.0; N], low: [0.0; N] };
        for l in 0..N {
            let d = f(l);
            out.high[l] = d.high;
            out.low[l] = d.low;
        }
        out
    }

    #[inline(always)]
    fn all(d: Dd) -> Self {
        DdLanes { high: [d.high; N], low: [d.low; N] }
    }

    #[inline(always)]
    fn lane(&self, l: usize) -> Dd {
        Dd { high: self.high[l], low: self.low[l] }
    }
}

impl<const N: usize> ComplexDdLanes<N> {
    /// Lane by lane what a formula gives.
    #[inline(always)]
    fn each(f: impl Fn(usize) -> ComplexDd) -> Self {
        let (re, im) = (|l| f(l).re, |l| f(l).im);
        ComplexDdLanes { re: DdLanes::each(re), im: DdLanes::each(im) }
    }

    /// The sums of high and low parts, the low ones no larger than the rounding errors of the high ones.
    #[inline(always)]
    pub(crate) fn from_sums(re: [&[f64; N]; 2], im: [&[f64; N]; 2]) -> Self {
        let [re, im] = [re, im].map(|[high, low]| DdLanes { high: *high, low: *low });
        ComplexDdLanes { re, im }
    }

    /// The nearest doubles: real parts, then imaginary parts.
    #[inline(always)]
    pub(crate) fn high(&self) -> [&[f64; N]; 2] {
        [&self.re.high, &self.im.high]
    }

    /// The number in lane `l < N`.
    #[inline(always)]
    pub fn get(&self, l: usize) -> ComplexDd {
        ComplexDd { re: self.re.lane(l), im: self.im.lane(l) }
    }

    /// Replaces the number in lane `l < N`.
    #[inline(always)]
    pub fn set(&mut self, l: usize, z: ComplexDd) {
        (self.re.high[l], self.re.low[l]) = (z.re.high, z.re.low);
        (self.im.high[l], self.im.low[l]) = (z.im.high, z.im.low);
    }
}

impl<const N: usize> Scalar for ComplexDdLanes<N> {
    const WIDEST: Isa = Isa::Avx512;

    #[inline(always)]
    fn zero() -> Self {
        ComplexDdLanes { re: DdLanes::all(Dd::default()), im: DdLanes::all(Dd::default()) }
    }
    #[inline(always)]
    fn one() -> Self {
        ComplexDdLanes { re: DdLanes::all(Dd::new(1.0)), im: DdLanes::all(Dd::default()) }
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        ComplexDdLanes { re: DdLanes::all(Dd::new(z.re)), im: DdLanes::all(Dd::new(z.im)) }
    }
    #[inline(always)]
    fn from_parts(re: [f64; 2], im: [f64; 2]) -> Self {
        let all = |[high, low]: [f64; 2]| DdLanes::all(Dd { high, low });
        ComplexDdLanes { re: all(re), im: all(im) }
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        Self::each(|l| ComplexDd::add(&a.get(l), &b.get(l)))
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        Self::each(|l| ComplexDd::sub(&a.get(l), &b.get(l)))
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        Self::each(|l| ComplexDd::mul(&a.get(l), &b.get(l)))
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        Self::mul(a, &Self::inv(b))
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        Self::each(|l| ComplexDd::neg(&a.get(l)))
    }
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        Self::each(|l| ComplexDd::sqr(&a.get(l)))
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        Self::each(|l| ComplexDd::inv(&a.get(l)))
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        Self::each(|l| ComplexDd::mul_real(&a.get(l), &r.get(l)))
    }
}

#[cfg(test)]
mod tests {
    use super::ComplexDdLanes;
    use crate::dd::{ComplexDd, Dd};
    use crate::scalar::Scalar;
    use crate::simd::{Isa, Kernel};
    use proptest::prelude::*;

    type Lanes = ComplexDdLanes<8>;

    fn results<S: Scalar>(a: &S, b: &S, c: &S) -> [S; 14] {
        [
            S::add(a, b),
            S::sub(a, b),
            S::mul(a, b),
            S::div(a, b),
            S::neg(a),
            S::sqr(a),
            S::inv(a),
            S::mul_real(a, b),
            S::mul_add(a, b, c),
            S::mul_sub(a, b, c),
            S::sub_mul(a, b, c),
            S::mul_real_add(a, b, c),
            S::mul_mul_add(a, b, c, a),
            S::scale(a, 0.3),
        ]
    }

    struct Results<'a>([&'a Lanes; 3]);

    impl Kernel for Results<'_> {
        type Output = [Lanes; 14];
        const WIDEST: Isa = Isa::Avx512;

        #[inline(always)]
        fn run(self) -> [Lanes; 14] {
            let [a, b, c] = self.0;
            results(a, b, c)
        }
    }

    fn number() -> impl Strategy<Value = ComplexDd> {
        let part = || (-1e3..1e3f64, -1.0..1.0f64).prop_map(|(x, y)| Dd::new(x).plus(Dd::new(x * y * 1e-17)));
        (part(), part()).prop_map(|(re, im)| ComplexDd { re, im })
    }

    proptest! {
        #[test]
        fn lanes_are_bit_for_bit_what_one_number_gives(z in prop::collection::vec(number(), 24)) {
            let lanes = [0, 8, 16].map(|first| {
                let mut lanes = Lanes::zero();
                (0..8).for_each(|l| lanes.set(l, z[first + l]));
                lanes
            });
            for isa in [Isa::Portable, Isa::Avx2, Isa::Avx512] {
                let all = isa.run(Results(lanes.each_ref()));
                for l in 0..8 {
                    let expected = results(&z[l], &z[8 + l], &z[16 + l]);
                    for (k, (found, expected)) in all.iter().zip(&expected).enumerate() {
                        prop_assert_eq!(&found.get(l), expected, "operation {} lane {}", k, l);
                    }
                }
            }
        }
    }
}
