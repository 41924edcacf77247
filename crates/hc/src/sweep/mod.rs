//! Sweeps: the real solutions of a family in every cell of a grid of parameters, and the branches that they form.
//!
//! The whole fibre is tracked to every cell, so that no branch can be lost on the way: that of a generic complex
//! point, whose paths meet no fold. The solutions of a cell are counted against the fibre ([`Standing`]). Branches are
//! then joined by real paths from each cell to its neighbours. Where branches end between two cells, there is a
//! [`Break`]: a fold, at which two of them meet, or a branch that goes to infinity.
//!
//! A branch is all that is joined. On a grid of two parameters it is a sheet; about a cusp, one sheet may lie over a cell
//! more than once.

mod branches;
mod cell;
mod cells;
mod conjugates;
mod error;
mod grid;
mod joins;
mod judge;
mod nearest;
mod options;
mod segments;
mod single;
mod swept;

pub use cell::{Cell, Doubt, RealSolution, Standing};
pub use error::SweepError;
pub use grid::{Axis, Grid, GridError};
pub use joins::{Break, BreakKind};
pub use options::SweepOptions;
pub use swept::{Sweep, SweepPaths};

#[cfg(test)]
mod tests;
