//! Sizes of parameters and unknowns, which set the scale of the random numbers drawn for them.

use super::fibre::Fibre;

/// Sizes in this range count as one.
const UNIT_SIZES: std::ops::RangeInclusive<f64> = 1.0 / 64.0..=64.0;

/// The natural size of numbers of this size, by which random numbers are drawn: one, unless they are much
/// larger or smaller, as lengths in millimetres are.
pub(super) fn natural_size(size: f64) -> f64 {
    if UNIT_SIZES.contains(&size) || !size.is_normal() { 1.0 } else { size }
}

/// Sizes of the parameters and unknowns of a family.
#[derive(Clone, PartialEq)]
pub(super) struct Sizes {
    pub(super) parameters: Vec<f64>,
    pub(super) unknowns: Vec<f64>,
}

impl Sizes {
    /// The natural sizes of the parameters of a fibre, and of its largest solutions.
    pub(super) fn natural(fibre: &Fibre) -> Sizes {
        Sizes {
            parameters: fibre.parameters.iter().map(|p| natural_size(p.norm())).collect(),
            unknowns: largest(fibre).into_iter().map(natural_size).collect(),
        }
    }
}

/// The size of the largest value of each unknown.
pub(super) fn largest(fibre: &Fibre) -> Vec<f64> {
    (0..fibre.dimension).map(|j| fibre.iter().map(|x| x[j].norm()).fold(0.0, f64::max)).collect()
}
