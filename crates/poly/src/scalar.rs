//! The numbers over which straight-line programs run.

use crate::exact::{self, Exact};
use crate::simd::Isa;
use num_complex::Complex64;

/// A complex-number type over which a straight-line program can run.
///
/// Operations take their operands by reference and are inlined, so that wide types
/// ([`Lanes8`](crate::Lanes8)) stay in vector registers. Fused operations are fused only in
/// notation: `mul_add` rounds the product, then the sum. All instruction sets therefore give the
/// same bits.
pub trait Scalar: Clone + Send + Sync + std::fmt::Debug + 'static {
    /// The widest instruction set that is of use: kernels over these numbers are compiled for it
    /// and for the narrower ones. Default: the portable set, which is right for numbers with one
    /// lane.
    const WIDEST: Isa = Isa::Portable;
    /// The narrowest instruction set for which generated systems have straight-line code over these
    /// numbers. On narrower sets, or everywhere by default, they are interpreted. That is right for
    /// long operations, beside which interpretation costs nothing.
    const STRAIGHT: Option<Isa> = None;
    /// Whether this crate compiles the kernels for Taylor coefficients over these numbers, once, so
    /// that other crates call them. These are by far the largest of all kernels.
    #[doc(hidden)]
    const TAYLOR_COMPILED: bool = false;
    /// The narrowest instruction set for which these kernels are compiled. On narrower sets lanes are run one
    /// by one.
    #[doc(hidden)]
    const TAYLOR_NARROWEST: Isa = match Self::STRAIGHT {
        Some(isa) => isa,
        None => Isa::Portable,
    };

    /// The additive identity.
    fn zero() -> Self;
    /// The multiplicative identity.
    fn one() -> Self;

    /// A complex number, in every lane.
    fn from_c64(z: Complex64) -> Self;

    /// A constant of about 32 digits, given as unevaluated sums `re[0] + re[1]` and
    /// `im[0] + im[1]`, high parts first. Types of double precision drop the low parts.
    #[inline(always)]
    fn from_parts(re: [f64; 2], im: [f64; 2]) -> Self {
        Self::from_c64(Complex64::new(re[0], im[0]))
    }

    /// The number of this type that is nearest to an exact constant, to 32 digits. Types with more
    /// digits override this method.
    fn from_exact(z: &Exact) -> Self {
        Self::from_parts(exact::to_parts(&z.re), exact::to_parts(&z.im))
    }

    /// `a + b`
    fn add(a: &Self, b: &Self) -> Self;
    /// `a - b`
    fn sub(a: &Self, b: &Self) -> Self;
    /// `a * b`
    fn mul(a: &Self, b: &Self) -> Self;
    /// `a / b`. Division by zero gives values that are not finite; it does not panic.
    fn div(a: &Self, b: &Self) -> Self;

    /// `-a`
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        Self::sub(&Self::zero(), a)
    }
    /// `a * a`
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        Self::mul(a, a)
    }
    /// `1 / a`. Zero gives values that are not finite; it does not panic.
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        Self::div(&Self::one(), a)
    }
    /// `r * a` for a real factor `r`
    #[inline(always)]
    fn scale(a: &Self, r: f64) -> Self {
        Self::mul(a, &Self::from_c64(Complex64::new(r, 0.0)))
    }
    /// `a * r` for a real `r`
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        Self::mul(a, r)
    }
    /// `a * r + c` for a real `r`
    #[inline(always)]
    fn mul_real_add(a: &Self, r: &Self, c: &Self) -> Self {
        Self::add(&Self::mul_real(a, r), c)
    }
    /// `a * b + c`
    #[inline(always)]
    fn mul_add(a: &Self, b: &Self, c: &Self) -> Self {
        Self::add(&Self::mul(a, b), c)
    }
    /// `a * b - c`
    #[inline(always)]
    fn mul_sub(a: &Self, b: &Self, c: &Self) -> Self {
        Self::sub(&Self::mul(a, b), c)
    }
    /// `c - a * b`
    #[inline(always)]
    fn sub_mul(a: &Self, b: &Self, c: &Self) -> Self {
        Self::sub(c, &Self::mul(a, b))
    }
    /// `a * b + c * d`
    #[inline(always)]
    fn mul_mul_add(a: &Self, b: &Self, c: &Self, d: &Self) -> Self {
        Self::add(&Self::mul(a, b), &Self::mul(c, d))
    }
    /// `a * b - c * d`
    #[inline(always)]
    fn mul_mul_sub(a: &Self, b: &Self, c: &Self, d: &Self) -> Self {
        Self::sub(&Self::mul(a, b), &Self::mul(c, d))
    }

    /// Whether generated systems run straight-line code over these numbers on an instruction set.
    #[inline]
    fn is_straight(isa: Isa) -> bool {
        Self::STRAIGHT.is_some_and(|narrowest| narrowest == Isa::Portable || isa.within_machine() >= narrowest)
    }
}

/// The narrowest instruction set for which straight-line code over these numbers is compiled.
pub const fn narrowest<S: Scalar>() -> Isa {
    match S::STRAIGHT {
        Some(isa) => isa,
        None => Isa::Portable,
    }
}

/// A [`Scalar`] of double precision, or of single precision, with one lane or several, one lane for each
/// path.
///
/// Lanes never mix: lane `l` of a result depends only on lane `l` of the operands. Each lane is bit
/// for bit what the type with one lane and the same precision computes. The tracker is written once, over
/// this trait. Real numbers are of double precision, so that squares of sizes do not overflow.
pub trait Lane: Scalar + Copy {
    /// Number of lanes.
    const LANES: usize;
    /// One real number for each lane.
    type Real: Copy + Send + Sync + std::fmt::Debug + AsRef<[f64]> + AsMut<[f64]> + 'static;
    /// One number of double-double precision for each lane.
    type Extended: Scalar + Copy;
    /// The numbers `high + low`, `low` no larger than the rounding error of `high`.
    fn extended(high: &Self, low: &Self) -> Self::Extended;
    /// Replaces the number in lane `l < LANES`, as in [`Scalar::from_parts`].
    fn set_extended(numbers: &mut Self::Extended, l: usize, re: [f64; 2], im: [f64; 2]);
    /// The numbers to the precision of this type.
    fn rounded(numbers: &Self::Extended) -> Self;
    /// A real number, in every lane.
    fn real(r: f64) -> Self::Real;
    /// `a * b` lane by lane.
    #[inline(always)]
    fn real_mul(a: &Self::Real, b: &Self::Real) -> Self::Real {
        let mut out = *a;
        for l in 0..Self::LANES {
            out.as_mut()[l] = a.as_ref()[l] * b.as_ref()[l];
        }
        out
    }
    /// The larger of `a` and `b`, lane by lane; `b` where either is not a number.
    #[inline(always)]
    fn real_max(a: &Self::Real, b: &Self::Real) -> Self::Real {
        let mut out = *b;
        for l in 0..Self::LANES {
            let (a, b) = (a.as_ref()[l], b.as_ref()[l]);
            out.as_mut()[l] = if a > b { a } else { b };
        }
        out
    }
    /// `b` where `a < limit`, `c` elsewhere, lane by lane.
    #[inline(always)]
    fn real_where_less(a: &Self::Real, limit: &Self::Real, b: &Self::Real, c: &Self::Real) -> Self::Real {
        let mut out = *c;
        for l in 0..Self::LANES {
            let less = a.as_ref()[l] < limit.as_ref()[l];
            out.as_mut()[l] = if less { b.as_ref()[l] } else { c.as_ref()[l] };
        }
        out
    }
    /// Whether any lane holds exactly `label`.
    #[inline(always)]
    fn any_equal(labels: &Self::Real, label: f64) -> bool {
        let mut found = 0u64;
        for l in 0..Self::LANES {
            found += u64::from(labels.as_ref()[l] == label);
        }
        found > 0
    }
    /// Takes `b` where `labels` holds exactly `label`, `a` elsewhere.
    fn select_equal(a: &Self, b: &Self, labels: &Self::Real, label: f64) -> Self;
    /// `|a|^2` lane by lane.
    fn norm_sqr(&self) -> Self::Real;
    /// `r * a` lane by lane.
    fn scale_by(&self, r: &Self::Real) -> Self;
    /// The number in lane `l < LANES`.
    fn get(&self, l: usize) -> Complex64;
    /// Replaces the number in lane `l < LANES`.
    fn set(&mut self, l: usize, z: Complex64);
    /// Takes lane `l` from `b` where `mask` has bit `l` set, from `a` elsewhere.
    fn select(a: &Self, b: &Self, mask: u16) -> Self;
}
