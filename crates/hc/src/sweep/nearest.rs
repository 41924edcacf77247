//! Distances of real solutions in two neighbouring cells, by the sizes that their coordinates have there.

use super::cell::RealSolution;
use crate::tolerances::{ends, sweeps};

/// The sizes of the coordinates.
pub(super) struct Sizes(Vec<f64>);

impl Sizes {
    /// The largest absolute values of the coordinates of these points, none less than 1e-4 of the largest of all.
    pub(super) fn of<'a>(points: impl Iterator<Item = &'a [f64]>) -> Sizes {
        let mut sizes: Vec<f64> = Vec::new();
        for point in points {
            sizes.resize(point.len(), 0.0);
            for (size, x) in sizes.iter_mut().zip(point) {
                *size = size.max(x.abs());
            }
        }
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        let least = if largest > 0.0 { ends::FLOOR * largest } else { 1.0 };
        for size in &mut sizes {
            *size = size.max(least);
        }
        Sizes(sizes)
    }

    /// The largest difference of two points in a coordinate, in units of the size of this; infinite if one of them is
    /// not finite.
    pub(super) fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let parts = self.0.iter().zip(a.iter().zip(b)).map(|(size, (a, b))| (a - b).abs() / size);
        // Once not a number, always infinite.
        parts.fold(0.0, |largest: f64, part| if part.is_nan() { f64::INFINITY } else { largest.max(part) })
    }

    /// The number of the regular solution at which a path has ended, if it is clear which one.
    pub(super) fn arrival(&self, end: &[f64], solutions: &[RealSolution]) -> Option<usize> {
        let (mut nearest, mut first, mut second) = (None, f64::INFINITY, f64::INFINITY);
        for (k, solution) in solutions.iter().enumerate() {
            let distance = self.distance(end, &solution.value);
            if distance < first {
                second = first;
                (nearest, first) = (Some(k), distance);
            } else {
                second = second.min(distance);
            }
        }
        let clear = first <= sweeps::ARRIVED && first <= sweeps::ALONE * second;
        nearest.filter(|&k| clear && solutions[k].multiplicity == 1)
    }

    /// Whether a point lies far outside.
    pub(super) fn is_far(&self, point: &[f64]) -> bool {
        let largest = self.0.iter().copied().fold(0.0, f64::max);
        point.iter().any(|x| x.is_nan() || x.abs() > sweeps::FAR * largest)
    }
}

#[cfg(test)]
mod tests {
    use super::{RealSolution, Sizes};

    fn solutions(values: &[[f64; 2]]) -> Vec<RealSolution> {
        let regular =
            |value: &[f64; 2]| RealSolution { value: value.to_vec(), multiplicity: 1, positive: false, branch: None };
        values.iter().map(regular).collect()
    }

    #[test]
    fn a_path_arrives_at_the_one_solution_that_is_near() {
        let all = solutions(&[[1.0, 0.0], [1.0, 2e-7], [-1.0, 0.0], [0.0, 0.0]]);
        let sizes = Sizes::of(all.iter().map(|s| &s.value[..]));
        // The second coordinate has a size of 1e-4 there.
        assert_eq!(sizes.arrival(&[1.0, 1e-12], &all), Some(0));
        assert_eq!(sizes.arrival(&[1.0, 2e-7], &all), Some(1));
        assert_eq!(sizes.arrival(&[1.0, 0.9e-7], &all), None);
        assert_eq!(sizes.arrival(&[1e-17, -1e-20], &all), Some(3));
        assert_eq!(sizes.arrival(&[-1.0 + 1e-5, 0.0], &all), None);
        assert_eq!(sizes.arrival(&[f64::NAN, 0.0], &all), None);
        assert_eq!(sizes.arrival(&[1.0, 0.0], &[]), None);
        let mut multiple = solutions(&[[1.0, 0.0]]);
        multiple[0].multiplicity = 2;
        assert_eq!(sizes.arrival(&[1.0, 0.0], &multiple), None);
    }

    #[test]
    fn far_is_far_beyond_the_solutions() {
        let all = solutions(&[[10.0, 0.0]]);
        let sizes = Sizes::of(all.iter().map(|s| &s.value[..]));
        assert!(sizes.is_far(&[2e5, 0.0]) && sizes.is_far(&[0.0, -2e5]) && sizes.is_far(&[0.0, f64::NAN]));
        assert!(!sizes.is_far(&[9e4, 0.0]));
    }
}
