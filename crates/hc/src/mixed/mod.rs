//! Mixed cells and mixed volumes, found by tropical homotopy continuation (Jensen 2016,
//! arXiv:1601.02818). One support is brought in after the other.

mod cell;
mod cells;
mod error;
mod integer;
mod points;
mod search;
mod space;
mod subtrees;
mod walk;

pub(crate) use cells::{Keep, watched_cells};
pub use cells::{MixedCell, MixedVolume, mixed_cells, mixed_volume};
pub use error::MixedError;

#[cfg(all(test, feature = "threads"))]
mod ranks_tests;
