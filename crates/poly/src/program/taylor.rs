//! Taylor coefficients along a path, one order at a time over resident memory.
//!
//! Every operand and every result keeps four coefficients. A call for order `k` first corrects
//! coefficient `k - 1` of each value (its unknowns' coefficient `k - 1` has been found since the
//! last call), then computes coefficient `k`, in one pass. Where the parameters move on a straight
//! line, products with what is linear in them leave out its coefficients beyond order 1.

use super::instruction::{Op, Operand, Tape};
use super::registers::{Layout, place};
use super::series::{BY_LINEAR, BY_UNKNOWN, GENERAL, LINEAR_BY_UNKNOWN, LINEARS, Series, UNKNOWNS, WIDTH, step};
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};
use std::borrow::Cow;

/// An instruction over the array of series `[constants | parameters | unknowns | results]`.
#[derive(Clone, Copy, Debug)]
pub struct TaylorCode {
    /// The operation.
    pub op: Op,
    /// What the factors of its products are: 0 anything, 1 anything and an unknown, 2 both
    /// unknowns, 3 anything and something linear in parameters, 4 something linear in parameters
    /// and an unknown, 5 both linear in parameters.
    pub kind: u8,
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

/// Coefficients that stay between orders.
#[derive(Clone, Debug)]
pub struct TaylorMemory<S> {
    series: Vec<Series<S>>,
    /// Orders at which the parameters' coefficients are not known to be zero.
    bent: [bool; WIDTH],
}

impl TaylorTape {
    pub(super) fn new(tape: &Tape, layout: Layout) -> TaylorTape {
        let base = layout.inputs() as u32;
        let at = |operand| place(operand, layout, |k| base + k);
        let mut groups: [Vec<TaylorCode>; 3] = Default::default();
        let mut depends: Vec<(bool, bool)> = Vec::with_capacity(tape.instructions.len());
        let mut linear: Vec<bool> = Vec::with_capacity(tape.instructions.len());
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
            let factor = |operand| Factor::of(operand, &linear);
            let (operands, kind) = sort_factors(instruction.op, instruction.args, factor);
            let sum = matches!(instruction.op, Op::Add | Op::Sub | Op::Neg | Op::MulReal | Op::MulRealAdd);
            linear.push(sum && instruction.operands().iter().all(|&operand| factor(operand) == Factor::Linear));
            let (target, operands) = (base + k as u32, operands.map(at));
            groups[group].push(TaylorCode { op: instruction.op, kind, target, operands });
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
    pub(crate) fn memory<S: Scalar>(&self, constants: &[S]) -> TaylorMemory<S> {
        let zero = || [S::zero(), S::zero(), S::zero(), S::zero()];
        let mut series: Vec<Series<S>> = (0..self.size).map(|_| zero()).collect();
        for (series, constant) in series.iter_mut().zip(constants) {
            series[0] = constant.clone();
        }
        TaylorMemory { series, bent: [false; WIDTH] }
    }

    /// One call of [`Evaluate::taylor`](crate::Evaluate::taylor).
    pub(crate) fn run<S: Scalar>(
        &self,
        isa: Isa,
        memory: &mut TaylorMemory<S>,
        order: usize,
        x: &[S],
        p: &[S],
        out: &mut [S],
    ) {
        assert!((1..WIDTH).contains(&order), "Taylor coefficients are of order 1, 2 or 3, not {order}");
        let [constants, parameters, variables] = self.inputs;
        let TaylorMemory { series, bent } = memory;
        let straight = order > 1 && p.len() < (order + 1) * parameters;
        // Lower coefficients of the parameters are in place since the calls before.
        let given = &mut series[constants..][..parameters];
        if !straight {
            for k in if order == 1 { 0..2 } else { order..order + 1 } {
                for (series, p) in given.iter_mut().zip(&p[k * parameters..][..parameters]) {
                    series[k] = p.clone();
                }
            }
            bent[order] = true;
        } else if std::mem::take(&mut bent[order]) {
            for series in given.iter_mut() {
                series[order] = S::zero();
            }
        }
        let unknowns = &mut series[constants + parameters..][..variables];
        for (series, x) in unknowns.iter_mut().zip(&x[(order - 1) * variables..][..variables]) {
            series[order - 1] = x.clone();
            series[order] = S::zero();
        }
        match (order, straight) {
            (1, _) => isa.run(Order1 { tape: self, series }),
            (2, false) => isa.run(Later::<2, false, S> { tape: self, series }),
            (2, true) => isa.run(Later::<2, true, S> { tape: self, series }),
            (_, false) => isa.run(Later::<3, false, S> { tape: self, series }),
            (_, true) => isa.run(Later::<3, true, S> { tape: self, series }),
        }
        for (value, &place) in out[..self.outputs.len()].iter_mut().zip(&*self.outputs) {
            *value = series[place as usize][order].clone();
        }
    }
}

/// What is known of a factor when the program is made.
#[derive(Clone, Copy, PartialEq)]
enum Factor {
    Anything,
    /// Free of unknowns and, where the parameters move on a straight line, linear in `t`.
    Linear,
    Unknown,
}

impl Factor {
    fn of(operand: Operand, linear: &[bool]) -> Factor {
        match operand {
            Operand::Constant(_) | Operand::Parameter(_) => Factor::Linear,
            Operand::Variable(_) => Factor::Unknown,
            Operand::Temporary(k) if linear[k as usize] => Factor::Linear,
            Operand::Temporary(_) => Factor::Anything,
        }
    }

    /// What is true of both.
    fn join(self, other: Factor) -> Factor {
        if self == other { self } else { Factor::Anything }
    }
}

/// The kind of a product, where there is one for the factors in this order.
fn kind(a: Factor, b: Factor) -> Option<u8> {
    match (a, b) {
        (Factor::Anything, Factor::Anything) => Some(GENERAL),
        (Factor::Anything, Factor::Unknown) => Some(BY_UNKNOWN),
        (Factor::Unknown, Factor::Unknown) => Some(UNKNOWNS),
        (Factor::Anything, Factor::Linear) => Some(BY_LINEAR),
        (Factor::Linear, Factor::Unknown) => Some(LINEAR_BY_UNKNOWN),
        (Factor::Linear, Factor::Linear) => Some(LINEARS),
        (Factor::Unknown, _) | (Factor::Linear, Factor::Anything) => None,
    }
}

/// Kinds, the ones that leave out most first.
const BEST_FIRST: [u8; 6] = [LINEARS, LINEAR_BY_UNKNOWN, UNKNOWNS, BY_LINEAR, BY_UNKNOWN, GENERAL];

/// The order of factors that leaves out most, and its kind, which holds for both products of an
/// instruction.
fn sort_factors(op: Op, args: [Operand; 4], factor: impl Fn(Operand) -> Factor) -> ([Operand; 4], u8) {
    let [a, b, c, d] = args;
    let orders = match op {
        Op::Mul | Op::MulAdd | Op::MulSub | Op::SubMul => vec![args, [b, a, c, d]],
        Op::MulMulAdd | Op::MulMulSub => vec![args, [b, a, c, d], [a, b, d, c], [b, a, d, c]],
        Op::Sqr => vec![[a; 4]],
        Op::Add | Op::Sub | Op::Neg | Op::MulReal | Op::Inv | Op::MulRealAdd => return (args, GENERAL),
    };
    let two_products = matches!(op, Op::MulMulAdd | Op::MulMulSub);
    let rank = |args: &[Operand; 4]| {
        let [a, b, c, d] = args.map(&factor);
        let found = if two_products { kind(a.join(c), b.join(d)) } else { kind(a, b) };
        BEST_FIRST.iter().position(|&kind| Some(kind) == found)
    };
    let best = orders.into_iter().filter_map(|args| Some((rank(&args)?, args))).min_by_key(|&(rank, _)| rank);
    best.map_or((args, GENERAL), |(rank, args)| (args, BEST_FIRST[rank]))
}

struct Order1<'a, S> {
    tape: &'a TaylorTape,
    series: &'a mut [Series<S>],
}

impl<S: Scalar> Kernel for Order1<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Order1 { tape, series } = self;
        sweep::<S, 0, 1, false, true>(series, &tape.parameters_only);
        for code in &*tape.variables_only {
            let operands = code.operands.map(|k| k as usize);
            step::<S, 0, 0, GENERAL>(series, code.op, code.target as usize, operands);
            series[code.target as usize][1] = S::zero();
        }
        sweep::<S, 0, 1, false, false>(series, &tape.mixed);
    }
}

/// Order `K`, 2 or 3; `STRAIGHT` says that the parameters' coefficients of that order are zero.
struct Later<'a, const K: usize, const STRAIGHT: bool, S> {
    tape: &'a TaylorTape,
    series: &'a mut [Series<S>],
}

impl<const K: usize, const STRAIGHT: bool, S: Scalar> Kernel for Later<'_, K, STRAIGHT, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Later { tape, series } = self;
        // One sweep over both groups with unknowns, so that its code is made once.
        let groups = [&tape.variables_only, &tape.mixed];
        if K == 2 {
            sweep::<S, 2, 2, STRAIGHT, true>(series, &tape.parameters_only);
            for codes in groups {
                sweep::<S, 1, 2, STRAIGHT, false>(series, codes);
            }
        } else {
            sweep::<S, 3, 3, STRAIGHT, true>(series, &tape.parameters_only);
            for codes in groups {
                sweep::<S, 2, 3, STRAIGHT, false>(series, codes);
            }
        }
    }
}

/// Runs instructions; `FREE` says that they are free of unknowns, so that fewer kinds occur.
#[inline(always)]
fn sweep<S: Scalar, const FROM: usize, const TO: usize, const STRAIGHT: bool, const FREE: bool>(
    series: &mut [Series<S>],
    codes: &[TaylorCode],
) {
    for code in codes {
        let (t, operands) = (code.target as usize, code.operands.map(|k| k as usize));
        match code.kind {
            BY_LINEAR if STRAIGHT => step::<S, FROM, TO, BY_LINEAR>(series, code.op, t, operands),
            LINEAR_BY_UNKNOWN if STRAIGHT && !FREE => {
                step::<S, FROM, TO, LINEAR_BY_UNKNOWN>(series, code.op, t, operands);
            }
            LINEARS if STRAIGHT => step::<S, FROM, TO, LINEARS>(series, code.op, t, operands),
            BY_UNKNOWN | LINEAR_BY_UNKNOWN if !FREE => step::<S, FROM, TO, BY_UNKNOWN>(series, code.op, t, operands),
            UNKNOWNS if !FREE => step::<S, FROM, TO, UNKNOWNS>(series, code.op, t, operands),
            _ => step::<S, FROM, TO, GENERAL>(series, code.op, t, operands),
        }
    }
}
