//! Why arrival times cannot be taken.

use crate::signal::SignalError;
use thiserror::Error;

/// Why arrival times cannot be taken.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum TimeError {
    /// An option is out of range.
    #[error("{name} is {value}, but must be {range}")]
    Option {
        /// Name of the option.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// The signal cannot be looked for.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// What is compared has too many periods.
    #[error(
        "frequencies up to {highest} Hz over {length} s are too much to compare; lower the end of the band, or take less of \
         the sound"
    )]
    TooLong {
        /// The highest frequency, Hz.
        highest: f64,
        /// Length of what is compared, seconds.
        length: f64,
    },
}
