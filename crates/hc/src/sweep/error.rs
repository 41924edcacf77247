//! Why a family cannot be swept.

use super::grid::GridError;
use crate::family::FamilyError;

/// Why a family cannot be swept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// The family or its fibre cannot be tracked.
    #[error(transparent)]
    Family(#[from] FamilyError),
    /// The grid does not fit.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// Coefficients that are not real.
    #[error(
        "the family has coefficients that are not real; real solutions come and go at folds only where all are real: \
         write its equations with real ones"
    )]
    NotReal,
    /// A grid of another number of parameters.
    #[error("the grid has {found} parameters, the family {expected}; make it with this family")]
    Misfit {
        /// Number of parameters of the grid.
        found: usize,
        /// Number of parameters of the family.
        expected: usize,
    },
}
