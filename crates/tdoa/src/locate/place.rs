//! Where a transmitter is.

use std::fmt;

use serde::{Serialize, Serializer};

/// Where a transmitter is, and how well that is known.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize, [[f64; D]; D]: Serialize"))]
#[non_exhaustive]
pub struct Place<const D: usize = 2> {
    /// Its position in the frame of the network, metres.
    pub position: [f64; D],
    /// Standard deviations of the coordinates, metres.
    pub position_std: [f64; D],
    /// Their covariance, square metres. Errors of the measurements are in it, and those of the receivers, each by itself.
    pub covariance: [[f64; D]; D],
    /// Its offset, metres; zero where send times are known.
    pub offset: f64,
    /// Standard deviation of the offset, metres.
    pub offset_std: f64,
    /// Names of receivers whose measurements do not agree.
    pub outliers: Vec<String>,
    /// Measurements that agree, less the unknowns: where it is 0, nothing tells whether they are right.
    pub redundancy: usize,
    /// Root mean square of the residuals of those that agree, metres.
    pub residual_rms: f64,
    /// Whether the measurements that agree do so as well as their standard deviations have it, and are most of all.
    pub fits: bool,
    /// Whether the measurements fit, no other place explains them about as well, and the network's receivers are unique.
    pub unique: bool,
    /// Other places that explain the measurements about as well, likeliest first.
    pub others: Vec<OtherPlace<D>>,
}

/// Another place that explains the measurements about as well.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(bound(serialize = "[f64; D]: Serialize"))]
#[non_exhaustive]
pub struct OtherPlace<const D: usize = 2> {
    /// Its position, metres.
    pub position: [f64; D],
    /// Its offset, metres.
    pub offset: f64,
    /// How much less likely the measurements are (natural logarithm); not negative.
    pub log_likelihood_loss: f64,
}

/// Why a transmitter cannot be located.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Unplaced {
    /// Too few receivers hear it.
    TooFew {
        /// How many hear it.
        heard: usize,
        /// How many must.
        least: usize,
    },
    /// The receivers that hear it stand so that they do not tell its place, such as all in one line or at one place.
    Degenerate,
}

impl fmt::Display for Unplaced {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unplaced::TooFew { heard, least } => {
                let s = if *heard == 1 { "" } else { "s" };
                write!(f, "{heard} receiver{s} with a place heard it, and at least {least} must")
            }
            Unplaced::Degenerate => write!(f, "the receivers that heard it stand so that they do not tell its place"),
        }
    }
}

impl Serialize for Unplaced {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
