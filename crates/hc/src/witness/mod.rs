//! Solution sets of positive dimension: witness points, degrees, irreducible components.
//!
//! A set of dimension `d` and degree `k` meets `d` general hyperplanes in `k` points, which are
//! isolated there. Sets of lower dimension miss the hyperplanes; sets of higher dimension meet them
//! in more than points. The witness points of each dimension are therefore isolated solutions of
//! the given equations and that many linear ones, and their multiplicities are those of the
//! components (Sommese & Wampler 2005, The Numerical Solution of Systems of Polynomials Arising in
//! Engineering and Science, chapters 13 to 15).

mod decompose;
mod deflated;
mod equations;
mod irreducible;
mod set;
mod slices;
mod summary;

pub use decompose::{Component, Decomposition, decompose};
