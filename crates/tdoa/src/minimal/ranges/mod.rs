//! Ranges: distances without offsets, or with one unknown constant.
//!
//! `|r_i - s_j|^2`, doubly centred, is `-2 R'S` and has as many singular values as dimensions, which nodes in one
//! line or plane lack (`centred`). D + 1 receivers are a basis of all nodes, and unknown are their distances from each other
//! alone (`gram`). With a constant, which is one unknown more (`constant`), the centred squares are linear in it (`pencil`), and
//! five receivers and transmitters in space determine it alone (`five_five`).

mod centred;
mod constant;
mod five_five;
mod gram;
mod pencil;
mod solve;

#[cfg(test)]
pub(super) use constant::{FourSeven, GramAndConstant, ThreeFour};
#[cfg(test)]
pub(super) use gram::{FiveFive, FourSix, Gram, ThreeThree};
pub(super) use solve::{IN_PLANE, IN_PLANE_WITH_CONSTANT, IN_SPACE, IN_SPACE_WITH_CONSTANT, solve};

#[cfg(test)]
mod constant_tests;
#[cfg(test)]
mod tests;
