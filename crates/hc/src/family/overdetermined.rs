//! Families with more equations than unknowns.
//!
//! As in [`solve`](crate::solve()), random combinations of the equations are tracked, as many as unknowns. They have
//! all solutions of the equations, and others. Solutions for generic parameters stay solutions of all equations while
//! parameters move: loops join them with each other alone, the orbits of the combinations are orbits of the family or
//! have none of its solutions, and the trace test of such orbits needs no change. A path that ends at a point that
//! solves the combinations alone has jumped, or began at a solution for special parameters.

use super::error::FamilyError;
use super::verdict::{Verdict, verdict};
use crate::refine::Refiner;
use crate::solve::{combinations, sizes};
use num_complex::Complex64;
use poly::{Interpreter, System};

/// Powers of two beyond these are not used.
const MOST: i64 = 1000;

/// More equations than unknowns.
#[derive(Debug)]
pub(super) struct Overdetermined {
    /// Random combinations of them, as many as unknowns.
    pub(super) square: System,
    /// All of them.
    pub(super) all: Interpreter,
}

impl Overdetermined {
    /// The equations of a system; `None` if they are not more than the unknowns.
    ///
    /// # Errors
    /// If a formula does not compile.
    pub(super) fn new(system: &System) -> Result<Option<Overdetermined>, FamilyError> {
        let (equations, unknowns) = (system.len(), system.variables().len());
        if equations <= unknowns {
            return Ok(None);
        }
        let all = system.compile()?;
        let usable = |sizes: &Vec<i64>| sizes.iter().all(|size| size.abs() <= MOST);
        let sizes = sizes(&all, 0).filter(usable).unwrap_or_else(|| vec![0; equations]);
        let degrees = system.degrees_as_written().unwrap_or_else(|| vec![1; equations]);
        let degree = |i: usize| i64::try_from(degrees[i]).unwrap_or(i64::MAX);
        let combined = combinations((0..equations).collect(), degree, unknowns, 0);
        let square = System::build(|s| {
            let unknowns: Vec<_> = system.variables().iter().map(|name| s.variable(name)).collect();
            let parameters: Vec<_> = system.parameters().iter().map(|name| s.parameter(name)).collect();
            let formulas = system.instantiate(s, &unknowns, &parameters);
            let share = |&(i, factor): &(usize, Complex64)| formulas[i] * (factor * 2f64.powi(-sizes[i] as i32));
            combined.iter().map(|combination| s.sum(combination.iter().map(share))).collect()
        });
        // The names and constants come from a system that exists already.
        let square = square.map_err(|_| FamilyError::NoPair)?;
        Ok(Some(Overdetermined { square, all }))
    }

    /// What the equations say of a regular solution of the combinations, whose program this is, for parameters `p`.
    pub(super) fn verdict(&self, combined: &Interpreter, p: &[Complex64], x: &[Complex64]) -> Verdict {
        verdict(&self.all, &Refiner::new(combined).extend(p, x), p, x)
    }
}
