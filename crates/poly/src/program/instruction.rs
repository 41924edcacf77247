//! Instructions of straight-line programs.

/// The origin of an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) enum Operand {
    Constant(u32),
    Parameter(u32),
    Variable(u32),
    /// The result of an instruction.
    Temporary(u32),
}

/// What an instruction computes from up to four operands `a`, `b`, `c`, `d`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Op {
    /// `a + b`
    Add,
    /// `a - b`
    Sub,
    /// `-a`
    Neg,
    /// `a * b`
    Mul,
    /// `a * b` where `b` is a real constant
    MulReal,
    /// `a * a`
    Sqr,
    /// `1 / a`
    Inv,
    /// `a * b + c`
    MulAdd,
    /// `a * b - c`
    MulSub,
    /// `c - a * b`
    SubMul,
    /// `a * b + c` where `b` is a real constant
    MulRealAdd,
    /// `a * b + c * d`
    MulMulAdd,
    /// `a * b - c * d`
    MulMulSub,
}

impl Op {
    /// Number of operands.
    pub(crate) fn arity(self) -> usize {
        match self {
            Op::Neg | Op::Sqr | Op::Inv => 1,
            Op::Add | Op::Sub | Op::Mul | Op::MulReal => 2,
            Op::MulAdd | Op::MulSub | Op::SubMul | Op::MulRealAdd => 3,
            Op::MulMulAdd | Op::MulMulSub => 4,
        }
    }
}

/// One instruction; unused operands repeat the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Instruction {
    pub(crate) op: Op,
    pub(crate) args: [Operand; 4],
}

impl Instruction {
    pub(crate) fn new(op: Op, args: &[Operand]) -> Instruction {
        debug_assert_eq!(args.len(), op.arity());
        let mut all = [args[0]; 4];
        all[..args.len()].copy_from_slice(args);
        Instruction { op, args: all }
    }

    /// The operands that the operation uses.
    pub(crate) fn operands(&self) -> &[Operand] {
        &self.args[..self.op.arity()]
    }
}

/// Instructions in order of execution: the result of instruction `k` is `Temporary(k)`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tape {
    pub(crate) instructions: Vec<Instruction>,
    /// What is written to which slot of the output; slots that are not listed are zero.
    pub(crate) outputs: Vec<(u32, Operand)>,
}

impl Tape {
    /// Those of the first `slots` output slots that no instruction writes to.
    pub(crate) fn zeros(&self, slots: usize) -> Vec<u32> {
        let mut written = vec![false; slots];
        for &(slot, _) in &self.outputs {
            written[slot as usize] = true;
        }
        (0u32..).zip(written).filter(|&(_, written)| !written).map(|(slot, _)| slot).collect()
    }
}
