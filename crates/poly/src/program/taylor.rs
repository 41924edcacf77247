//! Taylor coefficients along a path, one order at a time over resident memory.
//!
//! Every operand and every instruction keeps four coefficients. A call for order `k` first corrects coefficient
//! `k - 1` of each value (its unknowns' coefficient `k - 1` has been found since the last call), then computes
//! coefficient `k`, in one pass; Griewank and Walther, *Evaluating Derivatives*, chapter 13.

use super::instruction::{Op, Operand, Tape};
use super::registers::{Layout, place};
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};

/// Coefficients kept for each value: orders 0 to 3.
const WIDTH: usize = 4;

/// An instruction over the array of coefficients; operand `a` has its coefficients at `4*a .. 4*a + 4`.
#[derive(Clone, Copy, Debug)]
struct TaylorCode {
    op: Op,
    target: u32,
    a: u32,
    b: u32,
    c: u32,
    d: u32,
}

/// The values' instructions in three groups, each in order of execution.
#[derive(Debug)]
pub(super) struct TaylorTape {
    /// Free of unknowns: coefficient `k - 1` was final at order `k - 1` already.
    parameters_only: Vec<TaylorCode>,
    /// Free of parameters: coefficient 1 is zero as long as the unknowns' is.
    variables_only: Vec<TaylorCode>,
    /// With both.
    mixed: Vec<TaylorCode>,
    outputs: Vec<(u32, u32)>,
    equations: usize,
    /// Number of values, operands included.
    size: usize,
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
            let [a, b, c, d] = instruction.args.map(at);
            let group = match on {
                (false, _) => 0,
                (true, false) => 1,
                (true, true) => 2,
            };
            groups[group].push(TaylorCode { op: instruction.op, target: base + k as u32, a, b, c, d });
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

    /// Resident coefficients, with those of the constants in place.
    pub(super) fn memory<S: Scalar>(&self, constants: &[S]) -> Vec<S> {
        let mut array = vec![S::zero(); WIDTH * self.size];
        for (k, c) in constants.iter().enumerate() {
            array[WIDTH * k] = c.clone();
        }
        array
    }

    pub(super) fn run<S: Scalar>(
        &self,
        isa: Isa,
        array: &mut [S],
        layout: Layout,
        order: usize,
        x: &[S],
        p: &[S],
        out: &mut [S],
    ) {
        assert!((1..WIDTH).contains(&order), "Taylor coefficients are of order 1, 2 or 3, not {order}");
        let Layout { constants, parameters, variables } = layout;
        for k in [order - 1, order] {
            for j in 0..parameters {
                array[WIDTH * (constants + j) + k] = p[k * parameters + j].clone();
            }
        }
        for j in 0..variables {
            let place = WIDTH * (constants + parameters + j);
            array[place + order - 1] = x[(order - 1) * variables + j].clone();
            array[place + order] = S::zero();
        }
        match order {
            1 => isa.run(Order1 { tape: self, array }),
            2 => isa.run(OrderK::<2, S> { tape: self, array }),
            _ => isa.run(OrderK::<3, S> { tape: self, array }),
        }
        out[..self.equations].fill(S::zero());
        for &(slot, place) in &self.outputs {
            out[slot as usize] = array[WIDTH * place as usize + order].clone();
        }
    }
}

struct Order1<'a, S> {
    tape: &'a TaylorTape,
    array: &'a mut [S],
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
            array[WIDTH * code.target as usize + 1] = S::zero();
        }
        for code in &tape.mixed {
            step::<S, 0, 1>(array, code);
        }
    }
}

struct OrderK<'a, const K: usize, S> {
    tape: &'a TaylorTape,
    array: &'a mut [S],
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

/// The four coefficients of an operand.
#[inline(always)]
fn series<S>(array: &[S], k: u32) -> &[S; WIDTH] {
    array[WIDTH * k as usize..].first_chunk().expect("four coefficients")
}

/// Coefficient `k` of a product.
#[inline(always)]
fn product<S: Scalar>(a: &[S; WIDTH], b: &[S; WIDTH], k: usize) -> S {
    let mut sum = S::mul(&a[0], &b[k]);
    for j in 1..=k {
        sum = S::mul_add(&a[j], &b[k - j], &sum);
    }
    sum
}

/// Coefficient `k` of a square.
#[inline(always)]
fn square<S: Scalar>(a: &[S; WIDTH], k: usize) -> S {
    match k {
        0 => S::sqr(&a[0]),
        1 => double(&S::mul(&a[0], &a[1])),
        2 => S::add(&double(&S::mul(&a[0], &a[2])), &S::sqr(&a[1])),
        _ => double(&S::mul_mul_add(&a[0], &a[3], &a[1], &a[2])),
    }
}

#[inline(always)]
fn double<S: Scalar>(a: &S) -> S {
    S::add(a, a)
}

/// Computes coefficients `FROM ..= TO` of one instruction; those below are taken as final.
#[inline(always)]
fn step<S: Scalar, const FROM: usize, const TO: usize>(array: &mut [S], code: &TaylorCode) {
    for k in FROM..=TO {
        let (a, b) = (series(array, code.a), series(array, code.b));
        let (c, d) = (series(array, code.c), series(array, code.d));
        let value = match code.op {
            Op::Add => S::add(&a[k], &b[k]),
            Op::Sub => S::sub(&a[k], &b[k]),
            Op::Neg => S::neg(&a[k]),
            Op::Mul => product(a, b, k),
            Op::MulReal => S::mul_real(&a[k], &b[0]),
            Op::Sqr => square(a, k),
            Op::Inv => {
                // r_0 = 1/a_0, r_k = -r_0 * sum_{j<k} r_j a_{k-j}
                let r = series(array, code.target);
                match k {
                    0 => S::inv(&a[0]),
                    1 => S::neg(&S::mul(&r[0], &S::mul(&r[0], &a[1]))),
                    2 => S::neg(&S::mul(&r[0], &S::mul_mul_add(&r[0], &a[2], &r[1], &a[1]))),
                    _ => {
                        let sum = S::mul_mul_add(&r[0], &a[3], &r[1], &a[2]);
                        S::neg(&S::mul(&r[0], &S::mul_add(&r[2], &a[1], &sum)))
                    }
                }
            }
            Op::MulAdd => S::add(&product(a, b, k), &c[k]),
            Op::MulSub => S::sub(&product(a, b, k), &c[k]),
            Op::SubMul => S::sub(&c[k], &product(a, b, k)),
            Op::MulRealAdd => S::mul_real_add(&a[k], &b[0], &c[k]),
            Op::MulMulAdd => S::add(&product(a, b, k), &product(c, d, k)),
            Op::MulMulSub => S::sub(&product(a, b, k), &product(c, d, k)),
        };
        array[WIDTH * code.target as usize + k] = value;
    }
}
