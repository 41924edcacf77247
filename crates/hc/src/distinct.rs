//! Which points coincide.
//!
//! Points are sorted by a fixed real projection, so that only neighbours in that order are compared: N log N for N points
//! in general position.

use num_complex::Complex64;

/// Components smaller than this share of the largest are compared on its scale.
const FLOOR: f64 = 1e-4;

/// Relative distance of two points: `max_j |a_j - b_j| / w_j`, `w_j` the size of the component, at least 1e-4 of the largest.
pub fn relative_distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    let largest = a.iter().chain(b).map(|z| z.norm()).fold(0.0, f64::max);
    if largest == 0.0 {
        return 0.0;
    }
    a.iter().zip(b).map(|(a, b)| (a - b).norm() / a.norm().max(b.norm()).max(FLOOR * largest)).fold(0.0, f64::max)
}

/// Groups of two or more coinciding points among `points` (pairs of a label and `n` coordinates): points whose
/// [`relative_distance`] is at most `tolerance`, and chains of such. Labels ascend within a group, groups by their first label.
pub fn coincidences<'a>(points: impl IntoIterator<Item = (usize, &'a [Complex64])>, tolerance: f64) -> Vec<Vec<usize>> {
    let mut keyed: Vec<(f64, f64, usize, &[Complex64])> = points
        .into_iter()
        .map(|(label, x)| {
            let size: f64 = x.iter().map(|z| z.re.abs() + z.im.abs()).sum();
            (projection(x), size, label, x)
        })
        .collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));

    let mut parent: Vec<usize> = (0..keyed.len()).collect();
    for i in 0..keyed.len() {
        let (key, size, _, x) = keyed[i];
        for (k, other) in keyed.iter().enumerate().skip(i + 1) {
            // The projection has coefficients of size at most one; sizes of coinciding points are nearly equal.
            if other.0 - key > 2.0 * tolerance * size.max(other.1) {
                break;
            }
            if relative_distance(x, other.3) <= tolerance {
                let (a, b) = (root(&mut parent, i), root(&mut parent, k));
                parent[a.max(b)] = a.min(b);
            }
        }
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); keyed.len()];
    for i in 0..keyed.len() {
        groups[root(&mut parent, i)].push(keyed[i].2);
    }
    groups.retain(|g| g.len() > 1);
    groups.iter_mut().for_each(|g| g.sort_unstable());
    groups.sort();
    groups
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
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
    use super::coincidences;
    use num_complex::Complex64;

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
