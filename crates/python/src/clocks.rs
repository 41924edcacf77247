//! What is unknown of clocks, from the words that Python gives.

use crate::errors::Failure;
use tdoa::{Emissions, ReceiverClocks};

/// What is known of the times at which transmitters send.
pub(crate) fn emissions(word: &str) -> Result<Emissions, Failure> {
    match word {
        "unknown" => Ok(Emissions::Unknown),
        "constant" => Ok(Emissions::Constant),
        "known" => Ok(Emissions::Known),
        other => Err(Failure::Input(format!("emissions must be unknown, constant or known, not {other:?}"))),
    }
}

/// What the clocks of receivers do.
pub(crate) fn receivers(word: &str) -> Result<ReceiverClocks, Failure> {
    match word {
        "common" => Ok(ReceiverClocks::Common),
        "offset" => Ok(ReceiverClocks::Offset),
        "rate" => Ok(ReceiverClocks::Rate),
        other => Err(Failure::Input(format!("clocks of receivers must be common, offset or rate, not {other:?}"))),
    }
}
