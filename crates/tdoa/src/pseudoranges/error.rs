//! Why numbers do not form a matrix of pseudoranges.

use hc::poly::counted;
use thiserror::Error;

/// Largest number of cells (receivers times transmitters) of a matrix: 24 million. Memory is
/// proportional to the number of measured cells.
pub const MAX_CELLS: usize = 24_000_000;

/// Largest magnitude of a value, in metres. Above it a double cannot resolve a tenth of a
/// millimetre.
pub const MAX_MAGNITUDE: f64 = 1e12;

/// Why numbers do not form a matrix of pseudoranges. Receivers and transmitters are given by name,
/// or counted from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum PseudorangeError {
    /// No receivers or no transmitters.
    #[error("the matrix is empty ({}, {})", counted(*.receivers, "receiver"), counted(*.transmitters, "transmitter"))]
    Empty {
        /// Number of rows.
        receivers: usize,
        /// Number of columns.
        transmitters: usize,
    },
    /// More than [`MAX_CELLS`] cells.
    #[error(
        "{} times {} are more than {MAX_CELLS} cells; split the recording",
        counted(*.receivers, "receiver"),
        counted(*.transmitters, "transmitter")
    )]
    TooLarge {
        /// Number of rows.
        receivers: usize,
        /// Number of columns.
        transmitters: usize,
    },
    /// The number of values is not receivers times transmitters.
    #[error("{expected} {what} are needed, one a {per}, but {found} were given")]
    Count {
        /// What is counted.
        what: &'static str,
        /// What each of them belongs to.
        per: &'static str,
        /// How many there should be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// An infinite value, or one above [`MAX_MAGNITUDE`].
    #[error(
        "receiver {receiver}, transmitter {transmitter}: {value:e} is not a usable pseudorange (metres, magnitude at \
         most {MAX_MAGNITUDE:e}); leave the cell empty or write nan if it was not measured, and subtract a common \
         time from each transmitter's column if the clock starts long ago"
    )]
    Unusable {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// The value.
        value: f64,
    },
    /// A time of sending that is not finite, or above [`MAX_MAGNITUDE`].
    #[error(
        "transmitter {transmitter}: {value:e} is not a usable time of sending (metres, magnitude at most {MAX_MAGNITUDE:e})"
    )]
    EmissionTime {
        /// Name of the transmitter.
        transmitter: String,
        /// The value.
        value: f64,
    },
    /// A standard deviation that is not positive and finite.
    #[error(
        "receiver {receiver}, transmitter {transmitter}: the standard deviation must be positive and finite, not {value}"
    )]
    Sigma {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// The value.
        value: f64,
    },
    /// A weight that is negative or not finite.
    #[error("receiver {receiver}, transmitter {transmitter}: the weight must be finite and not negative, not {value}")]
    Weight {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
        /// The value.
        value: f64,
    },
    /// All weights are zero.
    #[error("all weights are zero, so that no measurement is left; give positive weights")]
    NoWeight,
    /// A cell beyond the last receiver or transmitter.
    #[error("receiver {receiver}, transmitter {transmitter}: there are only {configuration}")]
    Outside {
        /// Number of the receiver, from 1.
        receiver: usize,
        /// Number of the transmitter, from 1.
        transmitter: usize,
        /// The size of the matrix, such as `6r/3s`.
        configuration: String,
    },
    /// Two values for one cell.
    #[error("receiver {receiver}, transmitter {transmitter} is there twice; keep one measurement of each pair")]
    Twice {
        /// Number of the receiver, from 1.
        receiver: usize,
        /// Number of the transmitter, from 1.
        transmitter: usize,
    },
    /// Further candidates of a cell that was not measured.
    #[error(
        "receiver {receiver}, transmitter {transmitter} has further candidates but no first one; give that as its value"
    )]
    NoFirst {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
    },
    /// Two receivers, or two transmitters, with the same name.
    #[error("two {kind}s are named {name:?}; names must differ")]
    DuplicateName {
        /// "receiver" or "transmitter".
        kind: &'static str,
        /// The name.
        name: String,
    },
}
