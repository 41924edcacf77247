//! Families along a line of their parameters: what knows no unknowns is computed once for the whole line.
//!
//! A family `F(x; p)` is split into `H(x; q)` and the parts `q(p)`, which are polynomials in the parameters alone.
//! Where the parameters move on a line `p(t)`, the parts are polynomials in `t` of low degree. Their coefficients
//! take one evaluation in truncated arithmetic; along the line then only `H` is evaluated.
//!
//! Two ways to split are tried: to cut the formulas as they are written, and to expand them, collect the
//! terms by their monomials in the unknowns, and nest the sums (multivariate Horner). The one with fewer
//! operations is taken, if these are clearly fewer than without a split.

mod cut;
mod nested;
mod pieces;
mod series;

use crate::evaluate::Evaluate;
use crate::program::Interpreter;
use crate::system::System;
use num_complex::Complex64;
use series::coefficients;

/// A split has at most this share of the operations, in per cent: less is not worth another program.
const WORTHWHILE: usize = 90;

/// A family `F(x; p) = H(x; q(p))` whose parts `q`, polynomials in the parameters, are parameters of their own.
///
/// ```
/// use poly::{Complex64, Evaluate, Isa, Split, System};
/// let real = |x: f64| Complex64::new(x, 0.0);
/// let family = poly::parse::family(
///     "name = 'roots'\nunknowns = ['x']\nparameters = ['a', 'b']\nequations = ['(a^2 + b)*x^3 + (a - b)^2*x - 1']",
/// )?;
/// let program = family.system.compile()?;
/// let split = Split::new(&family.system, &program).unwrap();
/// assert_eq!(split.degrees(), [2, 2]);
/// // Along a = 1 + t, b = 2 - t: a^2 + b = 3 + t + t^2, (a - b)^2 = 1 - 4 t + 4 t^2.
/// let mut along = Vec::new();
/// split.along(&[real(1.0), real(2.0)], &[real(1.0), real(-1.0)], &mut along);
/// let mut pairs: Vec<_> = (0..2).map(|i| [along[i].re, along[2 + i].re, along[4 + i].re]).collect();
/// pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
/// assert_eq!(pairs, [[1.0, -4.0, 4.0], [3.0, 1.0, 1.0]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Split {
    parts: Interpreter,
    degrees: Vec<u32>,
    system: Interpreter,
}

impl Split {
    /// The split of a system, compiled as `whole`, with the fewest operations; `None` if no split has clearly
    /// fewer than the whole.
    pub fn new(system: &System, whole: &Interpreter) -> Option<Split> {
        let (variables, parameters) = (whole.variables(), whole.parameters());
        let mut least = work(whole, &vec![1; parameters]) * WORTHWHILE / 100;
        let mut best = None;
        for pieces in [cut::cut(system), nested::nested(system)].into_iter().flatten() {
            let Some((parts, degrees, system)) = pieces.compiled(variables, parameters) else { continue };
            let split = Split { parts, degrees, system };
            let work = work(&split.system, &split.degrees);
            if work < least {
                (least, best) = (work, Some(split));
            }
        }
        best
    }

    /// The parts `q(p)` as a system without unknowns.
    pub fn parts(&self) -> &Interpreter {
        &self.parts
    }

    /// The degrees of the parts in the parameters, descending.
    pub fn degrees(&self) -> &[u32] {
        &self.degrees
    }

    /// The equations `H(x; q)`.
    pub fn system(&self) -> &Interpreter {
        &self.system
    }

    /// The parts along the line `p(t) = origin + t direction`, as polynomials in `t`: `out[k * len + i]` is
    /// coefficient `k` of part `i`, where `len` is the number of parts, `k` goes up to the highest degree, and
    /// coefficients above the degree of a part are zero.
    ///
    /// With rounding unit `u`, coefficient `k` is off by at most about `c u` times coefficient `k` of the part
    /// with absolute values in place of all its terms, `|origin| + t |direction|` in place of the parameters, where
    /// `c` is the number of operations on the way. This is how far the value of the part itself may be off: as
    /// sums of such coefficients, parts are as accurate along the whole line as if they were evaluated there.
    ///
    /// # Panics
    /// If there is not one number for each parameter.
    pub fn along(&self, origin: &[Complex64], direction: &[Complex64], out: &mut Vec<Complex64>) {
        coefficients(&self.parts, self.degrees.first().copied().unwrap_or(0), origin, direction, out);
    }
}

/// How much there is to do for a step along the line, the parameters included, which have these degrees.
fn work(program: &Interpreter, degrees: &[u32]) -> usize {
    let parameters: usize = degrees.iter().map(|&degree| 1 + degree as usize).sum();
    program.work_of_step(degrees.iter().all(|&degree| degree <= 1)) + parameters
}

#[cfg(test)]
mod tests;
