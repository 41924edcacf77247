//! Polynomials, formulas and straight-line programs: fast evaluation, for one path or eight at
//! once.
//!
//! ```
//! use poly::{Complex64, Evaluate, Isa, System};
//!
//! // A circle and a line, with two parameters; formulas are never expanded.
//! let system = System::build(|s| {
//!     let (x, y) = (s.variable("x"), s.variable("y"));
//!     let (r, a) = (s.parameter("r"), s.parameter("a"));
//!     vec![x * x + y * y - r * r, y - a * x]
//! })?;
//! let f = system.compile()?;
//!
//! let real = |x: f64| Complex64::new(x, 0.0);
//! let mut memory = f.memory(Isa::detect());
//! let (mut values, mut jacobian) = ([real(0.0); 2], [real(0.0); 4]);
//! f.jacobian(&mut memory, &[real(3.0), real(4.0)], &[real(5.0), real(2.0)], &mut values, &mut jacobian);
//! assert_eq!(values, [real(0.0), real(-2.0)]);
//! // Column-major: the derivatives by x, then those by y.
//! assert_eq!(jacobian, [real(6.0), real(-2.0), real(8.0), real(1.0)]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # From formula to numbers
//! | step | what |
//! |---|---|
//! | [`Expressions`], [`System::build`] | formulas by operators; equal subformulas are stored once |
//! | [`System::from_formulas`], `text.parse::<System>()` | systems from text: errors have line, column and a caret |
//! | [`Family::from_formulas`], [`Family::from_str`](Family#impl-FromStr-for-Family) | parameter families, from formulas or text |
//! | [`Formula`], [`System::new`] | formulas that own their parts |
//! | [`System::expand`] | sparse [`Polynomial`]s, within [`ExpandLimits`] |
//! | [`System::compile`] | an [`Interpreter`]: values, Jacobian by reverse or forward mode, Taylor coefficients |
//! | [`Split`] | a family along a line of its parameters, with fewer operations |
//! | [`SparseSystem`] | a system of fixed supports, with the coefficients as parameters |
//! | `program::emit`, with the feature `emit` | the program as Rust source |
//!
//! [`Evaluate`] is the interface of all three kinds of system. It runs over any [`Scalar`]:
//! [`Complex64`], [`Lanes8`] (eight paths side by side, each bit for bit what one path computes, on
//! every [`Isa`]), [`Singles16`] (sixteen in single precision), [`ComplexDd`] (32 digits) and
//! [`ComplexDdLanes`] (several of these), [`ComplexMulti`] (as many digits as asked for),
//! [`ComplexInterval`] and [`ComplexBall`] (proven bounds, of 16 and 32 digits) and [`Rational`]
//! (exact).
//!
//! crates/benches/README.md in the repository has measured times.

mod arena;
mod ball;
mod complex;
mod dd;
mod dd_lanes;
mod display;
mod exact;
mod expand;
mod exponential;
mod expression;
mod factors;
mod formula;
mod graph;
mod instantiate;
mod interval;
mod lanes;
mod monomial;
mod multi;
mod named_sums;
mod polynomial;
mod rational;
mod singles;
mod sparse;
mod split;
mod system;
mod wording;

pub mod evaluate;
pub mod parse;
pub mod program;
pub mod scalar;
pub mod simd;

pub use ball::{Ball, ComplexBall};
pub use dd::{ComplexDd, Dd};
pub use dd_lanes::ComplexDdLanes;
pub use evaluate::Evaluate;
pub use exact::{Exact, ToExact};
pub use expand::{ExpandError, ExpandLimits};
pub use exponential::exp;
pub use expression::{Expr, Expressions};
pub use formula::Formula;
pub use interval::{ComplexInterval, Interval};
pub use lanes::{Lanes8, Reals};
pub use monomial::Monomial;
pub use multi::ComplexMulti;
pub use num_complex::Complex64;
pub use parse::{Family, ParseError};
pub use polynomial::{Polynomial, Ring};
pub use program::{CompileError, Interpreter, Program};
pub use rational::Rational;
pub use scalar::{Lane, Scalar};
pub use simd::Isa;
pub use singles::Singles16;
pub use sparse::{SparseMemory, SparseSystem, SupportError};
pub use split::Split;
pub use system::{System, SystemError};
pub use wording::{counted, one_or};
