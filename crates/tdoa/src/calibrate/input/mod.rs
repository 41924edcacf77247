//! What takes part in a calibration, and what is known beforehand.

pub(crate) mod anchors;
pub(crate) mod distances;
pub(crate) mod first_clocks;
pub(crate) mod impossible;
pub(crate) mod ranges;
pub(crate) mod selection;
pub(crate) mod speed;
