//! Why arrival times cannot be taken.

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
    /// What is compared has too many frequencies.
    #[error(
        "a band of {band} Hz and a length of {length} s are too much to compare; take a narrower band or less of the sound"
    )]
    TooLong {
        /// Width of the band, Hz.
        band: f64,
        /// Length of what is compared, seconds.
        length: f64,
    },
}
