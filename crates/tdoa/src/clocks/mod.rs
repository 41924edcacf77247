//! Clocks: when transmitters send, and what recorders add to the times they measure.
//!
//! A measurement is f_ij = |r_i - s_j| + o_j + a_d + b_d t_ij, with the offset o_j of transmitter j, and the offset a_d
//! and the drift b_d of the recorder d of receiver i. What is unknown of recorders, and of offsets that transmitters
//! share, is one block of [unknowns](unknowns) beside the receivers.

mod emissions;
mod options;
mod prior;
mod recorders;
mod terms;
mod unknowns;

pub use emissions::Emissions;
pub use options::{Clocks, ReceiverClocks};
pub(crate) use prior::ClockPrior;
pub(crate) use recorders::Recorders;
pub(crate) use terms::ClockTerms;
pub(crate) use unknowns::ClockUnknowns;

#[cfg(test)]
pub(crate) mod tests;
