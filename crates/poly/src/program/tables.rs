//! The instructions of a program as tables, for the interpreter and beside generated code.

use super::registers::allocate;
use super::straight_line::Program;
use super::tape::RegisterTape;
use super::taylor::TaylorTape;

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
