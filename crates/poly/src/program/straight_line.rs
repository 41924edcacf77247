//! The straight-line program, which is run or written as source, and its instructions as tables, for
//! the interpreter and beside generated code.

use super::instruction::Tape;
use super::registers::{InputLayout, allocate};
use super::tape::RegisterTape;
use super::taylor::TaylorTape;
use crate::exact::Exact;

/// Instructions for the values of a system and for its Jacobian.
#[derive(Clone, Debug)]
pub struct Program {
    pub(crate) equations: usize,
    pub(crate) variables: usize,
    pub(crate) parameters: usize,
    pub(crate) constants: Vec<Exact>,
    /// Output slot `i` is value `i`.
    pub(crate) values: Tape,
    /// Slots `0..m` are values, slot `m + j*m + i` is the derivative of value `i` by unknown `j`.
    pub(crate) jacobian: Tape,
}

impl Program {
    /// Number of instructions for the values alone.
    pub fn value_operations(&self) -> usize {
        self.values.instructions.len()
    }

    /// Number of instructions for values and Jacobian together.
    pub fn jacobian_operations(&self) -> usize {
        self.jacobian.instructions.len()
    }

    /// How inputs are laid out before results.
    pub(super) fn layout(&self) -> InputLayout {
        InputLayout { constants: self.constants.len(), parameters: self.parameters, variables: self.variables }
    }
}

/// The instructions of a program as tables.
#[derive(Clone, Debug)]
pub struct Tables {
    /// For the values.
    pub values: RegisterTape,
    /// For values and Jacobian.
    pub jacobian: RegisterTape,
    /// For Taylor coefficients. These have no straight-line code: each instruction does so much
    /// work that looking it up costs little.
    pub taylor: TaylorTape,
}

impl Tables {
    pub(super) fn new(program: &Program) -> Tables {
        let layout = program.layout();
        Tables {
            values: allocate(&program.values, layout, program.equations),
            jacobian: allocate(&program.jacobian, layout, program.equations * (1 + program.variables)),
            taylor: TaylorTape::new(&program.values, layout),
        }
    }
}
