//! Many ranks on paper: what `mpirun hc solve` would take on thousands of ranks, simulated from what
//! portions of paths took on a few.
//!
//! The simulation hands out paths with the [`Desk`](hc::ranks::Desk) of the program itself; tracking,
//! messages and the work of rank 0 take the time that was [measured](Load) or [assumed](Machine).

mod events;
mod load;
mod simulation;

pub use load::{Load, Portion};
pub use simulation::{Machine, Outcome, simulate};
