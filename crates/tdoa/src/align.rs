//! Procrustes alignment in the plane and in space: the distance-preserving map (or similarity) that
//! brings one set of points closest to another. Reflections are allowed, because arrival times cannot
//! tell a network from its mirror image.

use faer::Mat;
use serde::Serialize;
use std::array::from_fn;

use crate::network::Network;
use crate::points::{centroid, distance, dot, minus, off};

/// The map p -> scale * rotation * p + translation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize, [[f64; D]; D]: Serialize")]
pub struct Transform<const D: usize = 2> {
    /// An orthogonal matrix, row by row; its determinant is -1 if it reflects.
    pub rotation: [[f64; D]; D],
    /// Factor on lengths.
    pub scale: f64,
    /// Translation in metres.
    pub translation: [f64; D],
}

impl<const D: usize> Transform<D> {
    /// The map that leaves every point where it is.
    pub const IDENTITY: Self = {
        let mut rotation = [[0.0; D]; D];
        let mut k = 0;
        while k < D {
            rotation[k][k] = 1.0;
            k += 1;
        }
        Transform { rotation, scale: 1.0, translation: [0.0; D] }
    };

    /// The image of a point.
    pub fn apply(&self, p: [f64; D]) -> [f64; D] {
        let q = self.turn(p);
        from_fn(|k| self.scale * q[k] + self.translation[k])
    }

    /// The image of a direction: turned (and reflected), but neither scaled nor moved.
    pub fn turn(&self, p: [f64; D]) -> [f64; D] {
        self.rotation.map(|row| dot(row, p))
    }

    /// The image of a whole network. Offsets are lengths, so they are scaled too.
    pub fn apply_network(&self, network: &Network<D>) -> Network<D> {
        Network {
            receivers: network.receivers.iter().map(|&p| self.apply(p)).collect(),
            transmitters: network.transmitters.iter().map(|&p| self.apply(p)).collect(),
            offsets: network.offsets.iter().map(|o| self.scale * o).collect(),
            clocks: network.clocks.iter().map(|clock| clock.map(|x| self.scale * x)).collect(),
        }
    }

    /// The covariance of the image of a point with this covariance.
    pub fn apply_covariance(&self, c: [[f64; D]; D]) -> [[f64; D]; D] {
        let r = &self.rotation;
        let entry = |a: usize, b: usize| -> f64 {
            (0..D).flat_map(|k| (0..D).map(move |l| (k, l))).map(|(k, l)| r[a][k] * c[k][l] * r[b][l]).sum::<f64>()
                * self.scale
                * self.scale
        };
        from_fn(|a| from_fn(|b| entry(a, b)))
    }
}

/// An alignment, and how well it fits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize, [[f64; D]; D]: Serialize")]
pub struct Alignment<const D: usize = 2> {
    /// The map.
    pub transform: Transform<D>,
    /// Root mean square distance of the mapped points from their targets, in metres.
    pub rms: f64,
}

/// The map with least squared error from `from` to `to` (the same number of points, paired by
/// index): rotation or reflection and translation, and a common scale if `scale` is true. `None` if
/// there are no points, if the numbers of points differ, or if a coordinate in space is not finite.
///
/// Points that do not span the space leave more than one best map, and one of these is returned.
pub fn align<const D: usize>(from: &[[f64; D]], to: &[[f64; D]], scale: bool) -> Option<Alignment<D>> {
    if from.is_empty() || from.len() != to.len() {
        return None;
    }
    let (c, d) = (centroid(from.iter()), centroid(to.iter()));
    let pairs = || from.iter().zip(to).map(|(&a, &b)| (minus(a, c), minus(b, d)));
    // A formula for the plane, which takes a small part of the time that a decomposition does: a
    // calibration aligns thousands of networks.
    let (rotation, along) = if D == 2 { turn_in_plane(pairs()) } else { turn_by_svd(pairs())? };
    let spread = pairs().fold(0.0, |sum, (a, _)| sum + dot(a, a));
    let scale = if scale && spread > 0.0 { along / spread } else { 1.0 };
    let mut transform = Transform { rotation, scale, translation: [0.0; D] };
    transform.translation = minus(d, transform.apply(c));
    let sum: f64 = from.iter().zip(to).map(|(&a, &b)| distance(transform.apply(a), b).powi(2)).sum();
    Some(Alignment { transform, rms: (sum / from.len() as f64).sqrt() })
}

/// The orthogonal matrix R with the largest sum of b . R a over pairs (a, b), and that sum.
///
/// With points of the plane as complex numbers, the best rotation is the phase of sum conj(a) b, and
/// the best reflection the phase of sum a b. The better of the two is the one with the larger
/// modulus.
fn turn_in_plane<const D: usize>(pairs: impl Iterator<Item = ([f64; D], [f64; D])>) -> ([[f64; D]; D], f64) {
    let (mut rotation, mut reflection) = ([0.0; 2], [0.0; 2]);
    for (a, b) in pairs {
        let (ax, ay, bx, by) = (a[0], a[1], b[0], b[1]);
        rotation = [rotation[0] + ax * bx + ay * by, rotation[1] + ax * by - ay * bx];
        reflection = [reflection[0] + ax * bx - ay * by, reflection[1] + ax * by + ay * bx];
    }
    let norm = |z: [f64; 2]| z[0].hypot(z[1]);
    let reflect = norm(reflection) > norm(rotation);
    let best = if reflect { reflection } else { rotation };
    let [cos, sin] = if norm(best) > 0.0 { [best[0] / norm(best), best[1] / norm(best)] } else { [1.0, 0.0] };
    let rows = if reflect { [[cos, sin], [sin, -cos]] } else { [[cos, -sin], [sin, cos]] };
    (from_fn(|k| from_fn(|l| rows[k][l])), norm(best))
}

/// The best turn in any dimension: U V^T of the singular value decomposition U S V^T of sum b a^T, and the
/// trace of S (Schoenemann 1966). `None` where that sum is not finite.
fn turn_by_svd<const D: usize>(pairs: impl Iterator<Item = ([f64; D], [f64; D])>) -> Option<([[f64; D]; D], f64)> {
    let mut products = Mat::<f64>::zeros(D, D);
    for (a, b) in pairs {
        for (k, b) in b.iter().enumerate() {
            for (l, a) in a.iter().enumerate() {
                products[(k, l)] += b * a;
            }
        }
    }
    let svd = products.svd().ok().filter(|svd| (0..D).all(|k| svd.S()[k].is_finite()))?;
    let turn = svd.U() * svd.V().transpose();
    Some((from_fn(|k| from_fn(|l| turn[(k, l)])), (0..D).map(|k| svd.S()[k]).sum()))
}

/// The map that puts the point `origin` at zero, the first of `axes` on the positive x axis, the
/// second above it (y > 0) and, in space, the third above the plane of these (z > 0). `None` if the
/// points do not fix a frame (coincident, in one line, in space in one plane).
pub fn frame<const D: usize>(origin: [f64; D], axes: [[f64; D]; D]) -> Option<Transform<D>> {
    let rotation = if D == 2 { frame_in_plane(origin, axes)? } else { orthonormal(origin, axes)? };
    let mut transform = Transform { rotation, scale: 1.0, translation: [0.0; D] };
    transform.translation = transform.apply(origin).map(|x| -x);
    Some(transform)
}

/// A height above an axis, as a share of the first axis, that is rounding.
const FLAT: f64 = 1e-9;

fn frame_in_plane<const D: usize>(origin: [f64; D], axes: [[f64; D]; D]) -> Option<[[f64; D]; D]> {
    let (x_axis, up) = (axes[0], axes[1]);
    let length = distance(origin, x_axis);
    let (cos, sin) = ((x_axis[0] - origin[0]) / length, (x_axis[1] - origin[1]) / length);
    let height = cos * (up[1] - origin[1]) - sin * (up[0] - origin[0]);
    if !(length > 0.0 && height.abs() > FLAT * length) {
        return None;
    }
    let flip = height.signum();
    let rotation = [[cos, sin], [-sin * flip, cos * flip]];
    Some(from_fn(|k| from_fn(|l| rotation[k][l])))
}

/// The axes to these points, each made orthogonal to those before it (Gram and Schmidt).
fn orthonormal<const D: usize>(origin: [f64; D], axes: [[f64; D]; D]) -> Option<[[f64; D]; D]> {
    let mut rotation = [[0.0; D]; D];
    let length = distance(origin, axes[0]);
    for k in 0..D {
        let (axis, height) = off(minus(axes[k], origin), &rotation[..k]);
        if !(height > 0.0 && (k == 0 || height > FLAT * length)) {
            return None;
        }
        rotation[k] = axis;
    }
    Some(rotation)
}

/// The first of these points that fix a frame with the first of all as its origin: axes as [`frame`]
/// takes them. `None` if they lie in one line, in space in one plane.
pub(crate) fn first_axes<const D: usize>(points: &[[f64; D]]) -> Option<[[f64; D]; D]> {
    let (axes, found) = axes(points);
    (found == D).then_some(axes)
}

/// How many dimensions the differences of these points have.
pub(crate) fn spanned<const D: usize>(points: &[[f64; D]]) -> usize {
    axes(points).1
}

/// The first points of a list that are off the point, line or plane of those before, seen from the
/// first of all, and how many there are.
fn axes<const D: usize>(points: &[[f64; D]]) -> ([[f64; D]; D], usize) {
    let (mut axes, mut basis) = ([[0.0; D]; D], [[0.0; D]; D]);
    let (mut found, mut length) = (0, 0.0);
    for &point in points {
        let (axis, height) = off(minus(point, points[0]), &basis[..found]);
        if height > FLAT * length {
            length = if found == 0 { height } else { length };
            (axes[found], basis[found]) = (point, axis);
            found += 1;
            if found == D {
                break;
            }
        }
    }
    (axes, found)
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
        fn the_formula_for_the_plane_is_the_decomposition(points in points(), images in points()) {
            let pairs = || points.iter().copied().zip(images.iter().copied());
            let ((plane, sum), (general, trace)) = (turn_in_plane(pairs()), turn_by_svd(pairs()).unwrap());
            prop_assert!((sum - trace).abs() < 1e-12 * (1.0 + sum));
            // Where rotation and reflection are about as good, either may be taken.
            let det = |r: [[f64; 2]; 2]| r[0][0] * r[1][1] - r[0][1] * r[1][0];
            prop_assume!(det(plane) * det(general) > 0.0);
            let largest = plane.iter().flatten().zip(general.iter().flatten()).map(|(a, b)| (a - b).abs());
            prop_assert!(largest.fold(0.0, f64::max) < 1e-9, "{plane:?} {general:?}");
        }

        #[test]
        fn undoes_any_similarity_in_space(
            points in proptest::collection::vec([-10.0..10.0f64, -10.0..10.0f64, -10.0..10.0f64], 5..12),
            axis in [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64],
            angle in 0.0..6.3f64,
            reflect: bool,
            scale in 0.1..10.0f64,
        ) {
            let length = dot(axis, axis).sqrt();
            prop_assume!(length > 0.1);
            let [x, y, z] = axis.map(|x| x / length);
            // Rodrigues' formula, R = I + sin K + (1 - cos) K^2, K^2 = n n^T - I.
            let cross = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
            let n = [x, y, z];
            let sign = if reflect { -1.0 } else { 1.0 };
            let rotation: [[f64; 3]; 3] = from_fn(|k| from_fn(|l| {
                let one = f64::from(u8::from(k == l));
                sign * (one + angle.sin() * cross[k][l] + (1.0 - angle.cos()) * (n[k] * n[l] - one))
            }));
            let map = Transform { rotation, scale, translation: [3.0, -7.0, 0.5] };
            let image: Vec<_> = points.iter().map(|&p| map.apply(p)).collect();
            // Singular values of the points tell whether they span the space.
            let centre = centroid(points.iter());
            let spans = Mat::from_fn(points.len(), 3, |i, k| points[i][k] - centre[k]).singular_values().unwrap();
            prop_assume!(spans[2] > 0.5);
            let found = align(&points, &image, true).unwrap();
            prop_assert!(found.rms < 1e-10);
            prop_assert!((found.transform.scale - scale).abs() < 1e-9 * scale);
            let rows = found.transform.rotation.iter().flatten().zip(rotation.iter().flatten());
            prop_assert!(rows.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-9);
            let rigid = align(&points, &image, false).unwrap();
            prop_assert!(rigid.transform.scale == 1.0 && rigid.rms >= found.rms - 1e-12);
        }

        #[test]
        fn no_small_turn_is_better(
            points in proptest::collection::vec([-10.0..10.0f64, -10.0..10.0f64, -10.0..10.0f64], 4..9),
            shifts in proptest::collection::vec([-3.0..3.0f64, -3.0..3.0f64, -3.0..3.0f64], 9),
        ) {
            let to: Vec<[f64; 3]> = points.iter().zip(&shifts).map(|(p, by)| from_fn(|k| p[k] + by[k])).collect();
            let found = align(&points, &to, false).unwrap();
            let centre = centroid(to.iter());
            for (k, l) in [(0, 1), (0, 2), (1, 2)] {
                for angle in [1e-3f64, -1e-3] {
                    let turned = |p: [f64; 3]| {
                        let mut p = minus(found.transform.apply(p), centre);
                        (p[k], p[l]) = (angle.cos() * p[k] - angle.sin() * p[l], angle.sin() * p[k] + angle.cos() * p[l]);
                        p
                    };
                    let sum: f64 = points.iter().zip(&to).map(|(&p, &q)| distance(turned(p), minus(q, centre)).powi(2)).sum();
                    prop_assert!((sum / points.len() as f64).sqrt() >= found.rms - 1e-12);
                }
            }
        }

        #[test]
        fn the_plane_has_the_frame_of_any_dimension(points in points()) {
            let (origin, axes) = (points[0], [points[1], points[2]]);
            let (plane, general) = (frame_in_plane(origin, axes), orthonormal(origin, axes));
            prop_assert!(plane.is_some() == general.is_some());
            let pairs = plane.iter().flatten().flatten().zip(general.iter().flatten().flatten());
            prop_assert!(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-6);
        }

        #[test]
        fn frame_places_its_three_points(points in points()) {
            if let Some(map) = frame(points[0], [points[1], points[2]]) {
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
    fn one_point_and_points_in_one_line_are_aligned_in_space() {
        let one = align(&[[1.0, 2.0, 3.0]], &[[4.0, 5.0, 7.0]], true).unwrap();
        assert!(one.rms < 1e-14 && one.transform.scale == 1.0);
        let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
        let turned = line.map(|[x, _, _]| [1.0, 2.0, 5.0 - x]);
        let found = align(&line, &turned, false).unwrap();
        assert!(found.rms < 1e-14);
        // An orthogonal matrix all the same.
        let r = found.transform.rotation;
        for (a, b) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
            assert!((dot(r[a], r[b]) - f64::from(u8::from(a == b))).abs() < 1e-14);
        }
        assert!(align(&[[f64::NAN; 3]; 4], &[[0.0; 3]; 4], false).is_none());
    }

    #[test]
    fn no_frame_from_collinear_points() {
        assert!(frame([0.0, 0.0], [[1.0, 1.0], [2.0, 2.0]]).is_none());
        assert!(frame([0.0, 0.0], [[0.0, 0.0], [2.0, 2.0]]).is_none());
        let [origin, x, on_it, up, above] =
            [[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [6.0, 1.0, 1.0], [2.0, 1.0, 4.0], [0.0, 3.0, 0.0]];
        assert!(frame(origin, [x, on_it, up]).is_none() && frame(origin, [x, up, [4.0, 1.0, 7.0]]).is_none());
        let axes = first_axes(&[origin, origin, x, on_it, up, above]).unwrap();
        assert_eq!(axes, [x, up, above]);
        assert_eq!([spanned(&[origin; 3]), spanned(&[origin, x, on_it]), spanned(&[x, up, on_it])], [0, 1, 2]);
        // Distances to the axes: 3 above x, 2 off the plane.
        let map = frame(origin, axes).unwrap();
        assert_eq!(axes.map(|p| map.apply(p)), [[2.0, 0.0, 0.0], [1.0, 3.0, 0.0], [-1.0, -1.0, 2.0]]);
        assert!(align::<2>(&[], &[], true).is_none() && align::<3>(&[], &[], true).is_none());
    }
}
