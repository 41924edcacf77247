//! Straight-line programs, which evaluate systems.
//!
//! Like terms of sums are collected. Formulas become instructions of up to four operands
//! (`a*b + c*d` is one). Equal subformulas are computed once, and dead ones not at all. The
//! Jacobian is made by reverse or forward mode, whichever needs fewer instructions. [`Interpreter`]
//! runs a program over any [`Scalar`](crate::Scalar).

mod collect;
mod compile;
mod derivative;
#[cfg(feature = "emit")]
mod emit;
pub mod generated;
mod instruction;
mod interpreter;
mod lower;
mod registers;
mod schedule;
mod series;
mod straight_line;
mod tape;
mod taylor;
#[cfg(test)]
mod tests;

pub use compile::CompileError;
#[cfg(feature = "emit")]
pub use emit::{EmitError, EmitOptions, emit};
pub(crate) use instruction::{Op, Operand};
pub use interpreter::{Interpreter, InterpreterMemory};
pub(crate) use lower::TapeWriter;
pub use straight_line::Program;
