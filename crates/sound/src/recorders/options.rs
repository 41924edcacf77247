//! What is expected of clocks.

use crate::events::EventError;

/// Options of how recorders are aligned.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct AlignmentOptions {
    /// By how much the clock of a recorder may be fast or slow, parts per million: 0 to 1000. Default 100.
    pub max_rate: f64,
}

impl Default for AlignmentOptions {
    fn default() -> AlignmentOptions {
        AlignmentOptions { max_rate: 100.0 }
    }
}

impl AlignmentOptions {
    /// Checks the options.
    ///
    /// # Errors
    /// If the rate is out of its range.
    pub fn validate(&self) -> Result<(), EventError> {
        let (name, range, value) = ("the greatest rate of clocks", "0 to 1000 ppm", self.max_rate);
        if (0.0..=1000.0).contains(&value) { Ok(()) } else { Err(EventError::Range { name, range, value }) }
    }
}
