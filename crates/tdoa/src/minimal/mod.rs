//! Solvers for small networks: every network that explains a few arrival times exactly.
//!
//! [`Solver`] chooses the method by the size of the matrix. Most methods use homotopy continuation
//! from stored solutions of a generic instance. [`MinimalSolution::paths`] accounts for all paths.
//!
//! | size | method | paths |
//! |---|---|---|
//! | 6r/3s, and more receivers | the dual equations of the paper on three transmitters | 180 |
//! | 4r/5s, and more transmitters | Gram matrix of the receivers | 344 |
//! | 5r/4s, 5r/5s, 6r/4s, 6r/5s | the dual equations and a determinant for the fourth transmitter | 152 |
//! | 5r/6s, and more of both | offsets by rank | 5 |
//! | 7r/4s, and more of both | offsets by rank, linear | 0 |
//!
//! These are the sizes in the plane. In space ([`spatial::solve()`]):
//!
//! | size | method | paths |
//! |---|---|---|
//! | 9r/5s, and more of both | offsets by rank, linear | 0 |
//! | 7r/6s, and more of both | offsets by rank, 5 eigenvalues | 0 |
//! | 6r/8s, and more of both | offsets by rank, 14 eigenvalues | 0 |
//! | 8r/5s | the dual equations but two | 256 |
//! | 7r/5s | the dual equations of the paper, one dimension more | 2321 |
//! | 6r/6s, 6r/7s | Gram matrix of three receivers | 3920 |
//! | 10r/4s, and more receivers | the dual equations on four transmitters | 6148 |
//!
//! Ranges, where [`MinimalOptions::emissions`] says that measurements are these:
//!
//! | size | method | paths |
//! |---|---|---|
//! | 3r/3s in the plane, and more of both | Gram matrix of the receivers | 8 |
//! | 5r/5s in space, and more of both | Gram matrix of four receivers | 42 |
//! | 4r/6s in space, and more transmitters | Gram matrix of the receivers | 38 |
//! | 6r/4s in space, and more receivers | the same with roles exchanged | 38 |
//!
//! Ranges with one unknown constant:
//!
//! | size | method | paths |
//! |---|---|---|
//! | 3r/4s in the plane, and more of both | Gram matrix of the receivers, and the constant | 43 |
//! | 4r/3s in the plane, and more receivers | the same with roles exchanged | 43 |
//! | 5r/5s in space, and more of both | four constants, by a determinant, and 5r/5s for each that is real | 42 each |
//! | 4r/7s in space, and more transmitters | Gram matrix of the receivers, and the constant | 388 |
//! | 7r/4s in space, and more receivers | the same with roles exchanged | 388 |
//!
//! A solver in the plane that is used again keeps 0.2 to 0.5 MB of start solutions and workspace. A solve then
//! allocates only its result, a few kilobytes (`cargo run --release -p tdoa --example memory`).
//! Exceptions are the few networks with roots whose Jacobians are singular as far as doubles can
//! tell.

mod adjust;
mod check;
mod doubts;
mod engine;
mod engines;
mod error;
mod formulation;
mod larger;
mod linear;
mod nearest;
mod node_kind;
mod normalised;
mod options;
mod orders;
mod planar;
mod polish;
mod proofs;
mod ranges;
mod real;
mod recharted;
mod scratch;
mod solution;
mod solver;
pub mod spatial;
pub(crate) mod subset;
mod warning;

pub use adjust::adjust;
pub use error::MinimalError;
#[doc(hidden)]
pub use nearest::parameters_near;
pub use node_kind::NodeKind;
pub use options::{MinimalOptions, MinimalStart};
pub use proofs::RootProofs;
pub use solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
pub use solver::{Solver, solve};
pub use warning::MinimalWarning;
