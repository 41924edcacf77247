//! Where paths were, in two numbers each: enough to tell which ones have met, without keeping their points.

use crate::distinct::{projection, relative_distance};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// A projection and the size of a point for every path; the points themselves only of few.
pub(super) struct Prints {
    /// Not a number where the path has no point.
    keys: Vec<[f64; 2]>,
    points: BTreeMap<usize, Vec<Complex64>>,
}

impl Prints {
    pub(super) fn new(paths: usize) -> Self {
        Prints { keys: vec![[f64::NAN; 2]; paths], points: BTreeMap::new() }
    }

    pub(super) fn forget(&mut self, path: usize) {
        self.keys[path] = [f64::NAN; 2];
        self.points.remove(&path);
    }

    /// Notes where a path was; with `keep` the point too, so that it is compared in full with others that are kept.
    pub(super) fn note(&mut self, path: usize, point: &[Complex64], keep: bool) {
        self.forget(path);
        self.keys[path] = [projection(point), point.iter().map(|z| z.re.abs() + z.im.abs()).sum()];
        if keep {
            self.points.insert(path, point.to_vec());
        }
    }

    /// Paths that may have met others: all that are within the relative distance `tolerance` of another, and perhaps some
    /// that merely look so because one of the two points is not kept.
    pub(super) fn met(&self, tolerance: f64) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.keys.len()).filter(|&k| !self.keys[k][0].is_nan()).collect();
        order.sort_by(|&a, &b| self.keys[a][0].total_cmp(&self.keys[b][0]).then(a.cmp(&b)));
        let mut met = Vec::new();
        for (i, &a) in order.iter().enumerate() {
            let [key, size] = self.keys[a];
            for &b in &order[i + 1..] {
                let [other, other_size] = self.keys[b];
                // Projections have coefficients of size at most one; sizes of coinciding points are nearly equal.
                let reach = 2.0 * tolerance * size.max(other_size);
                if other - key > reach {
                    break;
                }
                let same = match (self.points.get(&a), self.points.get(&b)) {
                    (Some(x), Some(y)) => relative_distance(x, y) <= tolerance,
                    _ => (size - other_size).abs() <= reach,
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
}
