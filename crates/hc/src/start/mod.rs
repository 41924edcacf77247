//! Start systems.
//!
//! * Polyhedral: the mixed cells of the supports ([`mixed_volume`], [`mixed_cells`]), found by tropical homotopy continuation
//!   (Jensen 2016, arXiv:1601.02818) with one support brought in after the other.
//! * Total degree: `x_i^(d_i) - 1`, `d_i` the degrees of the equations.

mod binomial;
mod cell;
mod integer;
mod mixed;
mod points;
mod polyhedral;
mod search;
mod toric;
mod total_degree;
mod walk;

pub use mixed::{MixedCell, MixedError, MixedVolume, mixed_cells, mixed_volume, watched_mixed_volume};
pub(crate) use polyhedral::Polyhedral;
pub(crate) use total_degree::{bezout_number, degrees, total_degree};

use crate::fibre::Fibre;

/// Exponent vectors of each equation.
pub(crate) type Supports = [Vec<Vec<i32>>];

/// A start system and its solutions.
pub(crate) struct Generic {
    /// The coefficients and the solutions found.
    pub(crate) fibre: Fibre,
    /// Number of solutions there are.
    pub(crate) paths: u64,
    /// Tracks run again to find them.
    pub(crate) retracked: usize,
}
