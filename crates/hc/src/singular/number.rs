//! Complex numbers, mostly with more digits than doubles, as far as the local algebra needs them.

use num_complex::Complex64;
use poly::Dd;
use poly::{ComplexDd, ComplexMulti, Scalar};

/// A complex number type.
pub(crate) trait Number: Scalar + Copy {
    /// Binary digits that a product keeps.
    const BITS: f64;

    /// The logarithm to base 2 of the size of the larger part: negative infinity for zero, NaN if the
    /// number is NaN.
    fn log2(&self) -> f64;

    /// Whether the number is zero.
    fn vanishes(&self) -> bool;

    /// `self * 2^k`
    fn shifted(&self, k: i64) -> Self;

    /// The complex conjugate.
    fn conjugate(&self) -> Self;

    /// The nearest complex double.
    fn to_c64(&self) -> Complex64;
}

impl Number for Complex64 {
    const BITS: f64 = 52.0;

    fn log2(&self) -> f64 {
        if self.is_nan() { f64::NAN } else { self.re.abs().max(self.im.abs()).log2() }
    }

    fn vanishes(&self) -> bool {
        *self == Complex64::new(0.0, 0.0)
    }

    fn shifted(&self, k: i64) -> Self {
        let (a, b) = powers_of_two(k);
        self * a * b
    }

    fn conjugate(&self) -> Self {
        self.conj()
    }

    fn to_c64(&self) -> Complex64 {
        *self
    }
}

/// Two powers of two with the product `2^k`, which may be out of range alone.
fn powers_of_two(k: i64) -> (f64, f64) {
    let k = k.clamp(-2000, 2000) as i32;
    (2f64.powi(k / 2), 2f64.powi(k - k / 2))
}

impl Number for ComplexDd {
    const BITS: f64 = 104.0;

    fn log2(&self) -> f64 {
        let z = self.high();
        if z.is_nan() { f64::NAN } else { z.re.abs().max(z.im.abs()).log2() }
    }

    fn vanishes(&self) -> bool {
        self.high() == Complex64::new(0.0, 0.0)
    }

    fn shifted(&self, k: i64) -> Self {
        let (a, b) = powers_of_two(k);
        let part = |x: Dd| Dd { high: x.high * a * b, low: x.low * a * b };
        ComplexDd { re: part(self.re), im: part(self.im) }
    }

    fn conjugate(&self) -> Self {
        ComplexDd { re: self.re, im: self.im.negated() }
    }

    fn to_c64(&self) -> Complex64 {
        self.high()
    }
}

impl<const LIMBS: usize> Number for ComplexMulti<LIMBS> {
    const BITS: f64 = 64.0 * LIMBS as f64;

    fn log2(&self) -> f64 {
        ComplexMulti::log2(self)
    }

    fn vanishes(&self) -> bool {
        self.re.is_zero() && self.im.is_zero()
    }

    fn shifted(&self, k: i64) -> Self {
        ComplexMulti::shifted(self, k)
    }

    fn conjugate(&self) -> Self {
        ComplexMulti { re: self.re, im: self.im.negated() }
    }

    fn to_c64(&self) -> Complex64 {
        ComplexMulti::to_c64(self)
    }
}

/// The largest [`log2`](Number::log2) of some numbers: negative infinity if there are none, NaN if one
/// of them is NaN.
pub(crate) fn largest<'a, S: Number>(numbers: impl IntoIterator<Item = &'a S>) -> f64 {
    let mut largest = f64::NEG_INFINITY;
    for number in numbers {
        let size = number.log2();
        if size.is_nan() {
            return f64::NAN;
        }
        largest = largest.max(size);
    }
    largest
}
