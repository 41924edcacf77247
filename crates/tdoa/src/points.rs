//! Points of the plane (`D` = 2) or of space (`D` = 3).

use std::array::from_fn;

/// Euclidean distance.
pub(crate) fn distance<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    let between = minus(a, b);
    dot(between, between).sqrt()
}

/// The vector from `b` to `a`.
pub(crate) fn minus<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    from_fn(|k| a[k] - b[k])
}

/// The scalar product.
pub(crate) fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

/// The trace of a covariance: the mean square of the distance from where a point is expected.
pub(crate) fn trace<const D: usize>(covariance: &[[f64; D]; D]) -> f64 {
    (0..D).map(|k| covariance[k][k]).sum()
}

/// The direction of the part of a vector that is orthogonal to these orthonormal ones, and the
/// length of that part.
pub(crate) fn off<const D: usize>(mut u: [f64; D], basis: &[[f64; D]]) -> ([f64; D], f64) {
    // Twice is enough (Kahan; Parlett 1980).
    for _ in 0..2 {
        for e in basis {
            let along = dot(u, *e);
            u = from_fn(|k| u[k] - along * e[k]);
        }
    }
    let size = dot(u, u).sqrt();
    (u.map(|x| x / size), size)
}

/// The largest distance of two points; `None` of less than two.
pub(crate) fn extent<const D: usize>(points: &[[f64; D]]) -> Option<f64> {
    let pairs = points.iter().enumerate().flat_map(|(k, a)| points[..k].iter().map(|b| distance(*a, *b)));
    pairs.reduce(f64::max)
}

/// The centroid of some points; the origin if there are none.
pub(crate) fn centroid<'a, const D: usize>(points: impl Iterator<Item = &'a [f64; D]> + Clone) -> [f64; D] {
    let count = points.clone().count().max(1) as f64;
    from_fn(|k| points.clone().map(|p| p[k]).sum::<f64>() / count)
}

/// Root mean square distance of points from their centroid; zero if there are none.
pub(crate) fn spread<'a, const D: usize>(points: impl Iterator<Item = &'a [f64; D]> + Clone) -> f64 {
    let (centre, count) = (centroid(points.clone()), points.clone().count().max(1) as f64);
    (points.map(|&p| distance(p, centre).powi(2)).sum::<f64>() / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::{centroid, distance, spread};

    #[test]
    fn centroid_and_spread_of_a_square() {
        let square = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [2.0, 2.0]];
        assert_eq!((centroid(square.iter()), spread(square.iter())), ([1.0, 1.0], 2f64.sqrt()));
        assert_eq!((centroid::<2>([].iter()), spread::<2>([].iter())), ([0.0, 0.0], 0.0));
    }

    #[test]
    fn a_box_in_space() {
        // Half the diagonal of a box of 2 by 3 by 6, which is 7.
        let corners: Vec<[f64; 3]> =
            (0..8).map(|k| [2.0 * f64::from(k & 1), 3.0 * f64::from(k >> 1 & 1), 6.0 * f64::from(k >> 2)]).collect();
        assert_eq!(distance(corners[0], corners[7]), 7.0);
        assert_eq!((centroid(corners.iter()), spread(corners.iter())), ([1.0, 1.5, 3.0], 3.5));
    }
}
