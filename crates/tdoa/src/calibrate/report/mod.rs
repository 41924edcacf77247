//! The result of a calibration and what it warns of.

pub(crate) mod calibration;
pub(crate) mod candidates;
pub(crate) mod clocks;
pub(crate) mod compare;
pub(crate) mod distances;
pub(crate) mod network;
pub(crate) mod receiver_errors;
pub(crate) mod residuals;
pub(crate) mod systematic;
pub(crate) mod systematic_errors;
pub(crate) mod truth;
pub(crate) mod warnings;
