//! How flat a set of points is, and the plane in which it nearly lies.

use std::array::from_fn;

use faer::{Mat, Side};

use crate::align::{Transform, frame};
use crate::network::Network;
use crate::points::{centroid, dot, minus};

/// Ratio of the standard deviations of nodes across and along, below which they lie nearly in one line, or
/// in space in one plane.
pub(crate) const FLAT: f64 = 0.02;

/// Ratio of the standard deviations of points along the axis on which they lie closest and the one on
/// which they stretch farthest: 0 for points in one line, in space in one plane. 1 for so few that they
/// always do.
pub(crate) fn flatness<const D: usize>(points: &[[f64; D]]) -> f64 {
    if points.len() <= D {
        return 1.0;
    }
    let [large, .., small] = variances(points)[..] else { return 1.0 };
    if large > 0.0 { (small.max(0.0) / large).sqrt() } else { 0.0 }
}

/// Ratio of the standard deviations of points along the two axes on which they stretch farthest: 0 for
/// points in one line. 1 for fewer than three.
pub(crate) fn slenderness<const D: usize>(points: &[[f64; D]]) -> f64 {
    if points.len() <= 2 {
        return 1.0;
    }
    let [large, next, ..] = variances(points)[..] else { return 1.0 };
    if large > 0.0 { (next.max(0.0) / large).sqrt() } else { 0.0 }
}

/// The plane of best fit of points in space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plane<const D: usize> {
    centre: [f64; D],
    /// Of length one.
    pub(crate) normal: [f64; D],
}

impl<const D: usize> Plane<D> {
    /// The plane nearest to these points; `None` if they lie nearly in one line, and in the plane.
    pub(crate) fn through(points: &[[f64; D]]) -> Option<Plane<D>> {
        if D != 3 || points.len() < 3 || slenderness(points) < FLAT {
            return None;
        }
        let (centre, axes) = axes(points)?;
        let normal = axes[0];
        normal.iter().all(|x| x.is_finite()).then_some(Plane { centre, normal })
    }

    /// How far a point lies above the plane, which is the side that the normal shows.
    pub(crate) fn height(&self, p: [f64; D]) -> f64 {
        dot(minus(p, self.centre), self.normal)
    }

    /// The mirror image of a point in the plane.
    pub(crate) fn mirrored(&self, p: [f64; D]) -> [f64; D] {
        let height = self.height(p);
        from_fn(|k| p[k] - 2.0 * height * self.normal[k])
    }
}

/// The rigid motion after which the receivers of a network lie about z = 0 and its transmitters about a plane z =
/// constant; `None` where the nodes do not tell a plane, and in the plane.
///
/// The plane may be that of the receivers, of the transmitters, or of both: it is the one above which normal heights
/// are likeliest. Transmitters on both sides of a table have a plane of their own that is another one.
pub(crate) fn levelled<const D: usize>(network: &Network<D>) -> Option<Transform<D>> {
    let centred = |points: &[[f64; D]]| {
        let centre = centroid(points.iter());
        points.iter().map(|p| minus(*p, centre)).collect::<Vec<_>>()
    };
    let (receivers, transmitters) = (centred(&network.receivers), centred(&network.transmitters));
    let all = [receivers.as_slice(), &transmitters].concat();
    if D != 3 {
        return None;
    }
    let least = FLAT * FLAT * network.size();
    let of_heights = |points: &[[f64; D]], normal: [f64; D]| {
        let squares = points.iter().map(|p| dot(*p, normal).powi(2)).sum::<f64>();
        points.len() as f64 * (squares / points.len().max(1) as f64).sqrt().max(least).ln()
    };
    let tells = |points: &&Vec<[f64; D]>| points.len() > D && slenderness(points) >= FLAT;
    let planes = [&all, &receivers, &transmitters].into_iter().filter(tells).filter_map(|points| axes(points));
    let misfit = |axes: &[[f64; D]; D]| of_heights(&receivers, axes[0]) + of_heights(&transmitters, axes[0]);
    let best = planes.map(|(_, axes)| axes).min_by(|a, b| misfit(a).total_cmp(&misfit(b)))?;
    upright(centroid(network.receivers.iter()), best)
}

/// The rigid motion after which points lie about z = 0; `None` where they lie nearly in one line, and in the plane.
pub(crate) fn level_plane<const D: usize>(points: &[[f64; D]]) -> Option<Transform<D>> {
    if D != 3 || points.len() < 3 || slenderness(points) < FLAT {
        return None;
    }
    let (centre, axes) = axes(points)?;
    upright(centre, axes)
}

/// The motion that puts the centre at zero and the axes, the shortest first, on z, y and x.
fn upright<const D: usize>(centre: [f64; D], axes: [[f64; D]; D]) -> Option<Transform<D>> {
    frame(centre, from_fn(|k| from_fn(|a| centre[a] + axes[D - 1 - k][a])))
}

/// Standard deviation of points along the axis on which they stretch second farthest, and that axis. `None`
/// for fewer than three points.
pub(crate) fn breadth<const D: usize>(points: &[[f64; D]]) -> Option<(f64, [f64; D])> {
    if points.len() <= 2 {
        return None;
    }
    let (centre, axes) = axes(points)?;
    let axis = axes[D - 2];
    // By the points and not by the moments, which lose half of the digits.
    let squares = points.iter().map(|p| dot(minus(*p, centre), axis).powi(2));
    let width = (squares.sum::<f64>() / points.len() as f64).sqrt();
    width.is_finite().then_some((width, axis))
}

/// The centroid of points and their principal axes, of length one, the one on which they lie closest first.
fn axes<const D: usize>(points: &[[f64; D]]) -> Option<([f64; D], [[f64; D]; D])> {
    let centre = centroid(points.iter());
    let moment = |a: usize, b: usize| points.iter().map(|p| (p[a] - centre[a]) * (p[b] - centre[b])).sum::<f64>();
    // Eigenvalues ascend.
    let axes = Mat::from_fn(D, D, moment).self_adjoint_eigen(Side::Lower).ok()?;
    Some((centre, from_fn(|k| from_fn(|a| axes.U()[(a, k)]))))
}

/// Second moments of points along their principal axes, the largest first.
fn variances<const D: usize>(points: &[[f64; D]]) -> [f64; D] {
    let centre = centroid(points.iter());
    let moment = |a: usize, b: usize| points.iter().map(|p| (p[a] - centre[a]) * (p[b] - centre[b])).sum::<f64>();
    if D == 2 {
        let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
        let large = 0.5 * (xx + yy) + (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
        // By the product of both, which keeps the digits of the smaller one.
        let both = [large, (xx * yy - xy * xy) / large];
        return from_fn(|k| both[k]);
    }
    let rows: Vec<[f64; D]> = points.iter().map(|&p| minus(p, centre)).collect();
    let values = Mat::from_fn(rows.len(), D, |i, k| rows[i][k]).singular_values().unwrap_or_default();
    from_fn(|k| values.get(k).map_or(f64::NAN, |s| s * s))
}

#[cfg(test)]
mod tests {
    use super::{Plane, breadth, flatness, slenderness};
    use crate::points::distance;

    #[test]
    fn flat_sets_of_points() {
        assert_eq!(flatness(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]), 0.0);
        assert!((flatness(&[[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn planes_and_lines_in_space() {
        let line = [[0.0, 0.0, 0.0], [1.0, 2.0, 2.0], [2.0, 4.0, 4.0], [-3.0, -6.0, -6.0]];
        assert!(flatness(&line) < 1e-15 && slenderness(&line) < 1e-15);
        // A rectangle of 8 by 4 in the plane x = z.
        let side = 8.0 / 2f64.sqrt();
        let plane = [[0.0, 0.0, 0.0], [side, 0.0, side], [0.0, 4.0, 0.0], [side, 4.0, side]];
        assert!(flatness(&plane) < 1e-15 && (slenderness(&plane) - 0.5).abs() < 1e-14);
        assert_eq!(flatness(&line[..3]), 1.0);
    }
    #[test]
    fn the_second_axis_of_a_box() {
        // Corners of a box of 6 by 4 by 2, whose sides are along y, z and x.
        let corner = |k: usize| [[-1.0, 1.0][k % 2], [-3.0, 3.0][k / 2 % 2], [-2.0, 2.0][k / 4]];
        let corners: Vec<[f64; 3]> = (0..8).map(corner).collect();
        let (width, axis) = breadth(&corners).unwrap();
        assert!((width - 2.0).abs() < 1e-12 && (axis[2].abs() - 1.0).abs() < 1e-12, "{width} {axis:?}");
        assert_eq!(breadth(&corners[..2]), None);
    }

    #[test]
    fn points_are_mirrored_in_the_plane_of_others() {
        // In the plane x + y + z = 6, whose normal is (1, 1, 1) / sqrt 3.
        let plane = Plane::through(&[[6.0, 0.0, 0.0], [0.0, 6.0, 0.0], [0.0, 0.0, 6.0], [2.0, 2.0, 2.0]]).unwrap();
        assert!((plane.height([0.0; 3]).abs() - 12f64.sqrt()).abs() < 1e-12);
        assert!(distance(plane.mirrored([0.0; 3]), [4.0; 3]) < 1e-12);
        assert!(distance(plane.mirrored([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]) < 1e-12);
        let line = [[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        assert!(Plane::through(&line).is_none() && Plane::through(&line[..2]).is_none());
        assert!(Plane::through(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).is_none());
    }
}
