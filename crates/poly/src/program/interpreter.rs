//! Runs a program over any scalar.

use super::straight_line::{Program, Tables};
use super::taylor::TaylorMemory;
use crate::evaluate::Evaluate;
use crate::scalar::Scalar;
use crate::simd::Isa;
use std::sync::Arc;

/// A compiled system, ready to be evaluated. It is cheap to clone and to share between threads.
#[derive(Clone, Debug)]
pub struct Interpreter {
    compiled: Arc<Compiled>,
}

#[derive(Debug)]
struct Compiled {
    program: Program,
    tables: Tables,
}

/// Scratch space of an [`Interpreter`].
#[derive(Clone, Debug)]
pub struct InterpreterMemory<S> {
    isa: Isa,
    /// Constants, parameters, unknowns and registers, of whichever tape ran last.
    array: Vec<S>,
    /// Taylor coefficients of every operand and every result.
    taylor: TaylorMemory<S>,
}

impl Interpreter {
    /// Prepares a program for running.
    pub fn new(program: Program) -> Interpreter {
        let tables = Tables::new(&program);
        Interpreter { compiled: Arc::new(Compiled { program, tables }) }
    }

    /// About how many products a step of the tracker takes: two Jacobians, two evaluations, the Taylor coefficients,
    /// where the parameters move on a `straight` line or not.
    pub(crate) fn work_of_step(&self, straight: bool) -> usize {
        let Compiled { program, tables } = &*self.compiled;
        2 * (program.jacobian_operations() + program.value_operations()) + tables.taylor.work(straight)
    }

    /// The program that this interpreter runs.
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
        let taylor = compiled.tables.taylor.memory(isa, &constants);
        let mut array = constants;
        array.resize(compiled.tables.values.size.max(compiled.tables.jacobian.size), S::zero());
        InterpreterMemory { isa, array, taylor }
    }

    fn values<S: Scalar>(&self, memory: &mut InterpreterMemory<S>, x: &[S], p: &[S], values: &mut [S]) {
        self.compiled.tables.values.set_parameters(&mut memory.array, p);
        self.values_again(memory, x, p, values);
    }

    fn jacobian<S: Scalar>(
        &self,
        memory: &mut InterpreterMemory<S>,
        x: &[S],
        p: &[S],
        values: &mut [S],
        jacobian: &mut [S],
    ) {
        self.compiled.tables.jacobian.set_parameters(&mut memory.array, p);
        self.jacobian_again(memory, x, p, values, jacobian);
    }

    fn values_again<S: Scalar>(&self, memory: &mut InterpreterMemory<S>, x: &[S], _: &[S], values: &mut [S]) {
        let compiled = &*self.compiled;
        let values = &mut values[..compiled.program.equations];
        compiled.tables.values.run(memory.isa, &mut memory.array, x, values, &mut []);
    }

    fn jacobian_again<S: Scalar>(
        &self,
        memory: &mut InterpreterMemory<S>,
        x: &[S],
        _: &[S],
        values: &mut [S],
        jacobian: &mut [S],
    ) {
        let compiled = &*self.compiled;
        let rows = compiled.program.equations;
        let (values, jacobian) = (&mut values[..rows], &mut jacobian[..rows * compiled.program.variables]);
        compiled.tables.jacobian.run(memory.isa, &mut memory.array, x, values, jacobian);
    }

    fn vanishes(&self, row: usize, column: usize) -> bool {
        let compiled = &*self.compiled;
        // Values come before the entries; both are in ascending order.
        let slot = compiled.program.equations * (column + 1) + row;
        compiled.tables.jacobian.zeros.binary_search(&(slot as u32)).is_ok()
    }

    fn taylor<S: Scalar>(&self, memory: &mut InterpreterMemory<S>, order: usize, x: &[S], p: &[S], out: &mut [S]) {
        let compiled = &*self.compiled;
        compiled.tables.taylor.run(memory.isa, &mut memory.taylor, order, x, p, out);
    }
}
