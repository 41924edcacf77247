//! Why there are no mixed cells.

use crate::checkpoint::CheckpointError;
use crate::ranks::RanksError;
use poly::counted;

/// Integers have grown beyond the limit of their type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Overflow;

/// Why there are no mixed cells.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MixedError {
    /// The number of supports differs from the number of unknowns.
    #[error("{} in {}; as many supports as unknowns are needed", counted(*.supports, "support"), counted(*.unknowns, "unknown"))]
    NotSquare {
        /// Number of supports.
        supports: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// An exponent vector of the wrong length.
    #[error("a point of support {support} has {}, for {}", counted(*.found, "exponent"), counted(*.unknowns, "unknown"))]
    Length {
        /// The support, from 1.
        support: usize,
        /// Length of the exponent vector.
        found: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A lifting that does not fit the supports.
    #[error("support {support} has {} but its lifting {}", counted(*.points, "point"), counted(*.values, "value"))]
    Lifting {
        /// The support, from 1.
        support: usize,
        /// Number of its points.
        points: usize,
        /// Number of its values.
        values: usize,
    },
    /// Volumes beyond 64 bits, or determinants beyond 126.
    #[error("the exponents are so large that volumes of cells exceed 64 bits; divide exponents by common factors")]
    TooLarge,
    /// Mixed cells that had been written to a temporary file could not be read back.
    #[error("mixed cells cannot be read back from a temporary file; look at the folder for such files (TMPDIR)")]
    Storage,
    /// Other processes cannot take part.
    #[error(transparent)]
    Ranks(#[from] RanksError),
    /// A checkpoint, in which nothing would be recorded.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// The work was cancelled by its [`Monitor`](crate::monitor::Monitor).
    #[error("cancelled before all mixed cells were found")]
    Cancelled,
}

impl From<Overflow> for MixedError {
    fn from(_: Overflow) -> Self {
        MixedError::TooLarge
    }
}
