//! The predictor for coordinates that behave like `exp(v t)`, all lanes at once.
//!
//! Near its end a path is of order `t^v`, coordinate by coordinate, so that in logarithmic time its
//! logarithms are nearly straight lines. The Pade approximant of the logarithm is then good for a step many
//! times longer than that of the coordinate itself.

use crate::tolerances::tracking;
use poly::Lane;
use poly::simd::{Isa, Kernel};

/// The argument of the exponential function is halved so many times.
const HALVINGS: usize = 4;

/// Replaces Taylor coefficients `x_k` of a coordinate by `y_k = x_0 c_k`, where
/// `x_0 exp(c_1 d + c_2 d^2 + c_3 d^3)` has the same coefficients up to order 3: the predictor then
/// extrapolates the logarithm, in units of the coordinate. `y_0 = x_0`.
pub(super) struct Logarithms<'a, S: Lane> {
    /// Taylor coefficients of orders 0 to 3, `n` each.
    pub(super) taylor: &'a [S],
    /// The lanes in which logarithms are taken.
    pub(super) lanes: u16,
    /// The `y_k`, in the order of `taylor`; where no logarithm is taken, the `x_k`.
    pub(super) series: &'a mut [S],
    /// For each coordinate, the lanes in which its logarithm was taken: not where it is nearly zero.
    pub(super) masks: &'a mut [u16],
}

impl<S: Lane> Kernel for Logarithms<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let (n, x) = (self.masks.len(), self.taylor);
        for j in 0..n {
            let sizes = [x[j].norm_sqr(), x[n + j].norm_sqr(), x[2 * n + j].norm_sqr(), x[3 * n + j].norm_sqr()];
            let mut mask = 0u16;
            for l in 0..S::LANES {
                let size = |k: usize| sizes[k].as_ref()[l];
                let most = tracking::STEEPEST * tracking::STEEPEST;
                let bounds = [1.0, most, most * most, most * most * most];
                // Written so that NaN does not count.
                let mut counts = size(0) > f64::MIN_POSITIVE;
                for k in 1..4 {
                    counts &= size(k) <= bounds[k] * size(0);
                }
                mask |= u16::from(counts) << l;
            }
            mask &= self.lanes;
            self.masks[j] = mask;
            let half = S::real(0.5);
            let c1 = S::div(&x[n + j], &x[j]);
            let y2 = S::sub(&x[2 * n + j], &S::mul(&c1, &x[n + j]).scale_by(&half));
            let cube = S::mul(&S::sqr(&c1), &x[n + j]).scale_by(&S::real(1.0 / 6.0));
            let y3 = S::sub(&x[3 * n + j], &S::add(&S::mul(&c1, &y2), &cube));
            self.series[j] = x[j];
            self.series[n + j] = x[n + j];
            self.series[2 * n + j] = S::select(&x[2 * n + j], &y2, mask);
            self.series[3 * n + j] = S::select(&x[3 * n + j], &y3, mask);
        }
    }
}

/// Replaces predictions `x + y` from [`Logarithms`] by `x exp(y / x)`, in the coordinates and lanes of `masks`.
pub(super) struct Exponentials<'a, S: Lane> {
    /// The points from which the predictions lead.
    pub(super) x: &'a [S],
    pub(super) masks: &'a [u16],
    pub(super) predicted: &'a mut [S],
}

impl<S: Lane> Kernel for Exponentials<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        for (j, x) in self.x.iter().enumerate() {
            let change = S::div(&S::sub(&self.predicted[j], x), x).scale_by(&S::real(1.0 / (1 << HALVINGS) as f64));
            // For the corrector, six digits of the exponential function are enough.
            let mut power = number::<S>(1.0 / 720.0);
            for inverse in [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
                power = S::mul_add(&power, &change, &number::<S>(inverse));
            }
            for _ in 0..HALVINGS {
                power = S::sqr(&power);
            }
            self.predicted[j] = S::select(&self.predicted[j], &S::mul(x, &power), self.masks[j]);
        }
    }
}

#[inline(always)]
fn number<S: Lane>(x: f64) -> S {
    S::from_c64(x.into())
}

#[cfg(test)]
mod tests {
    use super::{Exponentials, Logarithms};
    use crate::tracker::kernels::Predict;
    use num_complex::Complex64;
    use poly::simd::Isa;

    /// Coordinates `a exp(v t) (1 + b t)` and one that is zero.
    #[test]
    fn powers_are_predicted_far_and_zeros_as_before() {
        let z = Complex64::new;
        let (a, v, b) = (z(3.0, -1.0), z(0.5, 2.0), z(1e-3, 2e-3));
        let exact = |t: f64| a * (v * t).exp() * (1.0 + b * t);
        let taylor = [
            [a, z(0.0, 0.0)],
            [a * (v + b), z(1.0, 0.0)],
            [a * (v * v / 2.0 + v * b), z(0.0, 1.0)],
            [a * (v * v * v / 6.0 + v * v * b / 2.0), z(0.5, 0.0)],
        ]
        .concat();
        let (mut series, mut masks) = (vec![z(0.0, 0.0); 8], [0u16; 2]);
        let predict = |taylor: &[Complex64]| {
            let mut out = [z(0.0, 0.0); 2];
            Isa::detect().run(Predict { taylor, step: [1.5], radius_sqr: [100.0], out: &mut out });
            out
        };
        let plain = predict(&taylor);
        Isa::detect().run(Logarithms { taylor: &taylor, lanes: 1, series: &mut series, masks: &mut masks });
        assert_eq!(masks, [1, 0]);
        let mut predicted = predict(&series);
        Isa::detect().run(Exponentials { x: &taylor[..2], masks: &masks, predicted: &mut predicted });
        assert!((plain[0] - exact(1.5)).norm() > 1.0, "{plain:?}");
        assert!((predicted[0] - exact(1.5)).norm() < 1e-6, "{predicted:?}");
        assert_eq!(predicted[1], plain[1]);
        // In no lane: nothing changes.
        Isa::detect().run(Logarithms { taylor: &taylor, lanes: 0, series: &mut series, masks: &mut masks });
        assert!(masks == [0, 0] && series == taylor);
    }
}
