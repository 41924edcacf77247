//! Errors of whole receivers, and receivers of known position.

pub(crate) mod all_delays;
pub(crate) mod echo;
pub(crate) mod errors;
pub(crate) mod evidence;
pub(crate) mod height_modes;
mod height_starts;
pub(crate) mod known_positions;
pub(crate) mod level;
pub(crate) mod moves;
pub(crate) mod own_clocks;
pub(crate) mod refits;
pub(crate) mod reflections;
pub(crate) mod score_test;
pub(crate) mod significance;
pub(crate) mod take_out;
