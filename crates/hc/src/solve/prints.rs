//! Where paths were, in two rough numbers each: enough to tell which ones may have met, without keeping their points.

use crate::distinct::{projection, relative_distance};
use num_complex::Complex64;
use std::collections::BTreeMap;

/// The upper half of a double.
#[derive(Clone, Copy)]
struct Rough(u32);

impl Rough {
    /// Bound on what the lower half adds, relative, with a margin for the errors of comparing.
    const ERROR: f64 = 1.0 / (1 << 19) as f64;
    const NONE: Rough = Rough(u32::MAX);

    fn new(value: f64) -> Rough {
        Rough((value.to_bits() >> 32) as u32)
    }

    /// Not a number if there is none.
    fn value(self) -> f64 {
        f64::from_bits(u64::from(self.0) << 32)
    }
}

/// A projection and the size of a point for every path, eight bytes; the points themselves only of few.
pub(super) struct Prints {
    paths: usize,
    /// Empty until there is a point.
    keys: Vec<[Rough; 2]>,
    points: BTreeMap<usize, Vec<Complex64>>,
}

impl Prints {
    pub(super) fn new(paths: usize) -> Self {
        Prints { paths, keys: Vec::new(), points: BTreeMap::new() }
    }

    pub(super) fn forget(&mut self, path: usize) {
        if let Some(keys) = self.keys.get_mut(path) {
            *keys = [Rough::NONE; 2];
            self.points.remove(&path);
        }
    }

    /// Notes where a path was; with `keep` the point too, so that it is compared in full with others that are kept.
    pub(super) fn note(&mut self, path: usize, point: &[Complex64], keep: bool) {
        if self.keys.is_empty() {
            self.keys = vec![[Rough::NONE; 2]; self.paths];
        }
        self.forget(path);
        self.keys[path] = [projection(point), point.iter().map(|z| z.re.abs() + z.im.abs()).sum()].map(Rough::new);
        if keep {
            self.points.insert(path, point.to_vec());
        }
    }

    /// Paths that may have met others: all that are within the relative distance `tolerance` of another, and some that merely look so,
    /// because one of the two points is not kept. (Of a million points in general position about one pair.)
    pub(super) fn met(&self, tolerance: f64) -> Vec<usize> {
        let keys = |path: usize| self.keys[path].map(Rough::value);
        let mut order: Vec<usize> = (0..self.keys.len()).filter(|&k| !keys(k)[0].is_nan()).collect();
        order.sort_unstable_by(|&a, &b| keys(a)[0].total_cmp(&keys(b)[0]).then(a.cmp(&b)));
        let mut met = Vec::new();
        for (i, &a) in order.iter().enumerate() {
            let [key, size] = keys(a);
            for &b in &order[i + 1..] {
                let [other, other_size] = keys(b);
                // Projections have coefficients of size at most one; sizes of coinciding points are nearly equal.
                let reach = 2.0 * tolerance * size.max(other_size);
                let near = |a: f64, b: f64| (a - b).abs() <= reach + Rough::ERROR * (a.abs() + b.abs());
                if !near(key, other) {
                    break;
                }
                let same = match (self.points.get(&a), self.points.get(&b)) {
                    (Some(x), Some(y)) => relative_distance(x, y) <= tolerance,
                    _ => near(size, other_size),
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
    fn few_of_many_points_look_as_if_they_met() {
        let mut random = crate::random::Random::new(0, 0);
        let mut prints = Prints::new(30_001);
        let last = (0..30_000)
            .map(|k| {
                let x = random.normals(4);
                prints.note(k, &x, false);
                x
            })
            .last();
        assert!(prints.met(1e-11).len() <= 2);
        prints.note(30_000, &last.unwrap(), false);
        assert!([29_999, 30_000].iter().all(|k| prints.met(1e-11).contains(k)));
        // Whatever their size.
        for (k, size) in [1e-300, 1e-30, 1e30, 1e300].into_iter().enumerate() {
            [2 * k, 2 * k + 1].iter().for_each(|&k| prints.note(k, &[Complex64::new(size, -2.0 * size)], false));
            assert!([2 * k, 2 * k + 1].iter().all(|k| prints.met(1e-11).contains(k)));
        }
    }
}
