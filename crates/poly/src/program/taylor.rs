//! Taylor coefficients along a path, one order at a time over resident memory.
//!
//! Every operand and every result keeps four coefficients. A call for order `k` first corrects
//! coefficient `k - 1` of each value, because the unknowns' coefficient `k - 1` was found since the
//! last call. It then computes coefficient `k`, in the same pass. Where the parameters move on a
//! straight line, factors that are linear in them have no coefficients beyond order 1, and products
//! leave these out.

use super::instruction::{Op, Operand, Tape};
use super::registers::{InputLayout, place};
use super::series::{
    BY_LINEAR, BY_UNKNOWN, GENERAL, LINEAR_BY_UNKNOWN, LINEARS, Series, UNKNOWNS, WIDTH, step_product, step_sum,
};
use crate::lanes::Lanes8;
use crate::scalar::{Lane, Scalar};
use crate::simd::{Isa, Kernel};
use crate::singles::Singles16;
use num_complex::Complex64;
use std::any::Any;
use std::borrow::Cow;

/// An instruction over the array of series `[constants | parameters | unknowns | results]`.
#[derive(Clone, Copy, Debug)]
pub struct TaylorCode {
    /// The operation.
    pub op: Op,
    /// The factors of its products: 0 anything, 1 anything and an unknown, 2 two unknowns, 3
    /// anything and something linear in parameters, 4 something linear in parameters and an
    /// unknown, 5 two factors that are linear in parameters.
    pub kind: u8,
    /// Place of the result.
    pub target: u32,
    /// Places of the operands; unused ones repeat the first.
    pub operands: [u32; 4],
}

/// A program for Taylor coefficients: instructions in three groups, each in order of execution.
#[derive(Clone, Debug)]
pub struct TaylorTape {
    /// Instructions free of unknowns: coefficient `k - 1` was final at order `k - 1` already.
    pub parameters_only: Cow<'static, [TaylorCode]>,
    /// Instructions free of parameters: coefficient 1 is zero as long as that of the unknowns is.
    pub variables_only: Cow<'static, [TaylorCode]>,
    /// Instructions with both.
    pub mixed: Cow<'static, [TaylorCode]>,
    /// Place of each output's series.
    pub outputs: Cow<'static, [u32]>,
    /// Number of constants, parameters and unknowns.
    pub inputs: [usize; 3],
    /// Number of series, inputs included.
    pub size: usize,
}

/// Coefficients that are kept between orders.
#[derive(Clone, Debug)]
pub struct TaylorMemory<S> {
    series: Vec<Series<S>>,
    /// The coefficients of one lane, where lanes are run one by one.
    lane: Vec<Series<Complex64>>,
    /// Orders at which the parameters' coefficients are not known to be zero.
    bent: [bool; WIDTH],
}

impl TaylorTape {
    pub(super) fn new(tape: &Tape, layout: InputLayout) -> TaylorTape {
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

    /// About how many products all coefficients of orders 0 to 3 take, where the parameters move on a straight line or
    /// not; a sum counts as half a product.
    pub(crate) fn work(&self, straight: bool) -> usize {
        let products = |kind: u8| match kind {
            UNKNOWNS => 8,
            BY_LINEAR if straight => 10,
            LINEAR_BY_UNKNOWN if straight => 7,
            LINEARS if straight => 6,
            BY_UNKNOWN | LINEAR_BY_UNKNOWN => 11,
            _ => 14,
        };
        let work = |code: &TaylorCode| match code.op {
            Op::Add | Op::Sub | Op::Neg | Op::MulReal | Op::MulRealAdd => 3,
            Op::Mul | Op::MulAdd | Op::MulSub | Op::SubMul => products(code.kind),
            Op::MulMulAdd | Op::MulMulSub => 2 * products(code.kind),
            Op::Sqr => products(code.kind) * 2 / 3,
            Op::Inv => products(GENERAL),
        };
        [&self.parameters_only, &self.variables_only, &self.mixed]
            .into_iter()
            .flat_map(|codes| codes.iter())
            .map(work)
            .sum()
    }

    /// Resident coefficients, with those of the constants in place.
    pub(crate) fn memory<S: Scalar>(&self, isa: Isa, constants: &[S]) -> TaylorMemory<S> {
        let zero = || [S::zero(), S::zero(), S::zero(), S::zero()];
        let mut series: Vec<Series<S>> = (0..self.size).map(|_| zero()).collect();
        for (series, constant) in series.iter_mut().zip(constants) {
            series[0] = constant.clone();
        }
        let by_lane = isa.within_machine() < S::TAYLOR_NARROWEST;
        let lane = if by_lane { vec![[Complex64::zero(); WIDTH]; self.size] } else { Vec::new() };
        TaylorMemory { series, lane, bent: [false; WIDTH] }
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
        let TaylorMemory { series, lane, bent } = memory;
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
        let pass = TaylorPass { tape: self, order, straight };
        if const { S::TAYLOR_COMPILED } {
            let series: &mut dyn Any = series;
            if let Some(series) = series.downcast_mut() {
                pass.run_eight(isa, series, lane);
            } else if let Some(series) = series.downcast_mut() {
                pass.run_one(series);
            } else if let Some(series) = series.downcast_mut() {
                pass.run_sixteen(isa, series);
            } else {
                unreachable!("numbers of this crate alone have TAYLOR_COMPILED");
            }
        } else {
            pass.run::<S>(isa, series);
        }
        for (value, &place) in out[..self.outputs.len()].iter_mut().zip(&*self.outputs) {
            *value = series[place as usize][order].clone();
        }
    }
}

/// What is known about a factor when the program is made.
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

    /// What holds for both factors.
    fn join(self, other: Factor) -> Factor {
        if self == other { self } else { Factor::Anything }
    }
}

/// The kind of a product with the factors in this order, if there is one.
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

/// Kinds, ordered by how much they leave out, most first.
const BEST_FIRST: [u8; 6] = [LINEARS, LINEAR_BY_UNKNOWN, UNKNOWNS, BY_LINEAR, BY_UNKNOWN, GENERAL];

/// The order of the factors that leaves out most, and its kind, which holds for both products of an
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

/// The instructions of a tape for one order, 1, 2 or 3.
#[derive(Clone, Copy)]
struct TaylorPass<'a> {
    tape: &'a TaylorTape,
    order: usize,
    /// Whether the parameters' coefficients of that order are zero.
    straight: bool,
}

impl TaylorPass<'_> {
    #[inline(always)]
    fn run<S: Scalar>(self, isa: Isa, series: &mut [Series<S>]) {
        let TaylorPass { tape, order, straight } = self;
        match (order, straight) {
            (1, _) => isa.run(Order1 { tape, series }),
            (2, false) => isa.run(Later::<2, false, S> { tape, series }),
            (2, true) => isa.run(Later::<2, true, S> { tape, series }),
            (_, false) => isa.run(Later::<3, false, S> { tape, series }),
            (_, true) => isa.run(Later::<3, true, S> { tape, series }),
        }
    }

    /// The pass for one path, compiled here.
    #[inline(never)]
    fn run_one(self, series: &mut Vec<Series<Complex64>>) {
        self.run(Isa::Portable, series);
    }

    /// The pass for sixteen paths in single precision, compiled here.
    #[inline(never)]
    fn run_sixteen(self, isa: Isa, series: &mut Vec<Series<Singles16>>) {
        self.run(isa, series);
    }

    /// The pass for eight paths, compiled here. Where there is no code for lanes, it runs one lane
    /// after the other, to the same bits.
    #[inline(never)]
    fn run_eight(self, isa: Isa, series: &mut Vec<Series<Lanes8>>, lane: &mut Vec<Series<Complex64>>) {
        if isa.within_machine() >= Lanes8::TAYLOR_NARROWEST {
            return self.run(isa, series);
        }
        for l in 0..Lanes8::LANES {
            for (to, from) in lane.iter_mut().zip(&*series) {
                *to = [from[0].get(l), from[1].get(l), from[2].get(l), from[3].get(l)];
            }
            self.run_one(lane);
            for (to, from) in series.iter_mut().zip(&*lane) {
                for (to, &from) in to.iter_mut().zip(from) {
                    to.set(l, from);
                }
            }
        }
    }
}

struct Order1<'a, S> {
    tape: &'a TaylorTape,
    series: &'a mut [Series<S>],
}

impl<S: Scalar> Kernel for Order1<'_, S> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;
    const NARROWEST: Isa = S::TAYLOR_NARROWEST;

    #[inline(always)]
    fn run(self) {
        let Order1 { tape, series } = self;
        sweep::<S, 0, 1, false, true>(series, &tape.parameters_only);
        for code in &*tape.variables_only {
            let operands = code.operands.map(|k| k as usize);
            let t = code.target as usize;
            if !step_sum::<S, 0, 0>(series, code.op, t, operands) {
                step_product::<S, 0, 0, GENERAL>(series, code.op, t, operands);
            }
            series[t][1] = S::zero();
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
    const WIDEST: Isa = S::WIDEST;
    const NARROWEST: Isa = S::TAYLOR_NARROWEST;

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

/// Runs instructions. `FREE` says that they are free of unknowns, so that fewer kinds occur.
#[inline(always)]
fn sweep<S: Scalar, const FROM: usize, const TO: usize, const STRAIGHT: bool, const FREE: bool>(
    series: &mut [Series<S>],
    codes: &[TaylorCode],
) {
    for code in codes {
        let (op, t, operands) = (code.op, code.target as usize, code.operands.map(|k| k as usize));
        if step_sum::<S, FROM, TO>(series, op, t, operands) {
            continue;
        }
        match code.kind {
            BY_LINEAR if STRAIGHT => step_product::<S, FROM, TO, BY_LINEAR>(series, op, t, operands),
            LINEAR_BY_UNKNOWN if STRAIGHT && !FREE => {
                step_product::<S, FROM, TO, LINEAR_BY_UNKNOWN>(series, op, t, operands);
            }
            LINEARS if STRAIGHT => step_product::<S, FROM, TO, LINEARS>(series, op, t, operands),
            BY_UNKNOWN | LINEAR_BY_UNKNOWN if !FREE => {
                step_product::<S, FROM, TO, BY_UNKNOWN>(series, op, t, operands);
            }
            UNKNOWNS if !FREE => step_product::<S, FROM, TO, UNKNOWNS>(series, op, t, operands),
            _ => step_product::<S, FROM, TO, GENERAL>(series, op, t, operands),
        }
    }
}
