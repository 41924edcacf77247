//! Where paths were, in two numbers each: enough to tell which ones may have met, without keeping their points.

use crate::distinct::{projection, relative_distance};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// A projection and roughly the size of a point for every path, twelve bytes; the points themselves only of few.
pub(super) struct Prints {
    paths: usize,
    /// Not a number where the path has no point; empty until one has.
    keys: Vec<f64>,
    /// The upper halves of the doubles.
    sizes: Vec<u32>,
    points: BTreeMap<usize, Vec<Complex64>>,
}

/// Bound on what the lower half of a double adds, relative, with a margin.
const ROUGH: f64 = 1.0 / (1 << 19) as f64;

impl Prints {
    pub(super) fn new(paths: usize) -> Self {
        Prints { paths, keys: Vec::new(), sizes: Vec::new(), points: BTreeMap::new() }
    }

    pub(super) fn forget(&mut self, path: usize) {
        if let Some(key) = self.keys.get_mut(path) {
            *key = f64::NAN;
            self.points.remove(&path);
        }
    }

    /// Notes where a path was; with `keep` the point too, so that it is compared in full with others that are kept.
    pub(super) fn note(&mut self, path: usize, point: &[Complex64], keep: bool) {
        if self.keys.is_empty() {
            self.keys = vec![f64::NAN; self.paths];
            self.sizes = vec![0; self.paths];
        }
        self.forget(path);
        let size: f64 = point.iter().map(|z| z.re.abs() + z.im.abs()).sum();
        self.keys[path] = projection(point);
        self.sizes[path] = (size.to_bits() >> 32) as u32;
        if keep {
            self.points.insert(path, point.to_vec());
        }
    }

    /// Paths that may have met others: all that are within the relative distance `tolerance` of another, and perhaps some
    /// that merely look so because one of the two points is not kept.
    pub(super) fn met(&self, tolerance: f64) -> Vec<usize> {
        let size = |path: usize| f64::from_bits(u64::from(self.sizes[path]) << 32);
        let mut order: Vec<usize> = (0..self.keys.len()).filter(|&k| !self.keys[k].is_nan()).collect();
        order.sort_unstable_by(|&a, &b| self.keys[a].total_cmp(&self.keys[b]).then(a.cmp(&b)));
        let mut met = Vec::new();
        for (i, &a) in order.iter().enumerate() {
            for &b in &order[i + 1..] {
                // Projections have coefficients of size at most one; sizes of coinciding points are nearly equal.
                let largest = size(a).max(size(b)) * (1.0 + ROUGH);
                if self.keys[b] - self.keys[a] > 2.0 * tolerance * largest {
                    break;
                }
                let same = match (self.points.get(&a), self.points.get(&b)) {
                    (Some(x), Some(y)) => relative_distance(x, y) <= tolerance,
                    _ => (size(a) - size(b)).abs() <= (2.0 * tolerance + ROUGH) * largest,
                };
                if same {
                    met.extend([a, b]);
                }
            }
        }
        met.sort_unstable();
        met.dedup();
        met
    }
}

#[cfg(test)]
mod tests {
    use super::Prints;
    use num_complex::Complex64;

    #[test]
    fn finds_paths_that_have_met() {
        let z = |re: f64, im: f64| Complex64::new(re, im);
        let points = [[z(1.0, 0.5), z(-2.0, 0.0)], [z(1.0, 0.5), z(-2.0, 1e-13)], [z(1.0, 0.5), z(-2.0, 1e-3)]];
        let mut prints = Prints::new(5);
        points.iter().enumerate().for_each(|(k, x)| prints.note(k + 1, x, false));
        assert_eq!(prints.met(1e-11), [1, 2]);
        prints.forget(1);
        assert_eq!(prints.met(1e-11), [0usize; 0]);
        // A small coordinate beside a large one shows only in points that are kept.
        for keep in [false, true] {
            prints.note(0, &[z(1e9, 0.0), z(0.0, 0.0)], keep);
            prints.note(1, &[z(1e9, 0.0), z(1e-5, 0.0)], keep);
            assert_eq!(prints.met(1e-9), [0, 1]);
            assert_eq!(prints.met(1e-11), if keep { vec![] } else { vec![0, 1] });
        }
    }

    #[test]
    fn points_of_any_size_are_told_apart() {
        let mut random = crate::random::Random::new(0, 0);
        let mut prints = Prints::new(8_000);
        let mut last = Vec::new();
        for path in 0..7_999 {
            let size = 10f64.powi(path as i32 % 601 - 300);
            last = random.normals(4).iter().map(|z| z * size).collect();
            prints.note(path, &last, false);
        }
        assert_eq!(prints.met(1e-11), [0usize; 0]);
        prints.note(7_999, &last, false);
        assert_eq!(prints.met(1e-11), [7_998, 7_999]);
    }
}
