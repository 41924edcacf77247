//! The tracker's arithmetic over coordinates, all lanes at once: predictor, radius of trust,
//! weights and norms.
//!
//! All lengths are relative to weights, `|x| = max_j |x_j| / w_j`. Squares are kept, so that no
//! root is taken per coordinate.

use crate::homotopy::ParameterPath;
use crate::tolerances::tracking;
use poly::Lane;
use poly::simd::{Isa, Kernel};

/// Pade predictor of type [2/1], coordinate by coordinate (Timme 2020, section 4):
/// `x + d (x1 + d x2 / (1 - d x3 / x2))`, and the Taylor polynomial of order 2 where `x2` or `x3`
/// is negligible.
pub(crate) struct Predict<'a, S: Lane> {
    /// Taylor coefficients of orders 0 to 3, `n` each.
    pub(crate) taylor: &'a [S],
    /// Signed step in `t`.
    pub(crate) step: S::Real,
    /// Square of the radius of trust.
    pub(crate) radius_sqr: S::Real,
    pub(crate) out: &'a mut [S],
}

impl<S: Lane> Kernel for Predict<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let n = self.out.len();
        let (x0, rest) = self.taylor.split_at(n);
        let (x1, rest) = rest.split_at(n);
        let (x2, x3) = rest.split_at(n);
        let x3 = &x3[..n];
        for j in 0..n {
            let sizes = [x0[j].norm_sqr(), x1[j].norm_sqr(), x2[j].norm_sqr(), x3[j].norm_sqr()];
            let mut negligible = 0u16;
            for l in 0..S::LANES {
                let r = self.radius_sqr.as_ref()[l];
                let second = sizes[2].as_ref()[l] * (r * r);
                let third = sizes[3].as_ref()[l] * (r * r * r);
                let all = sizes[0].as_ref()[l] + sizes[1].as_ref()[l] * r + second + third;
                // Written so that NaN counts as negligible.
                negligible |= u16::from(!(second > 1e-24 * all && third > 1e-24 * all)) << l;
            }
            let pade = S::div(&S::sqr(&x2[j]), &S::sub(&x2[j], &x3[j].scale_by(&self.step)));
            let second = S::select(&pade, &x2[j], negligible);
            let slope = S::add(&x1[j], &second.scale_by(&self.step));
            self.out[j] = S::add(&x0[j], &slope.scale_by(&self.step));
        }
    }
}

/// Square of the radius of trust: the smallest `r_j = |x2_j / x3_j|`, the distance to the pole of
/// the approximant and an estimate of the distance to the nearest singularity of the path (Fabry's
/// ratio).
///
/// A part of the path that varies quickly but hardly at all, such as a term of a toric homotopy
/// that is still fading in, must not hold up the rest: where `a_j = omega |x2_j| r_j^2` is less
/// than `tracking::FAINT`, `r_j` counts
/// `1 + ln(faint / a_j) / 3` times, at most
/// `tracking::FAINT_REACH`. For `exp(c t)`, whose ratio is
/// `3 / c`, that is where the part has grown to `faint / omega`, still far inside the region in which
/// Newton's method converges to this path.
pub(crate) struct Radius<'a, S: Lane> {
    pub(crate) n: usize,
    pub(crate) taylor: &'a [S],
    pub(crate) inverse_weights_sqr: &'a [S::Real],
    /// Lipschitz constants of Newton's method, squared.
    pub(crate) omega_sqr: &'a S::Real,
}

impl<S: Lane> Kernel for Radius<'_, S> {
    type Output = S::Real;
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) -> S::Real {
        let n = self.n;
        let mut radius = S::real(f64::INFINITY);
        let mut norms = [S::real(0.0); 4];
        for j in 0..n {
            // Written out: a closure that is not inlined would be compiled without the instruction
            // set of the kernel.
            let t = self.taylor;
            let sizes = [t[j].norm_sqr(), t[n + j].norm_sqr(), t[2 * n + j].norm_sqr(), t[3 * n + j].norm_sqr()];
            let weight = self.inverse_weights_sqr[j];
            for l in 0..S::LANES {
                let [_, s1, s2, s3] = [0, 1, 2, 3].map(|k| sizes[k].as_ref()[l]);
                // In units in which |x1| = 1, so that the test does not depend on the scale of t.
                let scale = 1.0 / s1.max(1e-12);
                let (c1, c2, c3) = (s1 * scale, s2 * (scale * scale), s3 * (scale * scale * scale));
                let negligible = 1e-28 * c1.max(c2).max(c3);
                let ratio = s2 / s3;
                let size = s2 * (ratio * ratio) * (weight.as_ref()[l] * self.omega_sqr.as_ref()[l]);
                let candidate = ratio * reach_sqr(size);
                let counts = c2 > negligible && candidate < radius.as_ref()[l];
                let r = radius.as_mut();
                r[l] = if counts { candidate } else { r[l] };
                for k in 0..4 {
                    let norm = norms[k].as_mut();
                    norm[l] = norm[l].max(sizes[k].as_ref()[l] * weight.as_ref()[l]);
                }
            }
        }
        for l in 0..S::LANES {
            if radius.as_ref()[l].is_finite() {
                continue;
            }
            // No coordinate has a usable pair: the ratio of norms, and at last the scale of the
            // derivatives.
            let [s0, s1, s2, s3] = [0, 1, 2, 3].map(|k| norms[k].as_ref()[l]);
            let ratio = s2 / s3;
            let largest = s1.max(s2).max(s3);
            radius.as_mut()[l] = if ratio.is_finite() && ratio > 0.0 {
                ratio
            } else if largest > 0.0 {
                // A point that is zero says nothing of the scale of the path; that of the derivatives does, if of odd
                // orders alone, as where signs of all coordinates may be changed.
                let odd = if s0 < tracking::NO_SIZE { (s1 / s3).sqrt() } else { 0.0 };
                if odd > s0 / largest { odd } else { s0 / largest }
            } else {
                f64::INFINITY
            };
        }
        radius
    }
}

/// Square of the factor on the radius of trust of a part of the size `a`, from `a^2`; the logarithm
/// is that of the power of two below.
#[inline(always)]
fn reach_sqr(size_sqr: f64) -> f64 {
    let faintness = (tracking::FAINT * tracking::FAINT) / size_sqr;
    let exponent = (faintness.to_bits() >> 52) as i64 - 1023;
    let factor = 1.0 + std::f64::consts::LN_2 / 6.0 * exponent as f64;
    // Not a number, where nothing is known, gives one.
    let factor = if faintness > 1.0 { factor } else { 1.0 };
    let factor = if factor < tracking::FAINT_REACH { factor } else { tracking::FAINT_REACH };
    factor * factor
}

/// Weights of the coordinates, squared, with their reciprocals: half the old square, half the size
/// of the predicted point, bounded below; lanes in `fresh` forget their old weights.
pub(crate) struct Weigh<'a, S: Lane> {
    pub(crate) x: &'a [S],
    pub(crate) fresh: u16,
    /// Weights never fall below this share of the largest coordinate: the square of that.
    pub(crate) least_share_sqr: f64,
    pub(crate) weights_sqr: &'a mut [S::Real],
    pub(crate) inverse: &'a mut [S::Real],
}

impl<S: Lane> Kernel for Weigh<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let n = self.x.len();
        let mut largest = S::real(0.0);
        for x in self.x {
            let size = x.norm_sqr();
            for l in 0..S::LANES {
                let m = largest.as_mut();
                m[l] = m[l].max(size.as_ref()[l]);
            }
        }
        for j in 0..n {
            let size = self.x[j].norm_sqr();
            for l in 0..S::LANES {
                let size = size.as_ref()[l];
                let w = &mut self.weights_sqr[j].as_mut()[l];
                let mean = if self.fresh >> l & 1 == 1 { size } else { 0.5 * (*w + size) };
                let floor = (self.least_share_sqr * largest.as_ref()[l]).max(tracking::LEAST_WEIGHT_SQR);
                let next = mean.max(floor);
                // A point that is not finite keeps the old weights.
                *w = if next < f64::INFINITY { next } else { *w };
                self.inverse[j].as_mut()[l] = 1.0 / *w;
            }
        }
    }
}

/// `out = x - dx` in the `running` lanes, and the squared norm of `dx`; a coordinate that is not a
/// number makes the norm NaN.
pub(crate) struct Correct<'a, S: Lane> {
    pub(crate) x: &'a [S],
    pub(crate) dx: &'a [S],
    pub(crate) inverse_weights_sqr: &'a [S::Real],
    pub(crate) running: u16,
    pub(crate) out: &'a mut [S],
}

impl<S: Lane> Kernel for Correct<'_, S> {
    type Output = S::Real;
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) -> S::Real {
        let n = self.x.len();
        for j in 0..n {
            self.out[j] = S::select(&self.out[j], &S::sub(&self.x[j], &self.dx[j]), self.running);
        }
        norm_sqr(self.dx, self.inverse_weights_sqr)
    }
}

/// Squared norm of the difference of two points.
pub(crate) struct Distance<'a, S: Lane> {
    pub(crate) a: &'a [S],
    pub(crate) b: &'a [S],
    pub(crate) inverse_weights_sqr: &'a [S::Real],
}

impl<S: Lane> Kernel for Distance<'_, S> {
    type Output = S::Real;
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) -> S::Real {
        let mut norm = S::real(0.0);
        for j in 0..self.a.len() {
            grow(&mut norm, &S::sub(&self.a[j], &self.b[j]), &self.inverse_weights_sqr[j]);
        }
        norm
    }
}

/// Taylor coefficients of the parameters, for the paths and the `t` of the lanes.
pub(crate) struct Coefficients<'a, S: Lane, P: ParameterPath> {
    pub(crate) path: &'a P,
    pub(crate) labels: &'a [usize],
    pub(crate) t: &'a S::Real,
    pub(crate) out: &'a mut [S],
}

impl<S: Lane, P: ParameterPath> Kernel for Coefficients<'_, S, P> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        self.path.coefficients::<S>(self.labels, self.t, self.out);
    }
}

/// Overwrites `to` with `from` in the lanes of `mask`.
pub(crate) struct Take<'a, S: Lane> {
    pub(crate) from: &'a [S],
    pub(crate) mask: u16,
    pub(crate) to: &'a mut [S],
}

impl<S: Lane> Kernel for Take<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        for (to, from) in self.to.iter_mut().zip(self.from) {
            *to = S::select(to, from, self.mask);
        }
    }
}

#[inline(always)]
fn norm_sqr<S: Lane>(v: &[S], inverse_weights_sqr: &[S::Real]) -> S::Real {
    let mut norm = S::real(0.0);
    for j in 0..v.len() {
        grow(&mut norm, &v[j], &inverse_weights_sqr[j]);
    }
    norm
}

#[inline(always)]
fn grow<S: Lane>(norm: &mut S::Real, z: &S, inverse_weight_sqr: &S::Real) {
    let size = z.norm_sqr();
    for l in 0..S::LANES {
        let v = size.as_ref()[l] * inverse_weight_sqr.as_ref()[l];
        let norm = norm.as_mut();
        // Once NaN, always NaN: neither comparison is true then.
        norm[l] = if v <= norm[l] || norm[l].is_nan() { norm[l] } else { v };
    }
}

#[cfg(test)]
mod tests {
    use super::{reach_sqr, tracking};

    #[test]
    fn faint_parts_reach_farther_and_others_do_not() {
        for size in [tracking::FAINT, 1.0, f64::INFINITY, f64::NAN] {
            assert_eq!(reach_sqr(size * size), 1.0, "{size}");
        }
        // The logarithm is that of the power of two below, at most ln 2 / 6 too small for a square.
        for size in [1e-3f64, 1e-7, 1e-12] {
            let exact = 1.0 + (tracking::FAINT / size).ln() / 3.0;
            let found = reach_sqr(size * size).sqrt();
            assert!(found <= exact && found > exact - 0.12, "{size}: {found}, {exact}");
        }
        assert_eq!(reach_sqr(0.0), tracking::FAINT_REACH * tracking::FAINT_REACH);
    }
}
