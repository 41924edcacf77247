//! Rigid motions of the receivers.

use smallvec::SmallVec;

use crate::network::Network;
use crate::points::{centroid, dot, minus};

/// Share of the receivers' spread below which a rotation does not move them: in space, that about the
/// line in which they lie.
const STILL: f64 = 1e-9;

/// What each rigid motion makes of one coordinate.
pub(super) type Motions = SmallVec<[f64; 6]>;

/// Coordinate `axis` of receiver `i` in the orthonormal rigid motions: translations, and rotations
/// about the centroid. In space receivers in one line have one rotation less.
pub(super) fn rigid_motion<const D: usize>(network: &Network<D>) -> impl Fn(usize, usize) -> Motions {
    let centre = centroid(network.receivers.iter());
    let root = (network.receivers.len() as f64).sqrt();
    let rotations = rotations(network, centre, root);
    move |i: usize, axis: usize| {
        let r = minus(network.receivers[i], centre);
        let translated = (0..D).map(|k| if k == axis { 1.0 / root } else { 0.0 });
        let turned = rotations.iter().map(|rotation| dot(rotation.rate[axis], r) / rotation.size);
        translated.chain(turned).collect()
    }
}

/// An infinitesimal rotation, and the length of what it makes of all receivers.
struct Rotation<const D: usize> {
    /// An antisymmetric matrix.
    rate: [[f64; D]; D],
    size: f64,
}

/// Rotations about the centroid that move the receivers, orthogonal as motions of all of them.
fn rotations<const D: usize>(network: &Network<D>, centre: [f64; D], root: f64) -> Vec<Rotation<D>> {
    let spread = network.size().max(f64::MIN_POSITIVE) * root;
    let product = |p: &[[f64; D]; D], q: &[[f64; D]; D]| -> f64 {
        let one = |r: [f64; D]| (0..D).map(|k| dot(p[k], r) * dot(q[k], r)).sum::<f64>();
        network.receivers.iter().map(|&r| one(minus(r, centre))).sum()
    };
    let mut found: Vec<Rotation<D>> = Vec::new();
    for (a, b) in (0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b))) {
        let mut rate = [[0.0; D]; D];
        (rate[a][b], rate[b][a]) = (-1.0, 1.0);
        // The only rotation of the plane moves each receiver by its distance.
        if D == 2 {
            return vec![Rotation { rate, size: spread }];
        }
        for other in &found {
            let along = product(&rate, &other.rate) / (other.size * other.size);
            for (row, other) in rate.iter_mut().zip(&other.rate) {
                row.iter_mut().zip(other).for_each(|(x, y)| *x -= along * y);
            }
        }
        let size = product(&rate, &rate).sqrt();
        if size > STILL * spread {
            found.push(Rotation { rate, size });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::rigid_motion;
    use crate::network::Network;
    use crate::network::tests::random;

    /// Number of motions, which are orthonormal and keep all distances between receivers.
    fn count<const D: usize>(network: &Network<D>) -> usize {
        let m = network.receivers.len();
        let of = rigid_motion(network);
        let motions: Vec<Vec<[f64; D]>> =
            (0..of(0, 0).len()).map(|k| (0..m).map(|i| std::array::from_fn(|axis| of(i, axis)[k])).collect()).collect();
        for (k, p) in motions.iter().enumerate() {
            for (l, q) in motions.iter().enumerate() {
                let product: f64 = p.iter().flatten().zip(q.iter().flatten()).map(|(x, y)| x * y).sum();
                assert!((product - f64::from(u8::from(k == l))).abs() < 1e-12, "{k} {l}: {product}");
            }
            for (i, j) in (0..m).flat_map(|i| (0..i).map(move |j| (i, j))) {
                let change: f64 =
                    (0..D).map(|a| (network.receivers[i][a] - network.receivers[j][a]) * (p[i][a] - p[j][a])).sum();
                assert!(change.abs() < 1e-12, "{k}: {i} {j}");
            }
        }
        motions.len()
    }

    #[test]
    fn three_in_the_plane_and_six_in_space() {
        for seed in 0..10 {
            assert_eq!(count(&random::<2>(6, 1, seed)), 3);
            assert_eq!(count(&random::<3>(6, 1, seed)), 6);
        }
        let mut line = random::<3>(6, 1, 10);
        for (k, r) in line.receivers.iter_mut().enumerate() {
            *r = [1.0 + k as f64, 2.0 - 0.5 * k as f64, 3.0 * k as f64];
        }
        assert_eq!(count(&line), 5);
    }
}
