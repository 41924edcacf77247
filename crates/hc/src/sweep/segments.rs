//! Straight ways in the parameters, another one for each path, so that paths between many cells travel side by side.

use crate::homotopy::ParameterPath;
use num_complex::Complex64;
use poly::{ComplexDd, Lane, Scalar};

/// Segments to real parameters.
#[derive(Debug, Default)]
pub(super) struct Segments {
    parameters: usize,
    /// The ends at `t = 0`, one after the other.
    targets: Vec<f64>,
    /// The starts less the ends.
    directions: Vec<Complex64>,
    /// The segment of each path.
    paths: Vec<usize>,
}

impl Segments {
    /// None yet, in so many parameters.
    pub(super) fn new(parameters: usize) -> Segments {
        Segments { parameters, ..Segments::default() }
    }

    /// Adds the segment from `start` to `target`, for this number of paths that follow those there are.
    pub(super) fn add(&mut self, start: &[Complex64], target: &[f64], paths: usize) {
        let segment = self.targets.len().checked_div(self.parameters).unwrap_or(0);
        self.targets.extend_from_slice(target);
        self.directions.extend(start.iter().zip(target).map(|(a, b)| a - b));
        self.paths.extend(std::iter::repeat_n(segment, paths));
    }
}

impl ParameterPath for Segments {
    fn parameters(&self) -> usize {
        self.parameters
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]) {
        let m = self.parameters;
        for k in 0..m {
            let [mut target, mut direction] = [S::zero(), S::zero()];
            for (lane, &path) in paths.iter().enumerate() {
                let place = self.paths[path] * m + k;
                target.set(lane, self.targets[place].into());
                direction.set(lane, self.directions[place]);
            }
            p[k] = S::add(&target, &direction.scale_by(t));
            p[m + k] = direction;
        }
        p[2 * m..4 * m].fill(S::zero());
    }

    fn extend(&self, path: usize, t: f64, p: &mut [ComplexDd]) {
        let t = ComplexDd::new(t.into());
        let first = self.paths[path] * self.parameters;
        for (k, p) in p.iter_mut().enumerate().take(self.parameters) {
            let [target, direction] =
                [self.targets[first + k].into(), self.directions[first + k]].map(|z: Complex64| ComplexDd::from_c64(z));
            *p = ComplexDd::mul_add(&direction, &t, &target);
        }
    }

    fn is_straight(&self) -> bool {
        true
    }
}

#[cfg(test)]
mod tests {
    use super::Segments;
    use crate::homotopy::{ParameterPath, Segment};
    use num_complex::Complex64;
    use poly::{ComplexDd, Lane, Lanes8};

    #[test]
    fn each_path_has_its_own_segment() {
        let z = Complex64::new;
        let (a, b) = ([z(1.0, 2.0), z(0.5, -1.0)], [z(-3.0, 0.0), z(7.0, 0.0)]);
        let (p, q) = ([0.25, -4.0], [8.0, 1.0]);
        let mut all = Segments::new(2);
        all.add(&a, &p, 3);
        all.add(&b, &q, 5);
        let single = [Segment::new(&a, &p.map(Complex64::from)), Segment::new(&b, &q.map(Complex64::from))];
        let (paths, t) = ([0, 1, 2, 3, 4, 5, 6, 7], <Lanes8 as Lane>::real(0.375));
        let mut lanes = [<Lanes8 as poly::Scalar>::zero(); 8];
        all.coefficients(&paths, &t, &mut lanes);
        for path in paths {
            let (mut alone, mut expected) = ([z(0.0, 0.0); 8], [z(0.0, 0.0); 8]);
            all.coefficients(&[path], &[0.375], &mut alone);
            single[usize::from(path > 2)].coefficients(&[0], &[0.375], &mut expected);
            assert_eq!(alone, expected, "path {path}");
            for (lane, alone) in lanes.iter().zip(alone) {
                assert_eq!(lane.get(path), alone);
            }
            let mut extended = [[ComplexDd::default(); 2]; 2];
            all.extend(path, 0.375, &mut extended[0]);
            single[usize::from(path > 2)].extend(0, 0.375, &mut extended[1]);
            assert_eq!(extended[0], extended[1]);
        }
    }
}
