//! Windows whose ends fade.

use std::f64::consts::PI;

/// A window of Tukey, where this share of its length has passed: it rises and falls as a cosine does, over the share `end` at
/// either end, is 1 between, and 0 outside.
pub(crate) fn fade(share: f64, end: f64) -> f64 {
    let end = share.min(1.0 - share).max(0.0) / end;
    if end >= 1.0 { 1.0 } else { 0.5 - 0.5 * (PI * end).cos() }
}

#[cfg(test)]
mod tests {
    use super::fade;

    #[test]
    fn half_of_the_height_is_in_the_middle_of_either_end() {
        for (share, height) in
            [(-1.0, 0.0), (0.0, 0.0), (0.1, 0.5), (0.2, 1.0), (0.7, 1.0), (0.9, 0.5), (1.0, 0.0), (3.0, 0.0)]
        {
            assert!((fade(share, 0.2) - height).abs() < 1e-12, "{share}");
        }
    }
}
