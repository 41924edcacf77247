//! The straight-line program, which is run or written as source.

use super::instruction::Tape;
use super::registers::InputLayout;
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
