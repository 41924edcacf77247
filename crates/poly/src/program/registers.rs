//! Register allocation: a register becomes free after the last use of its result.

use super::instruction::{Operand, Tape};
use super::tape::{Code, RegisterTape};

/// The layout of inputs in the array.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct InputLayout {
    pub(crate) constants: usize,
    pub(crate) parameters: usize,
    pub(crate) variables: usize,
}

impl InputLayout {
    /// Place of the first register.
    pub(crate) fn inputs(self) -> usize {
        self.constants + self.parameters + self.variables
    }
}

/// The place of a result, from the given table, or of an input, which is fixed.
pub(crate) fn place(operand: Operand, layout: InputLayout, temporary: impl Fn(u32) -> u32) -> u32 {
    match operand {
        Operand::Constant(k) => k,
        Operand::Parameter(k) => layout.constants as u32 + k,
        Operand::Variable(k) => (layout.constants + layout.parameters) as u32 + k,
        Operand::Temporary(k) => temporary(k),
    }
}

/// Assigns registers by linear scan; outputs keep theirs to the end.
pub(crate) fn allocate(tape: &Tape, layout: InputLayout, slots: usize) -> RegisterTape {
    const FOREVER: usize = usize::MAX;
    let mut last_use = vec![0; tape.instructions.len()];
    for (k, instruction) in tape.instructions.iter().enumerate() {
        for operand in instruction.operands() {
            if let Operand::Temporary(j) = *operand {
                last_use[j as usize] = k;
            }
        }
    }
    for &(_, operand) in &tape.outputs {
        if let Operand::Temporary(j) = operand {
            last_use[j as usize] = FOREVER;
        }
    }
    let mut register = vec![0u32; tape.instructions.len()];
    let mut free: Vec<u32> = Vec::new();
    let mut size = layout.inputs();
    let mut code = Vec::with_capacity(tape.instructions.len());
    for (k, instruction) in tape.instructions.iter().enumerate() {
        let places = instruction.args.map(|operand| place(operand, layout, |j| register[j as usize]));
        let operands = instruction.operands();
        for (n, operand) in operands.iter().enumerate() {
            if let Operand::Temporary(j) = *operand
                && last_use[j as usize] == k
                && !operands[..n].contains(operand)
            {
                free.push(register[j as usize]);
            }
        }
        // The most recently freed register is still in the nearest cache.
        let target = free.pop().unwrap_or_else(|| {
            size += 1;
            (size - 1) as u32
        });
        register[k] = target;
        code.push(Code { op: instruction.op, target, operands: places });
    }
    let outputs =
        tape.outputs.iter().map(|&(slot, operand)| (slot, place(operand, layout, |j| register[j as usize]))).collect();
    let inputs = [layout.constants, layout.parameters, layout.variables];
    RegisterTape { code: code.into(), outputs, zeros: tape.zeros(slots).into(), inputs, size }
}
