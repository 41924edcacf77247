//! Floating-point numbers of a fixed number of machine words: more digits than double-double,
//! without allocation.
//!
//! Sums keep one guard word, and all operations truncate. The error of each operation is therefore
//! at most a few units in the last of `64 * LIMBS` binary digits. Exponents have 64 bits and do not
//! overflow in practice; a result that would overflow is not a number. At 256 digits a product and
//! a sum take about a tenth of the time of libraries whose precision is chosen at run time.

use crate::exact::Exact;
use crate::scalar::Scalar;
use num_bigint::{BigInt, Sign};
use num_complex::Complex64;
use num_rational::BigRational;
use std::cmp::Ordering;

/// A real number of `64 * LIMBS` binary digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Float<const LIMBS: usize> {
    negative: bool,
    /// The number is its digits, read as a fraction in [1/2, 1), times two to this power. The
    /// exponent [`NOT_A_NUMBER`] marks what is not a number.
    exponent: i64,
    /// Lowest word first. The top bit is set unless this is zero or not a number.
    limbs: [u64; LIMBS],
}

const NOT_A_NUMBER: i64 = i64::MAX;
/// Exponents beyond this are out of range.
const RANGE: i64 = 1 << 40;

impl<const LIMBS: usize> Float<LIMBS> {
    /// Zero.
    pub const ZERO: Self = Float { negative: false, exponent: 0, limbs: [0; LIMBS] };
    const NAN: Self = Float { negative: false, exponent: NOT_A_NUMBER, limbs: [0; LIMBS] };

    /// Whether this is a number.
    pub fn is_finite(&self) -> bool {
        self.exponent != NOT_A_NUMBER
    }

    /// Whether this is zero.
    pub fn is_zero(&self) -> bool {
        self.is_finite() && self.top() == 0
    }

    fn top(&self) -> u64 {
        self.limbs.last().copied().unwrap_or(0)
    }

    /// The number with these digits, whose top bit may not be set, followed by a guard word.
    fn normalised(negative: bool, exponent: i64, mut limbs: [u64; LIMBS], mut guard: u64) -> Self {
        let Some(leading) = limbs.iter().rev().position(|&l| l != 0) else {
            if guard == 0 {
                return Self::ZERO;
            }
            let shift = guard.leading_zeros();
            limbs.fill(0);
            if let Some(top) = limbs.last_mut() {
                *top = guard << shift;
            }
            return Self::checked(negative, exponent - 64 * LIMBS as i64 - i64::from(shift), limbs);
        };
        if leading > 0 {
            for k in (0..LIMBS).rev() {
                limbs[k] = match k.cmp(&(leading - 1)) {
                    Ordering::Greater => limbs[k - leading],
                    Ordering::Equal => std::mem::take(&mut guard),
                    Ordering::Less => 0,
                };
            }
        }
        let bits = limbs[LIMBS - 1].leading_zeros();
        if bits > 0 {
            for k in (0..LIMBS).rev() {
                let below = if k > 0 { limbs[k - 1] } else { guard };
                limbs[k] = limbs[k] << bits | below >> (64 - bits);
            }
        }
        Self::checked(negative, exponent - 64 * leading as i64 - i64::from(bits), limbs)
    }

    fn checked(negative: bool, exponent: i64, limbs: [u64; LIMBS]) -> Self {
        match exponent {
            e if e > RANGE => Self::NAN,
            e if e < -RANGE => Self::ZERO,
            _ => Float { negative, exponent, limbs },
        }
    }

    /// A double, exactly; infinities become "not a number".
    pub fn from_f64(x: f64) -> Self {
        if !x.is_finite() {
            return Self::NAN;
        }
        let bits = x.abs().to_bits();
        let (power, fraction) = ((bits >> 52) as i64, bits & ((1 << 52) - 1));
        let (digits, exponent) = if power == 0 { (fraction, -1074) } else { (fraction | 1 << 52, power - 1075) };
        let mut limbs = [0; LIMBS];
        limbs[LIMBS - 1] = digits;
        Self::normalised(x < 0.0, exponent + 64, limbs, 0)
    }

    /// The nearest double, or its neighbour where both are nearly as near; infinite or zero where
    /// the number is out of range.
    pub fn to_f64(self) -> f64 {
        if !self.is_finite() {
            return f64::NAN;
        }
        let fraction = self.top() as f64 * 2f64.powi(-64);
        let exponent = self.exponent.clamp(-2200, 2200) as i32;
        // In two steps, since the power alone may be out of range.
        let size = fraction * 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
        if self.negative { -size } else { size }
    }

    /// The logarithm of the absolute value to base 2; negative infinity for zero.
    pub fn log2(&self) -> f64 {
        if !self.is_finite() {
            return f64::NAN;
        }
        self.exponent as f64 + ((self.top() >> 11) as f64 * 2f64.powi(-53)).log2()
    }

    fn from_integer(k: &BigInt) -> Self {
        let digits = k.magnitude().to_u64_digits();
        let mut limbs = [0; LIMBS];
        let mut guard = 0;
        for (place, digit) in digits.iter().rev().enumerate().take(LIMBS + 1) {
            if place < LIMBS {
                limbs[LIMBS - 1 - place] = *digit;
            } else {
                guard = *digit;
            }
        }
        Self::normalised(k.sign() == Sign::Minus, 64 * digits.len() as i64, limbs, guard)
    }

    /// The number nearest to a rational, except for a few units in the last digit.
    pub fn from_rational(q: &BigRational) -> Self {
        Self::from_integer(q.numer()).times(&Self::from_integer(q.denom()).reciprocal())
    }

    /// `self * 2^k`
    pub fn shifted(&self, k: i64) -> Self {
        if !self.is_finite() || self.is_zero() {
            return *self;
        }
        Self::checked(self.negative, self.exponent.saturating_add(k), self.limbs)
    }

    /// `-self`
    pub fn negated(&self) -> Self {
        Float { negative: !self.negative, ..*self }
    }

    /// `self + b`
    pub fn plus(&self, b: &Self) -> Self {
        if !self.is_finite() || !b.is_finite() {
            return Self::NAN;
        }
        if b.is_zero() {
            return *self;
        }
        if self.is_zero() {
            return *b;
        }
        let (a, b) = if self.exponent >= b.exponent { (self, b) } else { (b, self) };
        let shift = (a.exponent - b.exponent) as u64;
        if shift > 64 * (LIMBS as u64 + 1) {
            return *a;
        }
        let (low, guard) = shifted_down(&b.limbs, shift);
        let mut limbs = a.limbs;
        if a.negative == b.negative {
            let mut carry = false;
            for (x, y) in limbs.iter_mut().zip(&low) {
                let (sum, first) = x.overflowing_add(*y);
                let (sum, second) = sum.overflowing_add(u64::from(carry));
                (*x, carry) = (sum, first || second);
            }
            if !carry {
                return Float { limbs, ..*a };
            }
            let (mut limbs, _) = shifted_down(&limbs, 1);
            limbs[LIMBS - 1] |= 1 << 63;
            return Self::checked(a.negative, a.exponent + 1, limbs);
        }
        let less = shift == 0 && limbs.iter().rev().lt(low.iter().rev());
        let (mut larger, smaller) = if less { (low, limbs) } else { (limbs, low) };
        let mut borrow = guard > 0;
        for (x, y) in larger.iter_mut().zip(&smaller) {
            let (difference, first) = x.overflowing_sub(*y);
            let (difference, second) = difference.overflowing_sub(u64::from(borrow));
            (*x, borrow) = (difference, first || second);
        }
        Self::normalised(a.negative != less, a.exponent, larger, guard.wrapping_neg())
    }

    /// `self - b`
    pub fn minus(&self, b: &Self) -> Self {
        self.plus(&b.negated())
    }

    /// `self * b`
    pub fn times(&self, b: &Self) -> Self {
        if !self.is_finite() || !b.is_finite() {
            return Self::NAN;
        }
        if self.is_zero() || b.is_zero() {
            return Self::ZERO;
        }
        let (mut low, mut high) = ([0u64; LIMBS], [0u64; LIMBS]);
        for i in 0..LIMBS {
            let mut carry = 0u64;
            for j in 0..LIMBS {
                let cell = if i + j < LIMBS { &mut low[i + j] } else { &mut high[i + j - LIMBS] };
                let sum = u128::from(self.limbs[i]) * u128::from(b.limbs[j]) + u128::from(*cell) + u128::from(carry);
                (*cell, carry) = (sum as u64, (sum >> 64) as u64);
            }
            high[i] = carry;
        }
        Self::normalised(self.negative != b.negative, self.exponent + b.exponent, high, low[LIMBS - 1])
    }

    /// `1 / self` by Newton's method from the reciprocal of the leading digits; not a number for
    /// zero.
    pub fn reciprocal(&self) -> Self {
        if !self.is_finite() || self.is_zero() {
            return Self::NAN;
        }
        let fraction = Float { negative: false, exponent: 0, limbs: self.limbs };
        let mut inverse = Self::from_f64(1.0 / fraction.to_f64());
        let one = Self::from_f64(1.0);
        let mut digits = 50;
        while digits < 64 * LIMBS {
            let error = one.minus(&fraction.times(&inverse));
            inverse = inverse.plus(&inverse.times(&error));
            digits *= 2;
        }
        Self::checked(self.negative, inverse.exponent - self.exponent, inverse.limbs)
    }
}

/// Digits moved down by `shift` bits, and the word below them.
fn shifted_down<const LIMBS: usize>(limbs: &[u64; LIMBS], shift: u64) -> ([u64; LIMBS], u64) {
    let (words, bits) = ((shift / 64) as usize, shift % 64);
    let word = |k: usize| limbs.get(k).copied().unwrap_or(0);
    let moved = |k: usize| if bits == 0 { word(k) } else { word(k) >> bits | word(k + 1) << (64 - bits) };
    let guard = match (words, bits) {
        (0, 0) => 0,
        (0, _) => word(0) << (64 - bits),
        (w, _) => moved(w - 1),
    };
    (std::array::from_fn(|k| moved(k + words)), guard)
}

/// A complex number of `64 * LIMBS` binary digits in each part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexMulti<const LIMBS: usize> {
    /// Real part.
    pub re: Float<LIMBS>,
    /// Imaginary part.
    pub im: Float<LIMBS>,
}

impl<const LIMBS: usize> ComplexMulti<LIMBS> {
    /// The nearest complex double, by `to_f64` of both parts.
    pub fn to_c64(&self) -> Complex64 {
        Complex64::new(self.re.to_f64(), self.im.to_f64())
    }

    /// The logarithm of the larger part's size to base 2: negative infinity for zero, and not a
    /// number if a part is not a number.
    pub fn log2(&self) -> f64 {
        let (re, im) = (self.re.log2(), self.im.log2());
        if re.is_nan() || im.is_nan() { f64::NAN } else { re.max(im) }
    }

    /// `self * 2^k`
    pub fn shifted(&self, k: i64) -> Self {
        ComplexMulti { re: self.re.shifted(k), im: self.im.shifted(k) }
    }
}

impl<const LIMBS: usize> Scalar for ComplexMulti<LIMBS> {
    fn zero() -> Self {
        ComplexMulti { re: Float::ZERO, im: Float::ZERO }
    }
    fn one() -> Self {
        ComplexMulti { re: Float::from_f64(1.0), im: Float::ZERO }
    }
    fn from_c64(z: Complex64) -> Self {
        ComplexMulti { re: Float::from_f64(z.re), im: Float::from_f64(z.im) }
    }
    fn from_parts(re: [f64; 2], im: [f64; 2]) -> Self {
        let sum = |parts: [f64; 2]| Float::from_f64(parts[0]).plus(&Float::from_f64(parts[1]));
        ComplexMulti { re: sum(re), im: sum(im) }
    }
    fn from_exact(z: &Exact) -> Self {
        ComplexMulti { re: Float::from_rational(&z.re), im: Float::from_rational(&z.im) }
    }
    fn add(a: &Self, b: &Self) -> Self {
        ComplexMulti { re: a.re.plus(&b.re), im: a.im.plus(&b.im) }
    }
    fn sub(a: &Self, b: &Self) -> Self {
        ComplexMulti { re: a.re.minus(&b.re), im: a.im.minus(&b.im) }
    }
    fn mul(a: &Self, b: &Self) -> Self {
        ComplexMulti { re: a.re.times(&b.re).minus(&a.im.times(&b.im)), im: a.re.times(&b.im).plus(&a.im.times(&b.re)) }
    }
    fn div(a: &Self, b: &Self) -> Self {
        Self::mul(a, &Self::inv(b))
    }
    fn neg(a: &Self) -> Self {
        ComplexMulti { re: a.re.negated(), im: a.im.negated() }
    }
    fn inv(a: &Self) -> Self {
        let r = a.re.times(&a.re).plus(&a.im.times(&a.im)).reciprocal();
        ComplexMulti { re: a.re.times(&r), im: a.im.times(&r).negated() }
    }
    fn mul_real(a: &Self, r: &Self) -> Self {
        ComplexMulti { re: a.re.times(&r.re), im: a.im.times(&r.re) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_traits::{Signed, ToPrimitive, Zero};
    use proptest::prelude::*;

    type F = Float<4>;

    fn exact<const L: usize>(a: &Float<L>) -> BigRational {
        let digits = a.limbs.iter().rev().fold(BigInt::zero(), |sum, &l| (sum << 64) + BigInt::from(l));
        let power = a.exponent - 64 * L as i64;
        let two = |k: i64| BigRational::from_integer(BigInt::from(1) << k.unsigned_abs());
        let size = BigRational::from_integer(digits) * if power < 0 { two(power).recip() } else { two(power) };
        if a.negative { -size } else { size }
    }

    /// The error in units of `2^-(64 L)` of `size`.
    fn units<const L: usize>(got: &Float<L>, want: &BigRational, size: &BigRational) -> f64 {
        let unit = BigRational::new(1.into(), BigInt::from(1) << (64 * L));
        ((exact(got) - want).abs() / (size.abs() * unit)).to_f64().unwrap()
    }

    /// Numbers with long runs of zeros and ones among their digits too, where carries run far.
    fn float() -> impl Strategy<Value = F> {
        let limb = prop_oneof![any::<u64>(), Just(0), Just(u64::MAX), Just(1), Just(1 << 63)];
        (any::<bool>(), -300i64..300, prop::array::uniform4(limb)).prop_map(|(negative, exponent, mut limbs)| {
            limbs[3] |= 1 << 63;
            Float { negative, exponent, limbs }
        })
    }

    proptest! {
        #[test]
        fn sums_and_products_are_off_by_few_units(a in float(), b in float()) {
            let (x, y) = (exact(&a), exact(&b));
            let larger = if x.abs() > y.abs() { x.clone() } else { y.clone() };
            prop_assert!(units(&a.plus(&b), &(&x + &y), &larger) <= 2.0);
            prop_assert!(units(&a.times(&b), &(&x * &y), &(&x * &y)) <= 2.0);
            prop_assert!(a.minus(&a).is_zero());
        }

        /// The guard word keeps differences of close numbers exact.
        #[test]
        fn differences_of_neighbours_are_exact(a in float(), place in 0usize..256) {
            let unit = Float { negative: false, exponent: a.exponent - place as i64, limbs: [0, 0, 0, 1 << 63] };
            let b = a.plus(&unit);
            prop_assert_eq!(exact(&b.minus(&a)), exact(&b) - exact(&a));
        }

        #[test]
        fn reciprocals_are_off_by_few_units(a in float()) {
            let inverse = exact(&a).recip();
            prop_assert!(units(&a.reciprocal(), &inverse, &inverse) <= 16.0);
        }

        #[test]
        fn doubles_come_back(x in prop::num::f64::NORMAL | prop::num::f64::SUBNORMAL) {
            let a = F::from_f64(x);
            prop_assert_eq!(exact(&a), BigRational::from_float(x).unwrap());
            prop_assert_eq!(a.to_f64(), x);
            prop_assert!((a.log2() - x.abs().log2()).abs() < 1e-9);
        }

        #[test]
        fn rationals_are_off_by_few_units(n in any::<i128>(), d in 1..i128::MAX, shift in 0u32..400) {
            let q = BigRational::new(BigInt::from(n) << shift, d.into());
            prop_assume!(!q.is_zero());
            prop_assert!(units(&F::from_rational(&q), &q, &q) <= 32.0);
        }
    }

    #[test]
    fn what_is_out_of_range_is_no_number_and_nothing_panics() {
        let huge = F::from_f64(1.0).shifted(RANGE - 1);
        assert!(!huge.times(&huge).is_finite() && F::from_f64(1.0).shifted(-RANGE - 5).is_zero());
        assert!(!F::ZERO.reciprocal().is_finite() && !F::from_f64(f64::NAN).plus(&huge).is_finite());
        assert_eq!((F::ZERO.log2(), F::from_f64(f64::INFINITY).to_f64().is_nan()), (f64::NEG_INFINITY, true));
        assert_eq!(huge.to_f64(), f64::INFINITY);
    }
}
