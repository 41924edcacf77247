//! A tape whose results have fixed places, ready to run over any scalar.

use super::instruction::Op;
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};
use std::borrow::Cow;

/// An instruction over one array `[constants | parameters | unknowns | registers]`.
#[derive(Clone, Copy, Debug)]
pub struct Code {
    /// The operation.
    pub op: Op,
    /// Place of the result.
    pub target: u32,
    /// Places of the operands; unused ones repeat the first.
    pub operands: [u32; 4],
}

/// A tape ready to run.
#[derive(Clone, Debug)]
pub struct RegisterTape {
    /// Instructions in order of execution.
    pub code: Cow<'static, [Code]>,
    /// Slot of the output, and the place that holds it at the end. Slots are values, followed by
    /// entries of the Jacobian.
    pub outputs: Cow<'static, [(u32, u32)]>,
    /// Slots that are zero whatever the input.
    pub zeros: Cow<'static, [u32]>,
    /// Number of constants, parameters and unknowns.
    pub inputs: [usize; 3],
    /// Length of the whole array.
    pub size: usize,
}

impl RegisterTape {
    /// Sets the parameters in an array for later runs.
    pub(super) fn set_parameters<S: Scalar>(&self, array: &mut [S], p: &[S]) {
        let [constants, parameters, _] = self.inputs;
        array[constants..][..parameters].clone_from_slice(&p[..parameters]);
    }

    /// Runs the tape in an array that has at least its size and holds the constants and the parameters.
    pub(super) fn run<S: Scalar>(&self, isa: Isa, array: &mut [S], x: &[S], values: &mut [S], jacobian: &mut [S]) {
        let [constants, parameters, variables] = self.inputs;
        array[constants + parameters..][..variables].clone_from_slice(&x[..variables]);
        isa.run(Instructions { code: &self.code, array });
        let rows = values.len();
        let mut write = |slot: u32, value: S| match (slot as usize).checked_sub(rows) {
            None => values[slot as usize] = value,
            Some(entry) => jacobian[entry] = value,
        };
        for &slot in &*self.zeros {
            write(slot, S::zero());
        }
        for &(slot, place) in &*self.outputs {
            write(slot, array[place as usize].clone());
        }
    }
}

/// The loop over instructions.
struct Instructions<'a, S> {
    code: &'a [Code],
    array: &'a mut [S],
}

impl<S: Scalar> Kernel for Instructions<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let array = self.array;
        for &Code { op, target, operands } in self.code {
            let [a, b, c, d] = operands.map(|k| &array[k as usize]);
            let result = match op {
                Op::Add => S::add(a, b),
                Op::Sub => S::sub(a, b),
                Op::Neg => S::neg(a),
                Op::Mul => S::mul(a, b),
                Op::MulReal => S::mul_real(a, b),
                Op::Sqr => S::sqr(a),
                Op::Inv => S::inv(a),
                Op::MulAdd => S::mul_add(a, b, c),
                Op::MulSub => S::mul_sub(a, b, c),
                Op::SubMul => S::sub_mul(a, b, c),
                Op::MulRealAdd => S::mul_real_add(a, b, c),
                Op::MulMulAdd => S::mul_mul_add(a, b, c, d),
                Op::MulMulSub => S::mul_mul_sub(a, b, c, d),
            };
            array[target as usize] = result;
        }
    }
}
