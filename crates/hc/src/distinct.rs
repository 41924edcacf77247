//! Which points coincide.
//!
//! Points are sorted by a fixed real projection, so that only neighbours in that order are
//! compared: N log N for N points in general position.

use crate::tolerances::ends;
use num_complex::Complex64;

/// Relative distance of two points: `max_j |a_j - b_j| / w_j`, where `w_j` is the size of the
/// component, at least 1e-4 of the largest.
pub fn relative_distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let largest = a.iter().chain(b).map(|z| z.norm()).fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    a.iter().zip(b).map(|(a, b)| (a - b).norm() / a.norm().max(b.norm()).max(ends::FLOOR * largest)).fold(0.0, f64::max)
}

/// Whether a point coincides with its conjugate: all imaginary parts are at most this share of the largest coordinate, or
/// of one.
pub(crate) fn is_real(point: &[Complex64], tolerance: f64) -> bool {
    let size = point.iter().map(|z| z.norm()).fold(1.0, f64::max);
    point.iter().all(|z| z.im.abs() <= tolerance * size)
}

/// Groups of two or more coinciding points among `points` (pairs of a label and `n` coordinates):
/// points whose [`relative_distance`] is at most `tolerance`, and chains of such. Labels ascend
/// within a group, groups by their first label.
pub(crate) fn coincidences<'a>(
    points: impl IntoIterator<Item = (usize, &'a [Complex64])>,
    tolerance: f64,
) -> Vec<Vec<usize>> {
    let points: Vec<(usize, &[Complex64])> = points.into_iter().collect();
    let mut found = Coincidences::default();
    found.find(0..points.len(), |k| points[k].1, tolerance);
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for i in 0..points.len() {
        groups[root(&mut found.parent, i)].push(points[found.keyed[i].index].0);
    }
    groups.retain(|g| g.len() > 1);
    for g in groups.iter_mut() {
        g.sort_unstable();
    }
    groups.sort();
    groups
}

/// All points by groups of coinciding ones; a point alone is a group too.
pub(crate) fn groups<'a>(
    points: impl Iterator<Item = (usize, &'a [Complex64])> + Clone,
    tolerance: f64,
) -> Vec<Vec<usize>> {
    let mut all = coincidences(points.clone(), tolerance);
    let mut grouped: Vec<usize> = all.concat();
    grouped.sort_unstable();
    all.extend(points.map(|(k, _)| k).filter(|k| grouped.binary_search(k).is_err()).map(|k| vec![k]));
    all.sort();
    all
}

/// Points among which one looks for those that coincide with another.
pub(crate) struct Known<'a> {
    points: Vec<&'a [Complex64]>,
    /// In the order of the keys.
    keyed: Vec<Keyed>,
}

impl<'a> Known<'a> {
    /// Those points, sorted by their projections.
    pub(crate) fn new(points: impl Iterator<Item = &'a [Complex64]>) -> Known<'a> {
        let points: Vec<&[Complex64]> = points.collect();
        let mut keyed: Vec<Keyed> = points.iter().enumerate().map(|(index, x)| Keyed::new(x, index)).collect();
        keyed.sort_unstable_by(Keyed::order);
        Known { points, keyed }
    }

    /// Whether one of them has at most this [`relative_distance`] from a point.
    pub(crate) fn has(&self, x: &[Complex64], tolerance: f64) -> bool {
        self.place(x, tolerance).is_some()
    }

    /// The number of one of them that has at most this [`relative_distance`] from a point.
    pub(crate) fn place(&self, x: &[Complex64], tolerance: f64) -> Option<usize> {
        let own = Keyed::new(x, 0);
        // As in `Coincidences::find`; a point that coincides is nearly of this size.
        let reach = 4.0 * tolerance * own.size;
        let first = self.keyed.partition_point(|known| known.key < own.key - reach);
        let mut near = self.keyed[first..].iter().take_while(|known| known.key <= own.key + reach);
        near.find(|known| relative_distance(self.points[known.index], x) <= tolerance).map(|known| known.index)
    }
}

/// The memory of a search for coinciding points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Coincidences {
    /// In the order of the keys.
    keyed: Vec<Keyed>,
    /// Another member of the group, none for one of each group; by places in `keyed`.
    parent: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct Keyed {
    key: f64,
    size: f64,
    index: usize,
}

impl Keyed {
    fn new(x: &[Complex64], index: usize) -> Keyed {
        Keyed { key: projection(x), size: x.iter().map(|z| z.re.abs() + z.im.abs()).sum(), index }
    }

    fn order(&self, other: &Keyed) -> std::cmp::Ordering {
        self.key.total_cmp(&other.key).then(self.index.cmp(&other.index))
    }
}

impl Coincidences {
    /// With room for so many points.
    pub(crate) fn with_capacity(points: usize) -> Self {
        Coincidences { keyed: Vec::with_capacity(points), parent: Vec::with_capacity(points) }
    }

    /// Joins the coinciding ones of the points with these indices, as [`coincidences`] does.
    fn find<'a>(
        &mut self,
        indices: impl IntoIterator<Item = usize>,
        point: impl Fn(usize) -> &'a [Complex64],
        tolerance: f64,
    ) {
        self.keyed.clear();
        self.keyed.extend(indices.into_iter().map(|index| Keyed::new(point(index), index)));
        self.keyed.sort_unstable_by(Keyed::order);
        self.parent.clear();
        self.parent.extend(0..self.keyed.len());
        for (i, a) in self.keyed.iter().enumerate() {
            for (k, b) in self.keyed.iter().enumerate().skip(i + 1) {
                // The projection has coefficients of size at most one; sizes of coinciding points
                // are nearly equal.
                if b.key - a.key > 2.0 * tolerance * a.size.max(b.size) {
                    break;
                }
                if relative_distance(point(a.index), point(b.index)) <= tolerance {
                    let (a, b) = (root(&mut self.parent, i), root(&mut self.parent, k));
                    self.parent[a.max(b)] = a.min(b);
                }
            }
        }
    }

    /// Adds to `which` the indices, in no order, of the points that coincide with others.
    pub(crate) fn members<'a>(
        &mut self,
        indices: impl IntoIterator<Item = usize>,
        point: impl Fn(usize) -> &'a [Complex64],
        tolerance: f64,
        which: &mut Vec<usize>,
    ) {
        self.find(indices, point, tolerance);
        for i in 0..self.keyed.len() {
            let top = root(&mut self.parent, i);
            if top != i {
                which.extend([self.keyed[i].index, self.keyed[top].index]);
            }
        }
    }
}

/// The first of the group of `i`, by way of another member of it for each that is not the first.
pub(crate) fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// A fixed real projection with irrational coefficients in [-1, 1].
pub(crate) fn projection(x: &[Complex64]) -> f64 {
    let golden = 0.618_033_988_749_894_9_f64;
    x.iter()
        .enumerate()
        .map(|(j, z)| {
            let a = ((2 * j + 1) as f64 * golden).fract() * 2.0 - 1.0;
            let b = ((2 * j + 2) as f64 * golden).fract() * 2.0 - 1.0;
            a * z.re + b * z.im
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::{Known, coincidences, relative_distance};
    use num_complex::Complex64;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn those_with_a_neighbour_are_the_ones_that_a_look_at_all_finds(
            known in proptest::collection::vec((-3i8..3, -3i8..3, -9i8..9), 0..40),
            size in prop_oneof![Just(1e-9), Just(1.0), Just(1e9)],
            tolerance in prop_oneof![Just(1e-6), Just(1e-2), Just(0.5)],
        ) {
            // Points of a coarse grid, moved by a few thirds of the tolerance.
            let point = |(a, b, moved): &(i8, i8, i8)| {
                let [a, b, moved] = [*a, *b, *moved].map(f64::from);
                let at = 1.0 + moved * tolerance / 3.0;
                [Complex64::new(a, b) * at * size, Complex64::new(b, 1.0 - a) * at * size * 1e-3]
            };
            let points: Vec<[Complex64; 2]> = known.iter().map(point).collect();
            let (known, others) = points.split_at(points.len() / 2);
            let sorted = Known::new(known.iter().map(|x| &x[..]));
            for x in others {
                let expected = known.iter().any(|y| relative_distance(y, x) <= tolerance);
                prop_assert_eq!(sorted.has(x, tolerance), expected);
            }
        }
    }

    #[test]
    fn finds_pairs_and_chains_only() {
        let z = |re: f64, im: f64| Complex64::new(re, im);
        let points = [
            vec![z(1.0, 0.0), z(2.0, 1.0)],
            vec![z(1.0, 1e-12), z(2.0, 1.0)],
            vec![z(1.0, 0.0), z(2.0, 1.1)],
            vec![z(-3.0, 0.0), z(0.0, 0.0)],
            vec![z(1.0, 2e-12), z(2.0, 1.0)],
            vec![z(1e-3, 0.0), z(1e3, 0.0)],
            vec![z(2e-3, 0.0), z(1e3, 0.0)],
        ];
        let groups = coincidences(points.iter().enumerate().map(|(k, p)| (k, &p[..])), 1e-9);
        assert_eq!(groups, vec![vec![0, 1, 4]]);
    }
}
