//! From the formula graph to instructions: powers by shared squarings, quotients by shared
//! reciprocals.

use super::instruction::{Instruction, Op, Operand, Tape};
use super::registers::InputLayout;
use super::taylor::TaylorTape;
use crate::exact::{self, Exact};
use crate::graph::{Graph, Id, Node};
use num_traits::One;
use std::collections::HashMap;

/// Instructions in dependency order, without duplicates, and the constants that they use.
#[derive(Default)]
pub(crate) struct Builder {
    pub(crate) instructions: Vec<Instruction>,
    pub(crate) constants: Vec<Exact>,
    index: HashMap<Instruction, u32>,
    constant_index: HashMap<Exact, u32>,
}

impl Builder {
    /// A builder that begins with constants that other instructions use already.
    pub(crate) fn with_constants(constants: Vec<Exact>) -> Builder {
        let constant_index = constants.iter().cloned().zip(0u32..).collect();
        Builder { constants, constant_index, ..Builder::default() }
    }

    pub(crate) fn push(&mut self, op: Op, args: &[Operand]) -> Operand {
        let mut instruction = Instruction::new(op, args);
        if matches!(op, Op::Add | Op::Mul) && instruction.args[1] < instruction.args[0] {
            instruction.args.swap(0, 1);
            instruction.args[2] = instruction.args[0];
            instruction.args[3] = instruction.args[0];
        }
        let next = self.instructions.len() as u32;
        let k = *self.index.entry(instruction).or_insert(next);
        if k == next {
            self.instructions.push(instruction);
        }
        Operand::Temporary(k)
    }

    pub(crate) fn constant(&mut self, value: Exact) -> Operand {
        let next = self.constants.len() as u32;
        let k = *self.constant_index.entry(value.clone()).or_insert(next);
        if k == next {
            self.constants.push(value);
        }
        Operand::Constant(k)
    }

    /// Lowers everything that the roots need; returns the operands of the roots.
    pub(crate) fn lower(&mut self, graph: &Graph, roots: &[Id]) -> Vec<Operand> {
        let used = graph.reachable(roots.iter().copied());
        let mut operand = vec![Operand::Constant(0); graph.len()];
        for id in 0..graph.len() {
            if used[id] {
                operand[id] = self.lower_node(graph, id as Id, &operand);
            }
        }
        roots.iter().map(|&root| operand[root as usize]).collect()
    }

    fn lower_node(&mut self, graph: &Graph, id: Id, operand: &[Operand]) -> Operand {
        let at = |id: Id| operand[id as usize];
        match graph.node(id) {
            Node::Constant(_) => self.constant(graph.as_constant(id).expect("a constant").clone()),
            Node::Variable(k) => Operand::Variable(k),
            Node::Parameter(k) => Operand::Parameter(k),
            Node::Add(a, b) => self.push(Op::Add, &[at(a), at(b)]),
            Node::Sub(a, b) => self.push(Op::Sub, &[at(a), at(b)]),
            Node::Neg(a) => self.push(Op::Neg, &[at(a)]),
            Node::Mul(a, b) => match graph.as_constant(a) {
                Some(c) if exact::is_real(c) => self.push(Op::MulReal, &[at(b), at(a)]),
                _ => self.push(Op::Mul, &[at(a), at(b)]),
            },
            Node::Div(a, b) => {
                let reciprocal = self.push(Op::Inv, &[at(b)]);
                match graph.as_constant(a) {
                    Some(c) if c.is_one() => reciprocal,
                    Some(c) if exact::is_real(c) => self.push(Op::MulReal, &[reciprocal, at(a)]),
                    _ => self.push(Op::Mul, &[at(a), reciprocal]),
                }
            }
            Node::Pow(a, k) => {
                let base = if k < 0 { self.push(Op::Inv, &[at(a)]) } else { at(a) };
                self.power(base, k.unsigned_abs())
            }
        }
    }

    /// `x^k` for `k >= 1` by squaring; equal partial powers are shared through [`Builder::push`].
    fn power(&mut self, x: Operand, k: u32) -> Operand {
        match k {
            0 | 1 => x,
            k if k % 2 == 0 => {
                let half = self.power(x, k / 2);
                self.push(Op::Sqr, &[half])
            }
            k => {
                let rest = self.power(x, k - 1);
                self.push(Op::Mul, &[x, rest])
            }
        }
    }
}

/// Writes a tape directly, without a formula graph behind it.
#[derive(Default)]
pub(crate) struct TapeWriter {
    instructions: Vec<Instruction>,
}

impl TapeWriter {
    pub(crate) fn push(&mut self, op: Op, args: &[Operand]) -> Operand {
        self.instructions.push(Instruction::new(op, args));
        Operand::Temporary((self.instructions.len() - 1) as u32)
    }

    /// The value zero.
    pub(crate) fn zero(&self) -> Operand {
        Operand::Constant(0)
    }

    /// The Taylor program of the outputs; its only constant, of index 0, is zero.
    pub(crate) fn finish(self, outputs: Vec<Operand>, parameters: usize, variables: usize) -> TaylorTape {
        let tape = Tape { instructions: self.instructions, outputs: (0u32..).zip(outputs).collect() };
        TaylorTape::new(&tape, InputLayout { constants: 1, parameters, variables })
    }
}
