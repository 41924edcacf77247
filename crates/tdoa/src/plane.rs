//! Sets of points of the plane.

use crate::points::centroid;

/// Ratio of the standard deviations across and along a set of points; 1 for fewer than three.
pub(crate) fn flatness(points: &[[f64; 2]]) -> f64 {
    if points.len() < 3 {
        return 1.0;
    }
    let centre = centroid(points.iter());
    let moment = |a: usize, b: usize| points.iter().map(|p| (p[a] - centre[a]) * (p[b] - centre[b])).sum::<f64>();
    let (xx, xy, yy) = (moment(0, 0), moment(0, 1), moment(1, 1));
    let root = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    let (large, small) = (0.5 * (xx + yy) + root, (xx * yy - xy * xy) / (0.5 * (xx + yy) + root));
    if large > 0.0 { (small.max(0.0) / large).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::flatness;

    #[test]
    fn flat_sets_of_points() {
        assert_eq!(flatness(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]), 0.0);
        assert!((flatness(&[[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]) - 1.0).abs() < 1e-12);
    }
}
