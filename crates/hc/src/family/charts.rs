//! Charts: forms of a family in which other paths are easy.

use crate::homotopy::{ParameterPath, Segment};
use num_complex::Complex64;
use poly::{ComplexDd, Lane, Scalar};

/// Forms of one problem in one family, for instance with its points in another order. A path that
/// is hard in one chart may be easy in the next. Chart 0 is the family itself.
pub trait Charts {
    /// Number of charts, at least 1.
    const COUNT: usize;

    /// Appends the parameters in a chart to `out`, from those in chart 0.
    fn parameters(&self, chart: usize, p: &[Complex64], out: &mut Vec<Complex64>);

    /// Appends a solution in a chart to `out`, from the solution in chart 0.
    fn enter(&self, chart: usize, x: &[Complex64], out: &mut Vec<Complex64>);

    /// Appends a solution in chart 0 to `out`, from the solution in a chart.
    fn leave(&self, chart: usize, x: &[Complex64], out: &mut Vec<Complex64>);
}

/// The family itself, and no other chart.
#[derive(Clone, Copy, Debug, Default)]
pub struct OneChart;

impl Charts for OneChart {
    const COUNT: usize = 1;

    fn parameters(&self, _: usize, p: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend_from_slice(p);
    }

    fn enter(&self, _: usize, x: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend_from_slice(x);
    }

    fn leave(&self, _: usize, x: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend_from_slice(x);
    }
}

/// The rest of a segment, for each path from the point where it goes on: time `1` of the tracker is
/// `t = from`.
pub(super) struct Remainders<'a> {
    pub(super) segment: &'a Segment,
    pub(super) from: &'a [f64],
}

impl ParameterPath for Remainders<'_> {
    fn parameters(&self) -> usize {
        self.segment.parameters()
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]) {
        let mut from = S::real(1.0);
        for (from, &path) in from.as_mut().iter_mut().zip(paths) {
            *from = self.from[path];
        }
        let t = S::real_mul(t, &from);
        let (target, direction) = (self.segment.target(), self.segment.direction());
        let m = target.len();
        for i in 0..m {
            let direction = S::from_c64(direction[i]);
            p[i] = S::add(&S::from_c64(target[i]), &direction.scale_by(&t));
            p[m + i] = direction.scale_by(&from);
        }
        p[2 * m..4 * m].fill(S::zero());
    }

    fn extend(&self, path: usize, t: f64, p: &mut [ComplexDd]) {
        let [t, from] = [t, self.from[path]].map(|t| ComplexDd::new(t.into()));
        self.segment.extended(&Scalar::mul(&t, &from), p);
    }

    fn is_straight(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::Remainders;
    use crate::homotopy::{ParameterPath, Segment};
    use num_complex::Complex64;

    #[test]
    fn the_rest_of_a_segment_is_on_the_segment() {
        let z = Complex64::new;
        let segment = Segment::new(&[z(1.0, 2.0), z(0.0, 1.0)], &[z(-0.5, 0.3), z(4.0, 0.0)]);
        let rests = Remainders { segment: &segment, from: &[1.0, 0.25] };
        let (mut whole, mut rest) = ([z(0.0, 0.0); 8], [z(0.0, 0.0); 8]);
        segment.coefficients::<Complex64>(&[0], &[0.2], &mut whole);
        rests.coefficients::<Complex64>(&[0], &[0.2], &mut rest);
        assert_eq!(whole, rest);
        // Path 1 is at t = 0.2 when four fifths of its way are left.
        rests.coefficients::<Complex64>(&[1], &[0.8], &mut rest);
        for i in 0..2 {
            assert!((whole[i] - rest[i]).norm() < 1e-15);
            assert!((whole[2 + i] * 0.25 - rest[2 + i]).norm() < 1e-15);
        }
        // In double-double both agree to a rounding error, and both ways to the same digits, since
        // 0.25 t is exact.
        let mut extended = [[poly::ComplexDd::default(); 2]; 2];
        rests.extend(1, 0.8, &mut extended[0]);
        segment.extend(0, 0.25 * 0.8, &mut extended[1]);
        assert_eq!(extended[0], extended[1]);
        assert!(extended[0].iter().zip(&rest).all(|(e, r)| (e.high() - r).norm() < 1e-15 && e.low().norm() < 1e-15));
    }
}
