//! Points of the plane.

/// Euclidean distance.
pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    (dx * dx + dy * dy).sqrt()
}

/// The centroid of some points; the origin if there are none.
pub(crate) fn centroid<'a>(points: impl Iterator<Item = &'a [f64; 2]> + Clone) -> [f64; 2] {
    let count = points.clone().count().max(1) as f64;
    [0, 1].map(|k| points.clone().map(|p| p[k]).sum::<f64>() / count)
}

/// Root mean square distance of points from their centroid; zero if there are none.
pub(crate) fn spread<'a>(points: impl Iterator<Item = &'a [f64; 2]> + Clone) -> f64 {
    let (centre, count) = (centroid(points.clone()), points.clone().count().max(1) as f64);
    (points.map(|&p| distance(p, centre).powi(2)).sum::<f64>() / count).sqrt()
}

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
    use super::{centroid, flatness, spread};

    #[test]
    fn flat_sets_of_points() {
        assert_eq!(flatness(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0]]), 0.0);
        assert!((flatness(&[[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn centroid_and_spread_of_a_square() {
        let square = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [2.0, 2.0]];
        assert_eq!((centroid(square.iter()), spread(square.iter())), ([1.0, 1.0], 2f64.sqrt()));
        assert_eq!((centroid([].iter()), spread([].iter())), ([0.0, 0.0], 0.0));
    }
}
