//! Start systems.
//!
//! Polyhedral: the mixed cells of the supports ([`mixed_volume`], [`mixed_cells`]), found by tropical homotopy continuation
//! (Jensen 2016, arXiv:1601.02818) with one support brought in after the other.

mod binomial;
mod integer;
mod mixed;
mod polyhedral;
mod table;
mod toric;
mod walk;

pub use mixed::{MixedCell, MixedError, MixedVolume, mixed_cells, mixed_volume};
pub(crate) use polyhedral::generic;
