//! Sizes of parameters and unknowns, on which random numbers beside them are drawn.

/// Sizes that count as one.
const UNIT_SIZES: std::ops::RangeInclusive<f64> = 1.0 / 64.0..=64.0;

/// The size on which random numbers are drawn beside numbers of that size: one unless they are much
/// larger or smaller, as lengths in millimetres are.
pub(super) fn natural_size(size: f64) -> f64 {
    if UNIT_SIZES.contains(&size) || !size.is_normal() { 1.0 } else { size }
}
