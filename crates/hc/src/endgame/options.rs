//! Settings of the endgame.

use crate::tolerances::endgame;
use crate::tracker::OptionError;
use serde::Serialize;

/// Settings of the endgame.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct EndgameOptions {
    /// A path whose `t` has fallen below this value without reaching the target goes to the
    /// endgame. Default 1e-5.
    pub start: f64,
    /// Radius of the first loop. Default 1e-6.
    pub radius: f64,
    /// Divisor of the radius when the loop was too wide, at least 1.5. Default 30.
    pub shrink: f64,
    /// Paths that are undecided below this radius are lost. Default 1e-13.
    pub min_radius: f64,
    /// Turns after which the first loop is given up as too wide. Each smaller loop may take twice
    /// as many as the one before. Default 16.
    pub turns: usize,
}

impl Default for EndgameOptions {
    fn default() -> Self {
        EndgameOptions { start: 1e-5, radius: 1e-6, shrink: 30.0, min_radius: 1e-13, turns: 16 }
    }
}

impl EndgameOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first setting that is outside its range.
    pub fn validate(&self) -> Result<(), OptionError> {
        OptionError::positive(&[
            ("endgame.start", self.start),
            ("endgame.radius", self.radius),
            ("endgame.min_radius", self.min_radius),
            ("endgame.shrink", self.shrink),
        ])?;
        OptionError::at_least("endgame.shrink", self.shrink, endgame::LEAST_SHRINK, "at least 1.5")?;
        OptionError::at_least("endgame.turns", self.turns as f64, 1.0, "at least 1")
    }
}
