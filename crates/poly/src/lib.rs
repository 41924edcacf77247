//! Polynomials, expressions and straight-line programs.
//!
//! The layer below continuation: formulas become programs that run over any [`Scalar`]: one complex
//! number, eight paths at once ([`Lanes8`]), double-double and more.

mod display;
mod exact;
mod graph;
mod instantiate;

pub mod dd;
pub mod evaluate;
pub mod expand;
pub mod expression;
pub mod interval;
pub mod lanes;
pub mod monomial;
pub mod parse;
pub mod polynomial;
pub mod program;
pub mod rational;
pub mod scalar;
pub mod simd;
pub mod sparse;
pub mod system;

pub use dd::ComplexDd;
pub use evaluate::Evaluate;
pub use exact::Exact;
pub use expand::{ExpandError, ExpandLimits};
pub use expression::{Expr, Expressions};
pub use interval::ComplexInterval;
pub use lanes::{Lanes8, Reals8};
pub use monomial::Monomial;
pub use num_complex::Complex64;
pub use parse::{Family, ParseError};
pub use polynomial::Polynomial;
pub use program::{CompileError, Interpreter, Program};
pub use rational::Rational;
pub use scalar::{Lane, Scalar};
pub use simd::Isa;
pub use sparse::{SparseSystem, SupportError};
pub use system::{System, SystemError};
