//! What measurements say of a third coordinate.

use serde::{Deserialize, Serialize};

/// What the measurements say of a third coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DimensionTest {
    /// How much more likely the measurements are in space than in the plane (natural logarithm); `None`
    /// where space could not be tried, for instance because there are too few measurements.
    pub gain: Option<f64>,
    /// The gain that was needed for space; `None` where none would do, for lack of measurements beyond the
    /// unknowns in space.
    pub needed: Option<f64>,
}

impl DimensionTest {
    pub(crate) const UNTRIED: DimensionTest = DimensionTest { gain: None, needed: None };

    /// Whether the gain is so many times what is needed.
    pub(crate) fn supports(&self, factor: f64) -> bool {
        self.gain.zip(self.needed).is_some_and(|(gain, needed)| gain >= factor * needed)
    }
}
