//! How flat a set of points is.

use std::array::from_fn;

use faer::Mat;

use crate::points::{centroid, minus};

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
    use super::{flatness, slenderness};

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
}
