//! Complex balls: a midpoint of about 32 digits and a radius that bounds its error.
//!
//! Midpoints follow the double-double algorithms of [`Dd`]. Their proven relative error bounds
//! (Joldes, Muller, Popescu, ACM TOMS 44, 2017: 3u^2 for sums, 5u^2 for products, u = 2^-53) go
//! into the radius, which is rounded up. [`ComplexInterval`] is faster, and better for wide sets;
//! balls are for residuals at one point.

use crate::dd::{ComplexDd, Dd};
use crate::interval::{ComplexInterval, Interval};
use crate::scalar::Scalar;
use crate::simd::Isa;
use num_complex::Complex64;

/// Relative error of one double-double sum or product: `8 u^2 = 2^-103`, above both proven bounds.
const ERROR: f64 = 1.0 / ((1u128 << 103) as f64);
/// Covers products so small that their low parts underflow.
const UNDERFLOW: f64 = 1e-280;

/// A set of real numbers: all that lie within a radius of a double-double midpoint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// The midpoint.
    pub mid: Dd,
    /// The radius; infinite where nothing is known.
    pub radius: f64,
}

/// `a + b` of two numbers that are not negative, rounded up.
#[inline(always)]
fn up_sum(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { a + b } else { (a + b).next_up() }
}

/// `a * b` of two numbers that are not negative, rounded up.
#[inline(always)]
fn up_product(a: f64, b: f64) -> f64 {
    // Zero times infinity is not a number, which no ball admits as a radius.
    let product = a * b;
    if a == 0.0 || b == 0.0 { product } else { product.next_up() }
}

/// An upper bound on the absolute value.
#[inline(always)]
fn size(a: Dd) -> f64 {
    up_sum(a.high.abs(), a.low.abs())
}

impl Ball {
    /// The ball of all numbers.
    pub const ALL: Ball = Ball { mid: Dd { high: 0.0, low: 0.0 }, radius: f64::INFINITY };

    /// The ball with this midpoint and radius; all numbers if one of the two is not finite.
    #[inline(always)]
    pub fn new(mid: Dd, radius: f64) -> Ball {
        if mid.high.is_finite() && mid.low.is_finite() && radius < f64::INFINITY {
            Ball { mid, radius }
        } else {
            Ball::ALL
        }
    }

    /// The ball that contains only one double.
    pub fn point(x: f64) -> Ball {
        Ball::new(Dd::new(x), 0.0)
    }

    /// A ball that contains the interval.
    pub fn containing(interval: Interval) -> Ball {
        if interval.low == interval.high {
            return Ball::point(interval.low);
        }
        let mid = interval.midpoint();
        Ball::new(Dd::new(mid), (interval.high - mid).max(mid - interval.low).next_up())
    }

    /// An interval that contains the ball.
    pub fn interval(self) -> Interval {
        if self.radius == f64::INFINITY {
            return Interval::ALL;
        }
        let rest = Interval::point(self.mid.low).plus(Interval { low: -self.radius, high: self.radius });
        Interval::point(self.mid.high).plus(rest)
    }

    /// An upper bound on the absolute value.
    #[inline(always)]
    pub fn magnitude(self) -> f64 {
        up_sum(size(self.mid), self.radius)
    }

    /// A result, with the rounding error of its midpoint added to the radius.
    #[inline(always)]
    fn rounded(mid: Dd, radius: f64) -> Ball {
        Ball::new(mid, up_sum(radius, up_sum(up_product(size(mid), ERROR), UNDERFLOW)))
    }

    /// `self + b`
    #[inline(always)]
    pub fn plus(self, b: Ball) -> Ball {
        Ball::rounded(self.mid.plus(b.mid), up_sum(self.radius, b.radius))
    }

    /// `-self`
    #[inline(always)]
    pub fn negated(self) -> Ball {
        Ball { mid: self.mid.negated(), radius: self.radius }
    }

    /// `self - b`
    #[inline(always)]
    pub fn minus(self, b: Ball) -> Ball {
        self.plus(b.negated())
    }

    /// `self * b`
    #[inline(always)]
    pub fn times(self, b: Ball) -> Ball {
        let radius = up_sum(up_product(self.magnitude(), b.radius), up_product(size(b.mid), self.radius));
        Ball::rounded(self.mid.times(b.mid), radius)
    }

    /// `1 / self`; all numbers if zero lies in the ball.
    ///
    /// For the approximate reciprocal `r` of the midpoint `m` and any `a` within the radius `e`,
    /// `|1/a - r| = |1 - a r| / |a| <= (|1 - m r| + e |r|) / (|m| - e)`.
    #[inline(always)]
    pub fn reciprocal(self) -> Ball {
        let least = (self.mid.high.abs().next_down() - self.mid.low.abs()).next_down();
        let least = (least - self.radius).next_down();
        if least.is_nan() || least <= 0.0 {
            return Ball::ALL;
        }
        let r = self.mid.reciprocal();
        let defect = Ball { mid: self.mid, radius: 0.0 }.times(Ball { mid: r, radius: 0.0 }).minus(Ball::point(1.0));
        let bound = up_sum(defect.magnitude(), up_product(self.radius, size(r)));
        Ball::new(r, (bound / least).next_up())
    }
}

/// A set of complex numbers: a ball of real parts and a ball of imaginary parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComplexBall {
    /// Real part.
    pub re: Ball,
    /// Imaginary part.
    pub im: Ball,
}

impl ComplexBall {
    /// The ball that contains only one double-double number.
    pub fn point(z: &ComplexDd) -> ComplexBall {
        // The sum of two doubles is exact; the bounds hold where the low part is below half an ulp.
        let normal = |a: Dd| Dd::new(a.high).plus(Dd::new(a.low));
        ComplexBall { re: Ball::new(normal(z.re), 0.0), im: Ball::new(normal(z.im), 0.0) }
    }

    /// A ball that contains the rectangle.
    pub fn containing(set: &ComplexInterval) -> ComplexBall {
        ComplexBall { re: Ball::containing(set.re), im: Ball::containing(set.im) }
    }

    /// A rectangle that contains the ball.
    pub fn interval(&self) -> ComplexInterval {
        ComplexInterval { re: self.re.interval(), im: self.im.interval() }
    }

    /// The double nearest to the midpoint.
    pub fn midpoint(&self) -> Complex64 {
        Complex64::new(self.re.mid.high, self.im.mid.high)
    }

    /// Whether both radii are finite.
    pub fn is_finite(&self) -> bool {
        self.re.radius < f64::INFINITY && self.im.radius < f64::INFINITY
    }
}

/// A constant of about 32 digits; the low part is zero only where the high part is exact.
#[inline(always)]
fn constant([high, low]: [f64; 2]) -> Ball {
    // The low part is rounded to nearest.
    let radius = if low == 0.0 { 0.0 } else { (low.abs() * f64::EPSILON).next_up() };
    Ball::new(Dd { high, low }, radius)
}

impl Scalar for ComplexBall {
    /// For the fused products of [`Dd`].
    const WIDEST: Isa = Isa::Avx2;

    #[inline(always)]
    fn zero() -> Self {
        ComplexBall { re: Ball { mid: Dd::default(), radius: 0.0 }, im: Ball { mid: Dd::default(), radius: 0.0 } }
    }
    #[inline(always)]
    fn one() -> Self {
        ComplexBall { re: Ball { mid: Dd::new(1.0), radius: 0.0 }, ..Self::zero() }
    }
    #[inline(always)]
    fn from_c64(z: Complex64) -> Self {
        ComplexBall { re: Ball::point(z.re), im: Ball::point(z.im) }
    }
    #[inline(always)]
    fn from_parts(re: [f64; 2], im: [f64; 2]) -> Self {
        ComplexBall { re: constant(re), im: constant(im) }
    }
    #[inline(always)]
    fn add(a: &Self, b: &Self) -> Self {
        ComplexBall { re: a.re.plus(b.re), im: a.im.plus(b.im) }
    }
    #[inline(always)]
    fn sub(a: &Self, b: &Self) -> Self {
        ComplexBall { re: a.re.minus(b.re), im: a.im.minus(b.im) }
    }
    #[inline(always)]
    fn mul(a: &Self, b: &Self) -> Self {
        ComplexBall { re: a.re.times(b.re).minus(a.im.times(b.im)), im: a.re.times(b.im).plus(a.im.times(b.re)) }
    }
    #[inline(always)]
    fn div(a: &Self, b: &Self) -> Self {
        Self::mul(a, &Self::inv(b))
    }
    #[inline(always)]
    fn neg(a: &Self) -> Self {
        ComplexBall { re: a.re.negated(), im: a.im.negated() }
    }
    #[inline(always)]
    fn inv(a: &Self) -> Self {
        let r = a.re.times(a.re).plus(a.im.times(a.im)).reciprocal();
        ComplexBall { re: a.re.times(r), im: a.im.times(r).negated() }
    }
    #[inline(always)]
    fn mul_real(a: &Self, r: &Self) -> Self {
        ComplexBall { re: a.re.times(r.re), im: a.im.times(r.re) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Evaluate, Exact, Isa, Rational, parse};
    use num_rational::BigRational;
    use num_traits::Signed;
    use proptest::prelude::*;

    fn exact(x: f64) -> BigRational {
        BigRational::from_float(x).expect("a finite double")
    }

    fn holds(ball: Ball, value: &BigRational) -> bool {
        let mid = exact(ball.mid.high) + exact(ball.mid.low);
        ball.radius == f64::INFINITY || (mid - value).abs() <= exact(ball.radius)
    }

    /// A ball and a number in it.
    fn ball() -> impl Strategy<Value = (Ball, BigRational)> {
        let parts = (-1.0..1.0f64, -60..60i32, -1.0..1.0f64, prop_oneof![Just(0.0), 0.0..1e-3f64], -1.0..1.0f64);
        parts.prop_map(|(m, e, l, r, share)| {
            let high = m * 2f64.powi(e);
            let mid = Dd::new(high).plus(Dd::new(high * l * f64::EPSILON));
            let radius = high.abs() * r;
            (Ball { mid, radius }, exact(mid.high) + exact(mid.low) + exact(radius) * exact(share))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn operations_contain_the_exact_result((a, x) in ball(), (b, y) in ball()) {
            prop_assert!(holds(a.plus(b), &(&x + &y)));
            prop_assert!(holds(a.minus(b), &(&x - &y)));
            prop_assert!(holds(a.times(b), &(&x * &y)));
            if b.mid.high != 0.0 {
                prop_assert!(holds(b.reciprocal(), &y.recip()));
                prop_assert!(b.reciprocal().radius < f64::INFINITY);
            }
            let interval = a.interval();
            prop_assert!(exact(interval.low) <= x && x <= exact(interval.high));
            let again = Ball::containing(interval);
            prop_assert!(holds(again, &x));
        }
    }

    #[test]
    fn programs_over_balls_contain_the_exact_values_and_are_narrow() {
        let text = "name = 'f'\nunknowns = ['x', 'y']\nequations = ['(x - 0.1*y)^5/3 - 0.7*x^2 + 1/(x - 7*y) + i*y']";
        let f = parse::family(text).unwrap().system.compile().unwrap();
        for k in 1..200i32 {
            let (x, y) = (f64::from(k) / 7.0, f64::from(k % 13 - 6) / 11.0);
            let rational = |x: f64| Exact::new(exact(x), exact(0.0));
            let mut value = [ComplexBall::zero()];
            f.values(&mut f.memory(Isa::detect()), &[x, y].map(|x| ComplexBall::from_c64(x.into())), &[], &mut value);
            let mut precise = [Rational::integer(0)];
            f.values(&mut f.memory(Isa::Portable), &[x, y].map(|x| Rational::new(rational(x))), &[], &mut precise);
            let Some(precise) = &precise[0].0 else { continue };
            assert!(holds(value[0].re, &precise.re) && holds(value[0].im, &precise.im), "{value:?}");
            assert!(value[0].re.radius <= 1e-28 * (1.0 + x.powi(5)), "{value:?}");
        }
    }

    #[test]
    fn nothing_known_stays_nothing_known() {
        assert_eq!(Ball::point(0.0).reciprocal(), Ball::ALL);
        assert_eq!(Ball::point(f64::NAN), Ball::ALL);
        assert_eq!(Ball::point(1e300).times(Ball::point(1e300)), Ball::ALL);
        assert_eq!(Ball::ALL.interval(), Interval::ALL);
        assert_eq!(Ball::ALL.times(Ball::point(0.0)).radius, f64::INFINITY);
    }
}
