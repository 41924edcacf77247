//! Ranges: distances without offsets.
//!
//! `|r_i - s_j|^2`, doubly centred, is `-2 R'S` and has as many singular values as dimensions, which nodes in one
//! line or plane lack (`centred`). D + 1 receivers are a basis of all nodes, and unknown are their distances from each other
//! alone (`gram`).

mod centred;
mod gram;
mod solve;

#[cfg(test)]
pub(super) use gram::{FiveFive, FourSix, Gram, ThreeThree};
pub(super) use solve::{IN_PLANE, IN_SPACE, solve};

#[cfg(test)]
mod tests;
