//! Taylor coefficients along a path, one order at a time over resident memory.
//!
//! Every operand and every instruction keeps four coefficients. A call for order `k` first corrects coefficient
//! `k - 1` of each value (its unknowns' coefficient `k - 1` has been found since the last call), then computes
//! coefficient `k`, in one pass.

use super::instruction::{Op, Operand, Tape};
use super::registers::{Layout, place};
use super::series::{self, Series};
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};

/// An instruction over the array of series `[constants | parameters | unknowns | results]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct TaylorCode {
    pub(super) op: Op,
    pub(super) target: u32,
    pub(super) operands: [u32; 4],
}

/// The values' instructions in three groups, each in order of execution.
#[derive(Debug)]
pub(super) struct TaylorTape {
    /// Free of unknowns: coefficient `k - 1` was final at order `k - 1` already.
    pub(super) parameters_only: Vec<TaylorCode>,
    /// Free of parameters: coefficient 1 is zero as long as the unknowns' is.
    pub(super) variables_only: Vec<TaylorCode>,
    /// With both.
    pub(super) mixed: Vec<TaylorCode>,
    /// Slot of the output and the place of its series.
    pub(super) outputs: Vec<(u32, u32)>,
    equations: usize,
    /// Number of series, operands included.
    pub(super) size: usize,
}

impl TaylorTape {
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
            let operands = instruction.args.map(at);
            groups[group].push(TaylorCode { op: instruction.op, target: base + k as u32, operands });
        }
        let [parameters_only, variables_only, mixed] = groups;
        let outputs: Vec<(u32, u32)> = tape.outputs.iter().map(|&(slot, operand)| (slot, at(operand))).collect();
        TaylorTape {
            parameters_only,
            variables_only,
            mixed,
            equations: outputs.len(),
            outputs,
            size: layout.inputs() + tape.instructions.len(),
        }
    }

    pub(super) fn run<S: Scalar>(
        &self,
        isa: Isa,
        array: &mut [Series<S>],
        layout: Layout,
        order: usize,
        x: &[S],
        p: &[S],
        out: &mut [S],
    ) {
        load(array, layout, order, x, p);
        match order {
            1 => isa.run(Order1 { tape: self, array }),
            2 => isa.run(OrderK::<2, S> { tape: self, array }),
            _ => isa.run(OrderK::<3, S> { tape: self, array }),
        }
        let out = &mut out[..self.equations];
        for &(slot, place) in &self.outputs {
            out[slot as usize] = array[place as usize][order].clone();
        }
    }
}

/// Resident coefficients, with those of the constants in place.
pub(crate) fn resident<S: Scalar>(constants: &[S], size: usize) -> Vec<Series<S>> {
    let mut array = vec![std::array::from_fn(|_| S::zero()); size];
    for (series, c) in array.iter_mut().zip(constants) {
        series[0] = c.clone();
    }
    array
}

/// Puts the inputs of a call in place.
pub(crate) fn load<S: Scalar>(array: &mut [Series<S>], layout: Layout, order: usize, x: &[S], p: &[S]) {
    assert!((1..series::WIDTH).contains(&order), "Taylor coefficients are of order 1, 2 or 3, not {order}");
    let Layout { constants, parameters, variables } = layout;
    for j in 0..parameters {
        let series = &mut array[constants + j];
        series[order - 1] = p[(order - 1) * parameters + j].clone();
        series[order] = p[order * parameters + j].clone();
    }
    for j in 0..variables {
        let series = &mut array[constants + parameters + j];
        series[order - 1] = x[(order - 1) * variables + j].clone();
        series[order] = S::zero();
    }
}

struct Order1<'a, S> {
    tape: &'a TaylorTape,
    array: &'a mut [Series<S>],
}

impl<S: Scalar> Kernel for Order1<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Order1 { tape, array } = self;
        for code in &tape.parameters_only {
            step::<S, 0, 1>(array, code);
        }
        for code in &tape.variables_only {
            step::<S, 0, 0>(array, code);
            array[code.target as usize][1] = S::zero();
        }
        for code in &tape.mixed {
            step::<S, 0, 1>(array, code);
        }
    }
}

struct OrderK<'a, const K: usize, S> {
    tape: &'a TaylorTape,
    array: &'a mut [Series<S>],
}

impl<const K: usize, S: Scalar> Kernel for OrderK<'_, K, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let OrderK { tape, array } = self;
        for code in &tape.parameters_only {
            if K == 2 { step::<S, 2, 2>(array, code) } else { step::<S, 3, 3>(array, code) }
        }
        for code in tape.variables_only.iter().chain(&tape.mixed) {
            if K == 2 { step::<S, 1, 2>(array, code) } else { step::<S, 2, 3>(array, code) }
        }
    }
}

/// Computes coefficients `FROM ..= TO` of one instruction.
#[inline(always)]
fn step<S: Scalar, const FROM: usize, const TO: usize>(array: &mut [Series<S>], code: &TaylorCode) {
    let t = code.target as usize;
    let [a, b, c, d] = code.operands.map(|k| k as usize);
    match code.op {
        Op::Add => series::add::<S, FROM, TO>(array, t, a, b),
        Op::Sub => series::sub::<S, FROM, TO>(array, t, a, b),
        Op::Neg => series::neg::<S, FROM, TO>(array, t, a),
        Op::Mul => series::mul::<S, FROM, TO>(array, t, a, b),
        Op::MulReal => series::mul_real::<S, FROM, TO>(array, t, a, b),
        Op::Sqr => series::sqr::<S, FROM, TO>(array, t, a),
        Op::Inv => series::inv::<S, FROM, TO>(array, t, a),
        Op::MulAdd => series::mul_add::<S, FROM, TO>(array, t, a, b, c),
        Op::MulSub => series::mul_sub::<S, FROM, TO>(array, t, a, b, c),
        Op::SubMul => series::sub_mul::<S, FROM, TO>(array, t, a, b, c),
        Op::MulRealAdd => series::mul_real_add::<S, FROM, TO>(array, t, a, b, c),
        Op::MulMulAdd => series::mul_mul_add::<S, FROM, TO>(array, t, a, b, c, d),
        Op::MulMulSub => series::mul_mul_sub::<S, FROM, TO>(array, t, a, b, c, d),
    }
}
