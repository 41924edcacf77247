//! A program as one of several processes, called ranks, which MPI starts (feature `mpi`).
//!
//! [`main`] runs a program with its arguments, alone or as one of the ranks; [`Sharing`] holds the
//! options of work over several, [`Machine`] those about the machine.

#[cfg(feature = "mpi")]
mod carrier;
mod machine;
mod program;
#[cfg(feature = "mpi")]
mod world;

pub use machine::Machine;
pub use program::{Program, Sharing, main};
