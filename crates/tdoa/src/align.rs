//! Procrustes alignment in the plane: the distance-preserving map (or similarity) that brings one
//! set of points closest to another. Reflections are allowed, because arrival times cannot tell a
//! network from its mirror image.

use serde::Serialize;

use crate::network::Network;
use crate::plane::{centroid, distance};

/// The map p -> scale * rotation * p + translation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Transform {
    /// An orthogonal matrix, row by row; its determinant is -1 if it reflects.
    pub rotation: [[f64; 2]; 2],
    /// Factor on lengths.
    pub scale: f64,
    /// Translation in metres.
    pub translation: [f64; 2],
}

impl Transform {
    /// The image of a point.
    pub fn apply(&self, p: [f64; 2]) -> [f64; 2] {
        let q = self.turn(p);
        [self.scale * q[0] + self.translation[0], self.scale * q[1] + self.translation[1]]
    }

    /// The image of a direction: turned (and reflected), but neither scaled nor moved.
    pub fn turn(&self, p: [f64; 2]) -> [f64; 2] {
        self.rotation.map(|row| row[0] * p[0] + row[1] * p[1])
    }

    /// The image of a whole network. Offsets are lengths, so they are scaled too.
    pub fn apply_network(&self, network: &Network) -> Network {
        Network {
            receivers: network.receivers.iter().map(|&p| self.apply(p)).collect(),
            transmitters: network.transmitters.iter().map(|&p| self.apply(p)).collect(),
            offsets: network.offsets.iter().map(|o| self.scale * o).collect(),
        }
    }

    /// The covariance of the image of a point with this covariance.
    pub fn apply_covariance(&self, c: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let r = &self.rotation;
        let entry = |a: usize, b: usize| -> f64 {
            (0..2).flat_map(|k| (0..2).map(move |l| (k, l))).map(|(k, l)| r[a][k] * c[k][l] * r[b][l]).sum::<f64>()
                * self.scale
                * self.scale
        };
        [[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]
    }
}

/// An alignment, and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Alignment {
    /// The map.
    pub transform: Transform,
    /// Root mean square distance of the mapped points from their targets, in metres.
    pub rms: f64,
}

/// The map with least squared error from `from` to `to` (the same number of points, paired by
/// index): rotation or reflection and translation, and a common scale if `scale` is true. `None` if
/// there are no points, or if the numbers of points differ.
///
/// With points as complex numbers relative to their centroids, the best rotation is the phase of
/// sum conj(a) b, and the best reflection the phase of sum a b. The better of the two is the one
/// with the larger modulus.
pub fn align(from: &[[f64; 2]], to: &[[f64; 2]], scale: bool) -> Option<Alignment> {
    if from.is_empty() || from.len() != to.len() {
        return None;
    }
    let (c, d) = (centroid(from.iter()), centroid(to.iter()));
    let (mut rotation, mut reflection, mut spread) = ([0.0; 2], [0.0; 2], 0.0);
    for (a, b) in from.iter().zip(to) {
        let (ax, ay, bx, by) = (a[0] - c[0], a[1] - c[1], b[0] - d[0], b[1] - d[1]);
        rotation = [rotation[0] + ax * bx + ay * by, rotation[1] + ax * by - ay * bx];
        reflection = [reflection[0] + ax * bx - ay * by, reflection[1] + ax * by + ay * bx];
        spread += ax * ax + ay * ay;
    }
    let norm = |z: [f64; 2]| z[0].hypot(z[1]);
    let reflect = norm(reflection) > norm(rotation);
    let best = if reflect { reflection } else { rotation };
    let [cos, sin] = if norm(best) > 0.0 { [best[0] / norm(best), best[1] / norm(best)] } else { [1.0, 0.0] };
    let rotation = if reflect { [[cos, sin], [sin, -cos]] } else { [[cos, -sin], [sin, cos]] };
    let scale = if scale && spread > 0.0 { norm(best) / spread } else { 1.0 };
    let mut transform = Transform { rotation, scale, translation: [0.0; 2] };
    let image = transform.apply(c);
    transform.translation = [d[0] - image[0], d[1] - image[1]];
    let sum: f64 = from.iter().zip(to).map(|(&a, &b)| distance(transform.apply(a), b).powi(2)).sum();
    Some(Alignment { transform, rms: (sum / from.len() as f64).sqrt() })
}

/// The map that puts the point `origin` at (0, 0), `x_axis` on the positive x axis and `up` above
/// it. `None` if the three do not fix a frame (coincident or collinear points).
pub fn frame(origin: [f64; 2], x_axis: [f64; 2], up: [f64; 2]) -> Option<Transform> {
    let length = distance(origin, x_axis);
    let (cos, sin) = ((x_axis[0] - origin[0]) / length, (x_axis[1] - origin[1]) / length);
    let height = cos * (up[1] - origin[1]) - sin * (up[0] - origin[0]);
    if !(length > 0.0 && height.abs() > 1e-9 * length) {
        return None;
    }
    let flip = height.signum();
    let rotation = [[cos, sin], [-sin * flip, cos * flip]];
    let mut transform = Transform { rotation, scale: 1.0, translation: [0.0; 2] };
    let image = transform.apply(origin);
    transform.translation = [-image[0], -image[1]];
    Some(transform)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::{Strategy, prop_assert, prop_assume, proptest};

    fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
        proptest::collection::vec([-10.0..10.0f64, -10.0..10.0f64], 3..9)
    }

    proptest! {
        #[test]
        fn undoes_any_similarity(points in points(), angle in 0.0..6.3f64, reflect: bool, scale in 0.1..10.0f64) {
            let (sin, cos) = angle.sin_cos();
            let rotation = if reflect { [[cos, sin], [sin, -cos]] } else { [[cos, -sin], [sin, cos]] };
            let map = Transform { rotation, scale, translation: [3.0, -7.0] };
            let image: Vec<_> = points.iter().map(|&p| map.apply(p)).collect();
            let found = align(&points, &image, true).unwrap();
            prop_assert!(found.rms < 1e-12 * 100.0);
            prop_assume!(points.iter().any(|&p| distance(p, points[0]) > 1e-3));
            prop_assert!((found.transform.scale - scale).abs() < 1e-9 * scale);
            // Without scale no rigid map is better than the one found, for instance the one without
            // its scale.
            let rigid = align(&points, &image, false).unwrap();
            prop_assert!(rigid.transform.scale == 1.0 && rigid.rms >= found.rms - 1e-12);
        }

        #[test]
        fn frame_places_its_three_points(points in points()) {
            if let Some(map) = frame(points[0], points[1], points[2]) {
                let [a, b, c] = [0, 1, 2].map(|k| map.apply(points[k]));
                prop_assert!(a[0].abs() + a[1].abs() < 1e-9);
                prop_assert!(b[0] > 0.0 && b[1].abs() < 1e-9);
                prop_assert!(c[1] > 0.0);
                prop_assert!((distance(a, c) - distance(points[0], points[2])).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_covariance_turns_with_its_point() {
        let quarter = Transform { rotation: [[0.0, -1.0], [1.0, 0.0]], scale: 2.0, translation: [5.0, 5.0] };
        assert_eq!(quarter.apply_covariance([[1.0, 0.0], [0.0, 9.0]]), [[36.0, 0.0], [0.0, 4.0]]);
    }

    #[test]
    fn no_frame_from_collinear_points() {
        assert!(frame([0.0, 0.0], [1.0, 1.0], [2.0, 2.0]).is_none());
        assert!(frame([0.0, 0.0], [0.0, 0.0], [2.0, 2.0]).is_none());
        assert!(align(&[], &[], true).is_none());
    }
}
