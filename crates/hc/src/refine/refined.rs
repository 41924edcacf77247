//! The result of a refinement.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// What refinement tells about a solution.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Refined {
    /// The refined point.
    pub point: Vec<Complex64>,
    /// Relative size of the last correction, about the relative error of the point.
    pub accuracy: f64,
    /// Whether the point is clearly a regular solution: corrections shrank by a factor of a
    /// thousand at once or were tiny from the first, the last correction was tiny, the condition is
    /// good, and no row of the Jacobian is so small that it may be rounding error. A regular
    /// solution may be less clear than that.
    pub plain: bool,
    /// Largest residual, each relative to its row of the Jacobian times the sizes of the
    /// coordinates.
    pub residual: f64,
    /// Condition number of the Jacobian, with rows scaled to equal size and unknowns measured by
    /// their own size; infinite if the Jacobian is singular.
    pub condition: f64,
}
