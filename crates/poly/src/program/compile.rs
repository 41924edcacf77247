//! From a system to its straight-line programs.

use super::collect::collect;
use super::derivative;
use super::instruction::{Operand, Tape};
use super::interpreter::Interpreter;
use super::lower::Builder;
use super::schedule;
use super::straight_line::Program;
use crate::exact::Exact;
use crate::graph::{Graph, Id, Node};
use crate::system::System;

/// Most nodes of a formula graph, derivatives included.
const NODE_LIMIT: usize = 20_000_000;

/// Why a system cannot be compiled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CompileError {
    /// A formula divides by zero for all values of the unknowns.
    #[error("equation {equation} divides by the constant zero")]
    DivisionByZero {
        /// The equation, from 1.
        equation: usize,
    },
    /// The programs would be too long.
    #[error(
        "the Jacobian needs more than {limit} operations; split the system or write its formulas with more in common"
    )]
    TooLarge {
        /// Largest number of operations that is tried.
        limit: usize,
    },
}

impl Program {
    /// The program of a system.
    ///
    /// # Errors
    /// If a formula divides by the constant zero or the program would be too long.
    pub fn new(system: &System) -> Result<Program, CompileError> {
        let (variables, parameters) = (system.variables().len(), system.parameters().len());
        Program::of_graph(&system.arena.graph, &system.equations, variables, parameters)
    }

    /// The program of formulas in so many unknowns and parameters.
    pub(crate) fn of_graph(
        graph: &Graph,
        roots: &[Id],
        variables: usize,
        parameters: usize,
    ) -> Result<Program, CompileError> {
        let (graph, roots) = &collect(graph, roots);
        check_divisions(graph, roots)?;
        let equations = roots.len();

        let mut builder = Builder::default();
        let operands = builder.lower(graph, roots);
        let values = schedule::finish(&mut builder, (0u32..).zip(operands).collect());
        let mut constants = std::mem::take(&mut builder.constants);

        let mut reverse_graph = graph.clone();
        let reverse = derivative::reverse(&mut reverse_graph, roots);
        let mut jacobian = lower_jacobian(&reverse_graph, roots, &reverse, &mut constants)?;
        // Forward mode needs a sweep over everything for each unknown; it is tried only where it
        // can win.
        if graph.len().saturating_mul(variables) <= NODE_LIMIT {
            let mut forward_graph = graph.clone();
            let forward = derivative::forward(&mut forward_graph, roots, variables);
            let mut forward_constants = constants.clone();
            if let Ok(tape) = lower_jacobian(&forward_graph, roots, &forward, &mut forward_constants)
                && tape.instructions.len() < jacobian.instructions.len()
            {
                jacobian = tape;
                constants = forward_constants;
            }
        }
        Ok(Program { equations, variables, parameters, constants, values, jacobian })
    }
}

impl System {
    /// The system as straight-line programs, ready to be evaluated.
    ///
    /// # Errors
    /// If a formula divides by the constant zero or the programs would be too long.
    pub fn compile(&self) -> Result<Interpreter, CompileError> {
        Ok(Interpreter::new(Program::new(self)?))
    }
}

/// Lowers values and derivatives together, row by row, so that a row's shared subformulas are live
/// only in that row.
fn lower_jacobian(
    graph: &Graph,
    roots: &[Id],
    entries: &[(usize, u32, Id)],
    constants: &mut Vec<Exact>,
) -> Result<Tape, CompileError> {
    if graph.len() > NODE_LIMIT {
        return Err(CompileError::TooLarge { limit: NODE_LIMIT });
    }
    let mut builder = Builder::with_constants(std::mem::take(constants));
    let rows = roots.len();
    let mut wanted: Vec<(usize, u32, Id)> = Vec::with_capacity(rows + entries.len());
    wanted.extend(roots.iter().enumerate().map(|(i, &root)| (i, i as u32, root)));
    wanted.extend(entries.iter().map(|&(i, j, id)| (i, (rows + j as usize * rows + i) as u32, id)));
    wanted.sort_by_key(|&(i, slot, _)| (i, slot));
    let ids: Vec<Id> = wanted.iter().map(|&(_, _, id)| id).collect();
    let (graph, ids) = collect(graph, &ids);
    let operands = builder.lower(&graph, &ids);
    let outputs: Vec<(u32, Operand)> = wanted.iter().zip(operands).map(|(&(_, slot, _), o)| (slot, o)).collect();
    let tape = schedule::finish(&mut builder, outputs);
    *constants = builder.constants;
    Ok(tape)
}

fn check_divisions(graph: &Graph, roots: &[Id]) -> Result<(), CompileError> {
    for (k, &root) in roots.iter().enumerate() {
        let used = graph.reachable([root]);
        for id in (0..graph.len()).filter(|&id| used[id]) {
            let bad = match graph.node(id as Id) {
                Node::Div(_, b) => graph.is_zero(b),
                Node::Pow(a, exponent) => exponent < 0 && graph.is_zero(a),
                _ => false,
            };
            if bad {
                return Err(CompileError::DivisionByZero { equation: k + 1 });
            }
        }
    }
    Ok(())
}
