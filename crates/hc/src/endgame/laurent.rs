//! Reading a closed loop: Laurent coefficients by the discrete Fourier transform of the samples.
//!
//! Near `t = 0` a path is a convergent series in `t^(1/m)`, where `m` is its winding number; if the
//! path diverges, the series has finitely many negative powers. On a loop of `m` turns round the
//! circle `|t| = r`, its coefficients times powers of `r` are the Fourier coefficients of the
//! samples, up to aliasing. The aliasing error falls with the number of samples per turn as
//! `(r / R)^samples`, where `R` is the distance to the next singularity (Morgan, Sommese & Wampler
//! 1991).

use super::ending::{Ending, SingularEnd};
use crate::refine;
use crate::tolerances::{LoopTolerances, endgame};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Samples of a path on a closed loop.
pub(super) struct Loop<'a> {
    /// Number of unknowns.
    pub(super) n: usize,
    /// Samples on each turn.
    pub(super) per_turn: usize,
    /// Points at equal angles, `t` turning clockwise, `n` coordinates each; as many as `per_turn`
    /// times the winding number.
    pub(super) samples: &'a [Complex64],
    /// Relative error of the samples.
    pub(super) noise: f64,
    /// How far each coordinate moves if the coefficients are rounded. Rounding creates
    /// singularities deep inside the loop, which must not count.
    pub(super) blur: &'a [f64],
}

/// Why a loop does not show the end of its path.
#[derive(Debug, PartialEq)]
pub(super) enum Unclear {
    /// The loop is too wide: singularities other than zero lie not far outside the loop, or inside
    /// it.
    TooWide,
    /// The loop is so near to zero that systems with rounded coefficients have different ends.
    TooDeep,
}

impl Loop<'_> {
    /// The end of the path: at a point, in which coordinates that vanish within its error are exactly zero, or
    /// at infinity.
    pub(super) fn read(&self, view: LoopTolerances) -> Result<Ending, Unclear> {
        let (n, count) = (self.n, self.samples.len() / self.n);
        let winding = count / self.per_turn;
        let roots: Vec<Complex64> =
            (0..count).map(|k| Complex64::from_polar(1.0, TAU * k as f64 / count as f64)).collect();
        let size = |j: usize| (0..count).map(|k| self.samples[k * n + j].norm_sqr()).fold(0.0, f64::max).sqrt();
        let largest = (0..n).map(size).fold(0.0, f64::max);
        let half = (count / 2) as i64;
        // Whether a coordinate has lower powers than the one that is taken for its order.
        let mut impure = false;
        let (mut limit, mut valuations, mut error) = (Vec::with_capacity(n), Vec::with_capacity(n), self.noise);
        for j in 0..n {
            let size = size(j);
            let noise = self.noise * refine::size(size, largest);
            let blur = self.blur[j];
            if blur > endgame::BLURRED * size.max(1e-4 * largest) {
                return Err(Unclear::TooDeep);
            }
            let significant = (view.zero * size).max(16.0 * noise).max(endgame::BLUR_MARGIN * blur);
            let coefficient = |power: i64| {
                let sum: Complex64 = (0..count)
                    .map(|k| self.samples[k * n + j] * roots[(power.rem_euclid(count as i64) as usize * k) % count])
                    .sum();
                sum / count as f64
            };
            let sizes: Vec<(i64, f64)> =
                (-half..count as i64 - half).map(|p| (p, coefficient(p).norm_sqr().sqrt())).collect();
            // The frequencies beyond three quarters of the highest.
            let in_tail = |p: i64| 4 * p.abs() >= 3 * half;
            let tail = sizes.iter().filter(|(p, _)| in_tail(*p)).map(|(_, c)| *c).fold(0.0, f64::max);
            if tail > (view.tail * size).max(16.0 * noise).max(16.0 * blur) {
                return Err(Unclear::TooWide);
            }
            // Negative frequencies are aliases of positive ones, the lowest of those in the tail,
            // the others above five eighths of the samples.
            let significant = significant.max(4.0 * size * (tail / size).powf(5.0 / 3.0));
            let Some(&(lowest, share)) = sizes.iter().find(|(p, c)| *c > significant && !(*p < 0 && in_tail(*p)))
            else {
                limit.push(Complex64::new(0.0, 0.0));
                valuations.push(0);
                continue;
            };
            let lowest = if lowest < 0 && share < endgame::DOMINANT * size {
                impure = true;
                match sizes.iter().find(|(_, c)| *c > view.largest * size) {
                    Some(&(power, _)) => power,
                    None => return Err(Unclear::TooWide),
                }
            } else {
                lowest
            };
            valuations.push(lowest);
            // The next alias of a frequency at three eighths of the samples is at all of them.
            error = error.max((tail / size).powf(8.0 / 3.0));
            limit.push(if lowest > 0 { Complex64::new(0.0, 0.0) } else { coefficient(0) });
        }
        debug_assert!(winding > 0);
        if valuations.iter().any(|&v| v < 0) {
            Ok(Ending::Infinite { valuations, winding })
        } else if impure {
            Err(Unclear::TooWide)
        } else {
            Ok(Ending::Singular(SingularEnd { point: limit, winding, error }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Ending, Loop, SingularEnd, Unclear, endgame};
    use num_complex::Complex64;
    use std::f64::consts::TAU;

    fn samples(
        winding: usize,
        per_turn: usize,
        radius: f64,
        path: impl Fn(Complex64) -> Vec<Complex64>,
    ) -> Vec<Complex64> {
        let count = winding * per_turn;
        let root = |k: usize| Complex64::from_polar(radius.powf(1.0 / winding as f64), -TAU * k as f64 / count as f64);
        (0..count).flat_map(|k| path(root(k))).collect()
    }

    fn read(n: usize, per_turn: usize, samples: &[Complex64]) -> Result<Ending, Unclear> {
        Loop { n, per_turn, samples, noise: 1e-15, blur: &vec![0.0; n] }.read(endgame::CLEAR)
    }

    #[test]
    fn limits_and_directions_of_puiseux_series() {
        let z = Complex64::new;
        // m = 3 with a limit, one coordinate that vanishes like t^(2/3).
        let s = samples(3, 4, 1e-6, |u| vec![z(2.0, 1.0) + u - u.powi(4), u * u * z(0.0, 3.0)]);
        let Ok(Ending::Singular(SingularEnd { point, winding: 3, error })) = read(2, 4, &s) else { panic!("finite") };
        assert!((point[0] - z(2.0, 1.0)).norm() < 1e-13 && point[1] == z(0.0, 0.0) && error < 1e-12);
        // t^(-1/2) and a limit.
        let s = samples(2, 4, 1e-6, |u| vec![u.inv() + 1.0, u + 5.0]);
        assert_eq!(read(2, 4, &s), Ok(Ending::Infinite { valuations: vec![-1, 0], winding: 2 }));
    }

    #[test]
    fn a_large_limit_is_not_infinity() {
        // 1 / (t + 1e-7) on |t| = 1e-6: the pole is within the loop, not at zero.
        let s = samples(1, 8, 1e-6, |t| vec![(t + 1e-7).inv()]);
        assert_eq!(read(1, 8, &s), Err(Unclear::TooWide));
        let s = samples(1, 8, 1e-11, |t| vec![(t + 1e-7).inv()]);
        let Ok(Ending::Singular(end)) = read(1, 8, &s) else { panic!("finite") };
        assert!((end.point[0] - 1e7).norm() < 1e-5);
    }

    #[test]
    fn singularities_just_outside_are_noticed() {
        let s = samples(1, 4, 1e-2, |t| vec![(t + 0.03).sqrt()]);
        assert_eq!(read(1, 4, &s), Err(Unclear::TooWide));
    }
}
