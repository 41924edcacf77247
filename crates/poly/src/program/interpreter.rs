//! Runs a program over any scalar.

use super::instruction::Op;
use super::registers::{Code, Layout, RegisterTape, allocate};
use super::straight_line::Program;
use super::taylor::{TaylorMemory, TaylorTape};
use crate::evaluate::Evaluate;
use crate::scalar::Scalar;
use crate::simd::{Isa, Kernel};
use std::sync::Arc;

/// A compiled system, ready to be evaluated; cheap to clone and to share between threads.
#[derive(Clone, Debug)]
pub struct Interpreter {
    compiled: Arc<Compiled>,
}

#[derive(Debug)]
struct Compiled {
    program: Program,
    layout: Layout,
    values: RegisterTape,
    jacobian: RegisterTape,
    taylor: TaylorTape,
}

/// Scratch space of an [`Interpreter`].
#[derive(Clone, Debug)]
pub struct InterpreterMemory<S> {
    isa: Isa,
    values: Vec<S>,
    jacobian: Vec<S>,
    /// Taylor coefficients of every operand and every result.
    taylor: TaylorMemory<S>,
}

impl Interpreter {
    /// Prepares a program to be run.
    pub fn new(program: Program) -> Interpreter {
        let layout = program.layout();
        let values = allocate(&program.values, layout, program.equations);
        let jacobian = allocate(&program.jacobian, layout, program.equations * (1 + program.variables));
        let taylor = TaylorTape::new(&program.values, layout);
        Interpreter { compiled: Arc::new(Compiled { program, layout, values, jacobian, taylor }) }
    }

    /// The program that is run.
    pub fn program(&self) -> &Program {
        &self.compiled.program
    }
}

impl Evaluate for Interpreter {
    type Memory<S: Scalar> = InterpreterMemory<S>;

    fn equations(&self) -> usize {
        self.compiled.program.equations
    }
    fn variables(&self) -> usize {
        self.compiled.program.variables
    }
    fn parameters(&self) -> usize {
        self.compiled.program.parameters
    }

    fn memory<S: Scalar>(&self, isa: Isa) -> InterpreterMemory<S> {
        let compiled = &*self.compiled;
        let constants: Vec<S> = compiled.program.constants.iter().map(S::from_exact).collect();
        let array = |size: usize| {
            let mut array = constants.clone();
            array.resize(size, S::zero());
            array
        };
        InterpreterMemory {
            isa,
            values: array(compiled.values.size),
            jacobian: array(compiled.jacobian.size),
            taylor: compiled.taylor.memory(&constants),
        }
    }

    fn values<S: Scalar>(&self, memory: &mut InterpreterMemory<S>, x: &[S], p: &[S], values: &mut [S]) {
        let compiled = &*self.compiled;
        compiled.load(&mut memory.values, x, p);
        memory.isa.run(Run { code: &compiled.values.code, array: &mut memory.values });
        let outputs = &mut values[..compiled.program.equations];
        for &(slot, register) in &compiled.values.outputs {
            outputs[slot as usize] = memory.values[register as usize].clone();
        }
    }

    fn jacobian<S: Scalar>(
        &self,
        memory: &mut InterpreterMemory<S>,
        x: &[S],
        p: &[S],
        values: &mut [S],
        jacobian: &mut [S],
    ) {
        let compiled = &*self.compiled;
        let rows = compiled.program.equations;
        compiled.load(&mut memory.jacobian, x, p);
        memory.isa.run(Run { code: &compiled.jacobian.code, array: &mut memory.jacobian });
        let (values, jacobian) = (&mut values[..rows], &mut jacobian[..rows * compiled.program.variables]);
        for &slot in &compiled.jacobian.zeros {
            jacobian[slot as usize - rows] = S::zero();
        }
        for &(slot, register) in &compiled.jacobian.outputs {
            let value = memory.jacobian[register as usize].clone();
            match (slot as usize).checked_sub(rows) {
                None => values[slot as usize] = value,
                Some(entry) => jacobian[entry] = value,
            }
        }
    }

    fn taylor<S: Scalar>(&self, memory: &mut InterpreterMemory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]) {
        let compiled = &*self.compiled;
        compiled.taylor.run(memory.isa, &mut memory.taylor, order, x, p, out);
    }
}

impl Compiled {
    fn load<S: Scalar>(&self, array: &mut [S], x: &[S], p: &[S]) {
        let Layout { constants, parameters, variables } = self.layout;
        array[constants..][..parameters].clone_from_slice(&p[..parameters]);
        array[constants + parameters..][..variables].clone_from_slice(&x[..variables]);
    }
}

/// The loop over instructions.
struct Run<'a, S> {
    code: &'a [Code],
    array: &'a mut [S],
}

impl<S: Scalar> Kernel for Run<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let array = self.array;
        for &Code { op, target, a, b, c, d } in self.code {
            let [a, b, c, d] = [a, b, c, d].map(|k| &array[k as usize]);
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
