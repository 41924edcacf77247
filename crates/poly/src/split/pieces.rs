//! A split before it is compiled.

use crate::graph::{Graph, Id};
use crate::program::{Interpreter, Program};

/// The highest degree of a part. Formulas of a higher one are split further down.
pub(super) const MOST_DEGREE: u32 = 8;

/// Formulas that are split.
pub(super) struct Pieces {
    /// The parts, in the parameters, with their degrees.
    pub(super) parts: Graph,
    pub(super) roots: Vec<(Id, u32)>,
    /// The equations, in which part `i` of `roots` is parameter `i`.
    pub(super) rest: Graph,
    pub(super) equations: Vec<Id>,
}

impl Pieces {
    /// Compiled for so many unknowns and parameters of the whole: the parts, in descending order of their degrees, these
    /// degrees, and the equations.
    pub(super) fn compiled(self, variables: usize, parameters: usize) -> Option<(Interpreter, Vec<u32>, Interpreter)> {
        let Pieces { parts, roots, rest, equations } = self;
        let mut order: Vec<usize> = (0..roots.len()).collect();
        order.sort_by_key(|&i| std::cmp::Reverse(roots[i].1));
        let mut place = vec![0; roots.len()];
        (0u32..).zip(&order).for_each(|(k, &i)| place[i] = k);
        let (formulas, degrees): (Vec<Id>, Vec<u32>) = order.iter().map(|&i| roots[i]).unzip();
        let parts = Program::of_graph(&parts, &formulas, 0, parameters).ok()?;
        let rest = Program::of_graph(&rest.renumbered(&place), &equations, variables, roots.len()).ok()?;
        Some((Interpreter::new(parts), degrees, Interpreter::new(rest)))
    }
}
