//! Double-double arithmetic beside a reference crate, `twofloat`, on random numbers of widely
//! different sizes.
//!
//! Both follow Joldes, Muller, Popescu (ACM TOMS 44, 2017), by different algorithms in part: two
//! results may differ by the sum of the relative error bounds proved there, in units of u^2 =
//! 2^-106.

use poly::Dd;
use twofloat::TwoFloat;

/// Error bounds of both implementations together.
const SUM: f64 = 3.0 + 3.0;
const PRODUCT: f64 = 5.0 + 5.0;
/// Our reciprocal and their product. (Their quotient, in version 0.8.4, errs by up to half an ulp
/// of a double: exact rationals say so, and it is no reference here.)
const INVERSE: f64 = 16.0 + 5.0;

struct Stream(u64);

impl Stream {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 11
    }

    /// In [-1, 1).
    fn unit(&mut self) -> f64 {
        self.bits() as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A number of either sign between about 2^-60 and 2^60 with all digits random.
    fn number(&mut self) -> (Dd, TwoFloat) {
        let high = self.unit() * 2f64.powi((self.bits() % 121) as i32 - 60);
        let low = high * self.unit() * f64::EPSILON / 2.0;
        let theirs = TwoFloat::new_add(high, low);
        (Dd { high: theirs.hi(), low: theirs.lo() }, theirs)
    }
}

/// `|a - b| / |a|` in units of 2^-106; the difference of numbers this close is exact.
fn distance(a: Dd, b: TwoFloat) -> f64 {
    let difference = (a.high - b.hi()) + (a.low - b.lo());
    if difference == 0.0 { 0.0 } else { (difference / a.high).abs() * 2f64.powi(106) }
}

#[test]
fn half_a_million_operations_agree_with_the_reference() {
    let mut stream = Stream(5);
    for _ in 0..100_000 {
        let ((a, ra), (b, rb)) = (stream.number(), stream.number());
        for (name, ours, theirs, bound) in [
            ("+", a.plus(b), ra + rb, SUM),
            ("-", a.minus(b), ra - rb, SUM),
            ("*", a.times(b), ra * rb, PRODUCT),
            ("1/", Dd::new(1.0), ra * TwoFloat::new_add(a.reciprocal().high, a.reciprocal().low), INVERSE),
            ("negative", a.negated(), -ra, 0.0),
        ] {
            let found = distance(ours, theirs);
            assert!(found <= bound, "{name} of {a:?} and {b:?}: {ours:?}, {theirs:?} differ by {found}");
        }
    }
}

#[test]
fn sums_that_cancel_agree_with_the_reference() {
    let mut stream = Stream(6);
    for _ in 0..100_000 {
        let (a, ra) = stream.number();
        let change = stream.unit() * 2f64.powi(-((stream.bits() % 50) as i32));
        let b = a.times(Dd::new(1.0 + change));
        let rb = TwoFloat::new_add(b.high, b.low);
        let found = distance(a.minus(b), ra - rb);
        assert!(found <= SUM, "{a:?} - {b:?} differ by {found}");
    }
}
