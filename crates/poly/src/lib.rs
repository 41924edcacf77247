//! Polynomials, expressions and straight-line programs.
//!
//! The layer below continuation: formulas become programs that run over any [`Scalar`]: one complex
//! number, eight paths at once ([`Lanes8`]), double-double and more.

pub mod evaluate;
pub mod lanes;
pub mod scalar;
pub mod simd;

pub use evaluate::Evaluate;
pub use lanes::{Lanes8, Reals8};
pub use scalar::{Lane, Scalar};
