//! Nodes that measure the same up to a constant: they stand in one place, or one is a copy of the
//! other.
//!
//! What "the same" means depends on what the numbers may be. Measurements from anywhere may be
//! printed with few digits; data that are solved exactly are taken at their word, as two nodes a
//! micrometre apart are two nodes.

/// The constant by which the second of each pair exceeds the first, up to `tolerance`; `None` if it
/// varies or there are fewer than three pairs.
pub(crate) fn constant_difference(pairs: impl Iterator<Item = (f64, f64)>, tolerance: f64) -> Option<f64> {
    let (mut low, mut high, mut count) = (f64::INFINITY, f64::NEG_INFINITY, 0);
    for (x, y) in pairs {
        low = low.min(y - x);
        high = high.max(y - x);
        if high - low > tolerance {
            return None;
        }
        count += 1;
    }
    if count >= 3 { Some(0.5 * (low + high)) } else { None }
}

/// The tolerance for printed numbers: a millionth of how much the first of the pairs vary.
pub(crate) fn printed(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut least, mut most, mut size) = (f64::INFINITY, f64::NEG_INFINITY, 0.0f64);
    for (x, y) in pairs {
        least = least.min(x);
        most = most.max(x);
        size = size.max(x.abs()).max(y.abs());
    }
    1e-6 * (most - least) + 1e-14 * size
}

/// The tolerance for exact data: what rounding of numbers up to this size can tell apart.
pub(crate) fn rounding(largest: f64) -> f64 {
    64.0 * f64::EPSILON * largest
}

#[cfg(test)]
mod tests {
    use super::{constant_difference, printed, rounding};

    #[test]
    fn copies_are_told_from_neighbours() {
        let first = [1.0, 2.0, 4.0];
        let pairs = |by: [f64; 3]| first.into_iter().zip(by).map(|(x, d)| (x, x + d)).collect::<Vec<_>>();
        let is_copy = |pairs: &[(f64, f64)], tolerance| constant_difference(pairs.iter().copied(), tolerance);
        // Six digits printed: a copy for measurements, not for exact data.
        let near = pairs([0.5, 0.5, 0.500001]);
        assert!(is_copy(&near, printed(near.iter().copied())).is_some_and(|c| (c - 0.5).abs() < 1e-6));
        assert_eq!(is_copy(&near, rounding(4.5)), None);
        let exact = pairs([0.5; 3]);
        assert_eq!(is_copy(&exact, rounding(4.5)), Some(0.5));
        // Any two pairs differ by some constant, give or take.
        assert_eq!(is_copy(&exact[..2], rounding(4.5)), None);
    }
}
