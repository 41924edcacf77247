//! When transmitters send.

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
}

impl Emissions {
    /// [`Emissions::Known`] where measurements are ranges, [`Emissions::Unknown`] otherwise.
    pub fn of_ranges(are_ranges: bool) -> Emissions {
        if are_ranges { Emissions::Known } else { Emissions::Unknown }
    }
}
