//! Taylor coefficients along a path, one order at a time over resident memory.
//!
//! Every operand and every result keeps four coefficients. A call for order `k` first corrects coefficient
//! `k - 1` of each value (its unknowns' coefficient `k - 1` has been found since the last call), then computes
//! coefficient `k`, in one pass.

use super::instruction::{Op, Operand, Tape};
use super::registers::{Layout, place};
use super::series::{BY_UNKNOWN, Columns, GENERAL, UNKNOWNS, WIDTH, step};
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};
use std::borrow::Cow;

/// An instruction over the array of series `[constants | parameters | unknowns | results]`.
#[derive(Clone, Copy, Debug)]
pub struct TaylorCode {
    /// The operation.
    pub op: Op,
    /// Which factors of its products are unknowns: 0 none, 1 the second ones, 2 both.
    pub unknowns: u8,
    /// Place of the result.
    pub target: u32,
    /// Places of the operands; unused ones repeat the first.
    pub operands: [u32; 4],
}

/// A program for Taylor coefficients: instructions in three groups, each in order of execution.
#[derive(Clone, Debug)]
pub struct TaylorTape {
    /// Free of unknowns: coefficient `k - 1` was final at order `k - 1` already.
    pub parameters_only: Cow<'static, [TaylorCode]>,
    /// Free of parameters: coefficient 1 is zero as long as the unknowns' is.
    pub variables_only: Cow<'static, [TaylorCode]>,
    /// With both.
    pub mixed: Cow<'static, [TaylorCode]>,
    /// Place of the series of each output.
    pub outputs: Cow<'static, [u32]>,
    /// Number of constants, parameters and unknowns.
    pub inputs: [usize; 3],
    /// Number of series, inputs included.
    pub size: usize,
}

impl TaylorTape {
    /// Coefficients kept for each value.
    pub(crate) const WIDTH: usize = WIDTH;

    pub(super) fn new(tape: &Tape, layout: Layout) -> TaylorTape {
        let base = layout.inputs() as u32;
        let at = |operand| place(operand, layout, |k| base + k);
        let mut groups: [Vec<TaylorCode>; 3] = Default::default();
        let mut depends: Vec<(bool, bool)> = Vec::with_capacity(tape.instructions.len());
        for (k, instruction) in tape.instructions.iter().enumerate() {
            let mut on = (false, false);
            for operand in instruction.operands() {
                let (x, p) = match *operand {
                    Operand::Constant(_) => (false, false),
                    Operand::Parameter(_) => (false, true),
                    Operand::Variable(_) => (true, false),
                    Operand::Temporary(j) => depends[j as usize],
                };
                on = (on.0 || x, on.1 || p);
            }
            depends.push(on);
            let group = match on {
                (false, _) => 0,
                (true, false) => 1,
                (true, true) => 2,
            };
            let (operands, unknowns) = unknown_factors(instruction.op, instruction.args);
            let (target, operands) = (base + k as u32, operands.map(at));
            groups[group].push(TaylorCode { op: instruction.op, unknowns, target, operands });
        }
        let [parameters_only, variables_only, mixed] = groups.map(Cow::Owned);
        let mut outputs = vec![0; tape.outputs.len()];
        for &(slot, operand) in &tape.outputs {
            outputs[slot as usize] = at(operand);
        }
        TaylorTape {
            parameters_only,
            variables_only,
            mixed,
            outputs: Cow::Owned(outputs),
            inputs: [layout.constants, layout.parameters, layout.variables],
            size: layout.inputs() + tape.instructions.len(),
        }
    }

    /// Resident coefficients, with those of the constants in place.
    pub(super) fn memory<S: Scalar>(&self, constants: &[S]) -> Vec<S> {
        let mut columns = vec![S::zero(); WIDTH * self.size];
        columns[..constants.len()].clone_from_slice(constants);
        columns
    }

    /// One call of [`Evaluate::taylor`](crate::Evaluate::taylor).
    pub(crate) fn run<S: Scalar>(&self, isa: Isa, memory: &mut [S], order: usize, x: &[S], p: &[S], out: &mut [S]) {
        assert!((1..WIDTH).contains(&order), "Taylor coefficients are of order 1, 2 or 3, not {order}");
        let [constants, parameters, variables] = self.inputs;
        let (before, rest) = memory.split_at_mut(2 * self.size);
        let (first, second) = before.split_at_mut(self.size);
        let (third, fourth) = rest.split_at_mut(self.size);
        let mut columns = [first, second, third, fourth];
        // Lower coefficients of the parameters are in place since the calls before.
        for k in if order == 1 { 0..2 } else { order..order + 1 } {
            columns[k][constants..][..parameters].clone_from_slice(&p[k * parameters..][..parameters]);
        }
        let from = constants + parameters;
        columns[order - 1][from..][..variables].clone_from_slice(&x[(order - 1) * variables..][..variables]);
        columns[order][from..][..variables].fill(S::zero());
        match order {
            1 => isa.run(Order1 { tape: self, columns: &mut columns }),
            2 => isa.run(Later::<2, S> { tape: self, columns: &mut columns }),
            _ => isa.run(Later::<3, S> { tape: self, columns: &mut columns }),
        }
        for (value, &place) in out[..self.outputs.len()].iter_mut().zip(&*self.outputs) {
            *value = columns[order][place as usize].clone();
        }
    }
}

/// Puts unknowns second in products and tells which factors are unknowns.
fn unknown_factors(op: Op, args: [Operand; 4]) -> ([Operand; 4], u8) {
    let is_unknown = |operand: Operand| matches!(operand, Operand::Variable(_));
    let [a, b, c, d] = args;
    let sorted = |a: Operand, b: Operand| if is_unknown(a) { (b, a) } else { (a, b) };
    let kind = |a: Operand, b: Operand| match (is_unknown(a), is_unknown(b)) {
        (true, true) => UNKNOWNS,
        (false, true) => BY_UNKNOWN,
        _ => GENERAL,
    };
    match op {
        Op::Mul | Op::MulAdd | Op::MulSub | Op::SubMul => {
            let (a, b) = sorted(a, b);
            ([a, b, c, d], kind(a, b))
        }
        Op::MulMulAdd | Op::MulMulSub => {
            let ((a, b), (c, d)) = (sorted(a, b), sorted(c, d));
            ([a, b, c, d], kind(a, b).min(kind(c, d)))
        }
        Op::Sqr => (args, if is_unknown(a) { UNKNOWNS } else { GENERAL }),
        Op::Add | Op::Sub | Op::Neg | Op::MulReal | Op::Inv | Op::MulRealAdd => (args, GENERAL),
    }
}

struct Order1<'a, 'm, S> {
    tape: &'a TaylorTape,
    columns: &'a mut Columns<'m, S>,
}

impl<S: Scalar> Kernel for Order1<'_, '_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Order1 { tape, columns } = self;
        sweep::<S, 0, 1>(columns, &tape.parameters_only);
        for code in &*tape.variables_only {
            let operands = code.operands.map(|k| k as usize);
            step::<S, 0, 0, GENERAL>(columns, code.op, code.target as usize, operands);
            columns[1][code.target as usize] = S::zero();
        }
        sweep::<S, 0, 1>(columns, &tape.mixed);
    }
}

/// Order `K`, 2 or 3.
struct Later<'a, 'm, const K: usize, S> {
    tape: &'a TaylorTape,
    columns: &'a mut Columns<'m, S>,
}

impl<const K: usize, S: Scalar> Kernel for Later<'_, '_, K, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Later { tape, columns } = self;
        if K == 2 {
            sweep::<S, 2, 2>(columns, &tape.parameters_only);
            sweep::<S, 1, 2>(columns, &tape.variables_only);
            sweep::<S, 1, 2>(columns, &tape.mixed);
        } else {
            sweep::<S, 3, 3>(columns, &tape.parameters_only);
            sweep::<S, 2, 3>(columns, &tape.variables_only);
            sweep::<S, 2, 3>(columns, &tape.mixed);
        }
    }
}

#[inline(always)]
fn sweep<S: Scalar, const FROM: usize, const TO: usize>(columns: &mut Columns<'_, S>, codes: &[TaylorCode]) {
    for code in codes {
        let (t, operands) = (code.target as usize, code.operands.map(|k| k as usize));
        match code.unknowns {
            GENERAL => step::<S, FROM, TO, GENERAL>(columns, code.op, t, operands),
            BY_UNKNOWN => step::<S, FROM, TO, BY_UNKNOWN>(columns, code.op, t, operands),
            _ => step::<S, FROM, TO, UNKNOWNS>(columns, code.op, t, operands),
        }
    }
}
