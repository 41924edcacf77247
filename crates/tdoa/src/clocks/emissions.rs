//! When transmitters send.

use crate::median::median;
use serde::{Deserialize, Serialize};

/// What is known of the times at which transmitters send.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Emissions {
    /// Nothing: every transmitter has an unknown offset.
    #[default]
    Unknown,
    /// They are known, and subtracted: measurements are distances, such as ranges measured there and back. Offsets are
    /// zero.
    Known,
    /// They are known but for one constant that all share, such as the delay of a cable or of an antenna: all offsets are
    /// one unknown.
    Constant,
}

impl Emissions {
    /// The offset of a transmitter where it is not its own: that of all, if it is given.
    pub(crate) fn shared(self, offset: Option<f64>) -> Option<f64> {
        match self {
            Emissions::Unknown => None,
            Emissions::Known => Some(0.0),
            Emissions::Constant => offset,
        }
    }

    /// Makes offsets of transmitters what they are known to be: zero, or the middle one of them.
    pub(crate) fn settle(self, offsets: &mut [f64]) {
        match self {
            Emissions::Unknown => {}
            Emissions::Known => offsets.fill(0.0),
            Emissions::Constant => {
                let first = offsets.first().copied().unwrap_or_default();
                if offsets.iter().any(|offset| *offset != first) {
                    offsets.fill(median(offsets.to_vec()).unwrap_or_default());
                }
            }
        }
    }
}
