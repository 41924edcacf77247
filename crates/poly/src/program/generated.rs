//! The support that code written by `poly::program::emit` (feature `emit`) needs.

use crate::scalar::Scalar;
use crate::simd::Isa;

pub use super::instruction::Op;
pub use super::taylor::{TaylorCode, TaylorMemory, TaylorTape};

/// Scratch space of generated code.
#[derive(Clone, Debug)]
pub struct Memory<S> {
    /// The instruction set that kernels run on.
    pub isa: Isa,
    /// Values that one function hands to the next.
    pub live: Vec<S>,
    /// Taylor coefficients that stay between orders.
    taylor: TaylorMemory<S>,
}

impl<S: Scalar> Memory<S> {
    /// Scratch space for a system with these constants (real part high and low, imaginary part high
    /// and low).
    pub fn new(isa: Isa, constants: &[[f64; 4]], live: usize, taylor: &TaylorTape) -> Memory<S> {
        let constants: Vec<S> = constants.iter().map(|&[a, b, c, d]| S::from_parts([a, b], [c, d])).collect();
        Memory { isa, live: vec![S::zero(); live], taylor: taylor.memory(&constants) }
    }

    /// Taylor coefficients, as [`Evaluate::taylor`](crate::Evaluate::taylor) says.
    ///
    /// # Panics
    /// If the order is not 1, 2 or 3 or a slice is too short.
    pub fn taylor(&mut self, tape: &TaylorTape, order: usize, x: &[S], p: &[S], out: &mut [S]) {
        tape.run(self.isa, &mut self.taylor, order, x, p, out);
    }
}

/// One instruction of a generated [`TaylorTape`].
pub const fn code(op: Op, kind: u8, target: u32, operands: [u32; 4]) -> TaylorCode {
    TaylorCode { op, kind, target, operands }
}
