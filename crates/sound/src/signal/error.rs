//! Why a signal cannot be looked for.

use thiserror::Error;

use crate::error::ReadError;

/// Why a signal cannot be looked for.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SignalError {
    /// A number is out of range.
    #[error("{name} must be {range}, not {value}")]
    Range {
        /// What it is of.
        name: &'static str,
        /// What it may be.
        range: &'static str,
        /// What it is.
        value: f64,
    },
    /// A template in which there is nothing.
    #[error("the template is silent; give samples of the signal")]
    Silent,
    /// A signal that is too long.
    #[error("the signal takes {seconds} s, and at most {most} s can be looked for; take a part of it")]
    TooLong {
        /// How long it is, seconds.
        seconds: f64,
        /// How long it may be, seconds.
        most: f64,
    },
    /// A signal that has too little in the band.
    #[error(
        "of the signal {width:.0} Hz are between {lower} and {upper} Hz, and 100 Hz must be; change the band of frequencies, \
         or take a recording with a higher sample rate"
    )]
    Band {
        /// How much it has in the band, Hz.
        width: f64,
        /// Beginning of the band, Hz.
        lower: f64,
        /// End of the band, or of what the sample rate has, Hz.
        upper: f64,
    },
}

/// Why a template cannot be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum TemplateError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// What is in the file is no signal.
    #[error("{file}: {source}")]
    Signal {
        /// The file.
        file: String,
        /// What is wrong.
        source: SignalError,
    },
}
