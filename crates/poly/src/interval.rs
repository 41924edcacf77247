//! Complex intervals: rectangles that contain every exact result.
//!
//! Each bound is computed in round-to-nearest and then moved one double outward. It contains the
//! exact value, because rounding errs by less than one step (Rump, *Verification methods*, Acta
//! Numerica 19, 2010, section 4).

use crate::scalar::Scalar;
use num_complex::Complex64;

/// A closed real interval. Bounds may be infinite, but are never "not a number".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl Interval {
    /// The whole line: nothing is known.
    pub const ALL: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The interval that contains only one number; the whole line if the number is not finite.
    #[inline(always)]
    pub fn point(x: f64) -> Interval {
        if x.is_finite() { Interval { low: x, high: x } } else { Interval::ALL }
    }

    /// The interval between two bounds in either order; the whole line if one is not a number.
    #[inline(always)]
    pub fn new(a: f64, b: f64) -> Interval {
        if a.is_nan() || b.is_nan() {
            return Interval::ALL;
        }
        Interval { low: a.min(b), high: a.max(b) }
    }

    /// Bounds that were rounded to nearest, moved outward.
    #[inline(always)]
    fn outward(low: f64, high: f64) -> Interval {
        if low.is_nan() || high.is_nan() {
            return Interval::ALL;
        }
        Interval { low: low.next_down(), high: high.next_up() }
    }

    /// Whether the number lies in the interval.
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// Whether every number of `other` lies in the interior.
    pub fn contains_in_interior(self, other: Interval) -> bool {
        self.low < other.low && other.high < self.high
    }

    /// Whether the two intervals have a number in common.
    pub fn meets(self, other: Interval) -> bool {
        self.low <= other.high && other.low <= self.high
    }

    /// Half the width, rounded up.
    pub fn radius(self) -> f64 {
        ((self.high - self.low).next_up() * 0.5).next_up()
    }

    /// A number near the middle.
    pub fn midpoint(self) -> f64 {
        self.low.midpoint(self.high)
    }

    /// Largest absolute value.
    pub fn magnitude(self) -> f64 {
        self.low.abs().max(self.high.abs())
    }

    /// `self + b`
    #[inline(always)]
    pub fn plus(self, b: Interval) -> Interval {
        Interval::outward(self.low + b.low, self.high + b.high)
    }

    /// `self - b`
    #[inline(always)]
    pub fn minus(self, b: Interval) -> Interval {
        Interval::outward(self.low - b.high, self.high - b.low)
    }

    /// `-self`
    #[inline(always)]
    pub fn negated(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }

    /// `self * b`
    #[inline(always)]
    pub fn times(self, b: Interval) -> Interval {
        let (p, q, r, s) = (self.low * b.low, self.low * b.high, self.high * b.low, self.high * b.high);
        if (p + q + r + s).is_nan() && [p, q, r, s].iter().any(|z| z.is_nan()) {
            return Interval::ALL;
        }
        Interval::outward(p.min(q).min(r.min(s)), p.max(q).max(r.max(s)))
    }

    /// `self * self`, never below zero.
    #[inline(always)]
    pub fn squared(self) -> Interval {
        let (p, q) = (self.low * self.low, self.high * self.high);
        let low = if self.contains(0.0) { 0.0 } else { p.min(q).next_down().max(0.0) };
        Interval { low, high: p.max(q).next_up() }
    }

    /// `1 / self`; the whole line if zero lies in it.
    #[inline(always)]
    pub fn reciprocal(self) -> Interval {
        if self.contains(0.0) {
            return Interval::ALL;
        }
        Interval::outward(1.0 / self.high, 1.0 / self.low)
    }
}

/// A rectangle in the complex plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexInterval {
    /// Real parts.
    pub re: Interval,
    /// Imaginary parts.
    pub im: Interval,
}

impl ComplexInterval {
    /// The rectangle that contains only one number; the whole plane if the number is not finite.
    pub fn point(z: Complex64) -> ComplexInterval {
        ComplexInterval { re: Interval::point(z.re), im: Interval::point(z.im) }
    }

    /// The square around a number with half-width `radius`, rounded outward.
    pub fn around(z: Complex64, radius: f64) -> ComplexInterval {
        let r = Interval::new(-radius, radius);
        ComplexInterval { re: Interval::point(z.re).plus(r), im: Interval::point(z.im).plus(r) }
    }

    /// Whether the number lies in the rectangle.
    pub fn contains(&self, z: Complex64) -> bool {
        self.re.contains(z.re) && self.im.contains(z.im)
    }

    /// Whether every number of `other` lies in the interior.
    pub fn contains_in_interior(&self, other: &ComplexInterval) -> bool {
        self.re.contains_in_interior(other.re) && self.im.contains_in_interior(other.im)
    }

    /// Whether the two rectangles have a number in common.
    pub fn meets(&self, other: &ComplexInterval) -> bool {
        self.re.meets(other.re) && self.im.meets(other.im)
    }

    /// A number near the middle.
    pub fn midpoint(&self) -> Complex64 {
        Complex64::new(self.re.midpoint(), self.im.midpoint())
    }

    /// The larger half-width, rounded up.
    pub fn radius(&self) -> f64 {
        self.re.radius().max(self.im.radius())
    }

    /// An upper bound on the modulus.
    pub fn magnitude(&self) -> f64 {
        let (a, b) = (self.re.magnitude(), self.im.magnitude());
        ((a * a).next_up() + (b * b).next_up()).next_up().sqrt().next_up()
    }
}

/// A constant as high and low part, exactly where the low part is zero.
#[inline(always)]
fn enclose([high, low]: [f64; 2]) -> Interval {
    if low == 0.0 {
        return Interval::point(high);
    }
    // The low part is itself rounded: one step outward covers it before the sum takes another.
    Interval::point(high).plus(Interval::outward(low, low))
}

impl Scalar for ComplexInterval {
    #[inline(always)]
    fn zero() -> Self {
        ComplexInterval { re: Interval { low: 0.0, high: 0.0 }, im: Interval { low: 0.0, high: 0.0 } }
    }
    #[inline(always)]
    fn one() -> Self {
        ComplexInterval { re: Interval { low: 1.0, high: 1.0 }, im: Interval { low: 0.0, high: 0.0 } }
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        ComplexInterval::point(z)
    }
    #[inline(always)]
    fn from_parts(re: [f64; 2], im: [f64; 2]) -> Self {
        ComplexInterval { re: enclose(re), im: enclose(im) }
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        ComplexInterval { re: a.re.plus(b.re), im: a.im.plus(b.im) }
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        ComplexInterval { re: a.re.minus(b.re), im: a.im.minus(b.im) }
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        ComplexInterval { re: a.re.times(b.re).minus(a.im.times(b.im)), im: a.re.times(b.im).plus(a.im.times(b.re)) }
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        Self::mul(a, &Self::inv(b))
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        ComplexInterval { re: a.re.negated(), im: a.im.negated() }
    }
    #[inline(always)]
    fn sqr(a: &Self) -> Self {
        let cross = a.re.times(a.im);
        ComplexInterval { re: a.re.squared().minus(a.im.squared()), im: cross.plus(cross) }
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        let r = a.re.squared().plus(a.im.squared()).reciprocal();
        ComplexInterval { re: a.re.times(r), im: a.im.times(r).negated() }
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        ComplexInterval { re: a.re.times(r.re), im: a.im.times(r.re) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Exact;
    use crate::dd::Dd;
    use crate::{ComplexDd, Evaluate, Isa, parse};
    use num_rational::BigRational;

    /// A fixed stream of numbers of widely different sizes.
    struct Stream(u64);

    impl Stream {
        fn next(&mut self) -> f64 {
            let mut step = || {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                self.0 >> 11
            };
            let mantissa = step() as f64 / (1u64 << 52) as f64 - 1.0;
            mantissa * 2f64.powi((step() >> 30) as i32 % 60 - 30)
        }
        fn interval(&mut self) -> Interval {
            let (a, b) = (self.next(), self.next());
            if (self.0 >> 20).is_multiple_of(3) { Interval::point(a) } else { Interval::new(a, b) }
        }
        /// A number in the interval, its ends included.
        fn member(&mut self, i: Interval) -> f64 {
            match (self.0 >> 25) % 4 {
                0 => i.low,
                1 => i.high,
                _ => (i.low + self.next().abs().fract() * (i.high - i.low)).clamp(i.low, i.high),
            }
        }
    }

    /// Whether a number known to 30 digits lies in an interval whose ends are at least a step away
    /// from it.
    fn holds(i: Interval, x: Dd) -> bool {
        let above = i.low == f64::NEG_INFINITY || x.minus(Dd::new(i.low)).high >= 0.0;
        let below = i.high == f64::INFINITY || Dd::new(i.high).minus(x).high >= 0.0;
        above && below
    }

    #[test]
    fn two_million_random_operations_contain_the_exact_result() {
        let mut stream = Stream(7);
        for _ in 0..400_000 {
            let (a, b) = (stream.interval(), stream.interval());
            let (x, y) = (stream.member(a), stream.member(b));
            let (dx, dy) = (Dd::new(x), Dd::new(y));
            assert!(holds(a.plus(b), dx.plus(dy)), "{a:?} + {b:?}");
            assert!(holds(a.minus(b), dx.minus(dy)), "{a:?} - {b:?}");
            assert!(holds(a.times(b), dx.times(dy)), "{a:?} * {b:?}");
            assert!(holds(a.squared(), dx.times(dx)), "{a:?}^2");
            if y != 0.0 {
                assert!(holds(b.reciprocal(), dy.reciprocal()), "1/{b:?}");
            }
        }
    }

    #[test]
    fn complex_operations_contain_the_exact_result() {
        let mut stream = Stream(11);
        for _ in 0..100_000 {
            let mut number = || {
                let (re, im) = (stream.interval(), stream.interval());
                let z = Complex64::new(stream.member(re), stream.member(im));
                (ComplexInterval { re, im }, ComplexDd::new(z))
            };
            let ((a, x), (b, y)) = (number(), number());
            let check =
                |i: ComplexInterval, z: ComplexDd| assert!(holds(i.re, z.re) && holds(i.im, z.im), "{a:?} {b:?}");
            check(ComplexInterval::mul(&a, &b), ComplexDd::mul(&x, &y));
            check(ComplexInterval::sqr(&a), ComplexDd::sqr(&x));
            check(ComplexInterval::mul_mul_sub(&a, &b, &b, &b), ComplexDd::mul_mul_sub(&x, &y, &y, &y));
            check(ComplexInterval::div(&a, &b), ComplexDd::div(&x, &y));
        }
    }

    #[test]
    fn programs_run_over_intervals_and_constants_are_enclosed() {
        let text = "name = 'f'\nunknowns = ['x']\nequations = ['x^5/3 - 0.1*x^2 + 1/(x - 7)']";
        let f = parse::family(text).unwrap().system.compile().unwrap();
        for k in 0..1000 {
            let z = Complex64::from_polar(0.5 + 0.001 * f64::from(k), f64::from(k));
            let (mut i, mut d) = ([ComplexInterval::zero()], [ComplexDd::zero()]);
            f.values(&mut f.memory(Isa::detect()), &[ComplexInterval::point(z)], &[], &mut i);
            f.values(&mut f.memory(Isa::detect()), &[ComplexDd::new(z)], &[], &mut d);
            assert!(holds(i[0].re, d[0].re) && holds(i[0].im, d[0].im));
            assert!(i[0].radius() < 1e-13);
        }
    }

    #[test]
    fn constants_that_are_no_doubles_are_enclosed() {
        let power = |k: u32| BigRational::new(1.into(), num_bigint::BigInt::from(10).pow(k));
        let one = BigRational::from_integer(1.into());
        // The second and third differ from doubles by less than the least one.
        for q in [
            power(1),
            power(400),
            &one + power(400),
            &one - power(400),
            power(310),
            &one / BigRational::from_integer(3.into()),
        ] {
            let c = ComplexInterval::from_exact(&Exact::new(q.clone(), -q.clone())).re;
            let [low, high] = [c.low, c.high].map(|x| BigRational::from_float(x).unwrap());
            assert!(low < q && q < high, "{c:?}");
            assert!(c.high - c.low <= 4.0 * (c.high.next_up() - c.high));
        }
    }

    #[test]
    fn nothing_known_stays_contained() {
        let zero = ComplexInterval::zero();
        let all = ComplexInterval::inv(&zero);
        assert!(all.contains(Complex64::new(1e300, -1e300)));
        assert!(ComplexInterval::mul(&all, &zero).contains(Complex64::new(5.0, 5.0)));
        let huge = Interval::point(f64::MAX);
        assert_eq!(huge.plus(huge).high, f64::INFINITY);
        assert!(huge.plus(huge).low <= f64::MAX);
        assert_eq!(Interval::point(f64::NAN), Interval::ALL);
    }
}
