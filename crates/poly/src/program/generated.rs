//! Support for code written by `poly::program::emit` (feature `emit`).

use crate::scalar::Scalar;
use crate::simd::Isa;

pub use super::instruction::Op;
pub use super::straight_line::Tables;
pub use super::tape::{Code, RegisterTape};
pub use super::taylor::{TaylorCode, TaylorMemory, TaylorTape};
pub use crate::scalar::narrowest;

/// Scratch space of generated code.
#[derive(Clone, Debug)]
pub struct Memory<S> {
    /// The instruction set on which kernels run.
    pub isa: Isa,
    /// Values that one function passes to the next.
    pub live: Vec<S>,
    straight: bool,
    /// Inputs and registers, if instructions are interpreted.
    array: Vec<S>,
    /// Taylor coefficients that are kept between orders.
    taylor: TaylorMemory<S>,
}

impl<S: Scalar> Memory<S> {
    /// Scratch space for a system with these constants (real part high and low, imaginary part high
    /// and low).
    pub fn new(isa: Isa, constants: &[[f64; 4]], live: usize, tables: &Tables) -> Memory<S> {
        let constants: Vec<S> = constants.iter().map(|&[a, b, c, d]| S::from_parts([a, b], [c, d])).collect();
        let taylor = tables.taylor.memory(isa, &constants);
        if S::is_straight(isa) {
            return Memory { isa, live: vec![S::zero(); live], straight: true, array: Vec::new(), taylor };
        }
        let mut array = constants;
        array.resize(tables.values.size.max(tables.jacobian.size), S::zero());
        Memory { isa, live: Vec::new(), straight: false, array, taylor }
    }

    /// Whether to run straight-line code.
    #[inline]
    pub fn is_straight(&self) -> bool {
        self.straight
    }

    /// Runs a table for values, or for values and Jacobian, in place of straight-line code.
    ///
    /// # Panics
    /// If [`is_straight`](Memory::is_straight) holds, or a slice is too short.
    pub fn interpret(&mut self, tape: &RegisterTape, x: &[S], p: &[S], values: &mut [S], jacobian: &mut [S]) {
        tape.set_parameters(&mut self.array, p);
        tape.run(self.isa, &mut self.array, x, values, jacobian);
    }

    /// Taylor coefficients, as specified by [`Evaluate::taylor`](crate::Evaluate::taylor).
    ///
    /// # Panics
    /// If the order is not 1, 2 or 3, or a slice is too short.
    pub fn taylor(&mut self, tape: &TaylorTape, order: usize, x: &[S], p: &[S], out: &mut [S]) {
        tape.run(self.isa, &mut self.taylor, order, x, p, out);
    }
}

/// One instruction of a generated [`RegisterTape`].
pub const fn instruction(op: Op, target: u32, operands: [u32; 4]) -> Code {
    Code { op, target, operands }
}

/// One instruction of a generated [`TaylorTape`].
pub const fn code(op: Op, kind: u8, target: u32, operands: [u32; 4]) -> TaylorCode {
    TaylorCode { op, kind, target, operands }
}
