//! The dual space of the local ring at a solution: the differential functionals that vanish on all
//! multiples of the equations.
//!
//! The number of these functionals is the multiplicity (Dayton & Zeng 2005). They are found order
//! by order. The derivatives of a functional, in the sense of lowered exponents, are functionals of
//! a lower order; each functional is therefore a combination of integrals of known ones (Mourrain
//! 1997; the closedness subspace of Zeng 2009). If an order adds none, all are found, and the
//! solution is isolated. If there are more functionals than paths that can end at an isolated
//! solution, it is not isolated (Bates, Hauenstein, Peterson & Sommese 2009).

use super::eliminate::{Elimination, PivotLimit};
use super::number::{Number, largest};
use super::series::Basis;
use crate::tolerances::structure;

/// What the functionals up to an order tell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Count {
    /// The number of all functionals; the solution is isolated.
    All(usize),
    /// There are more functionals than the bound.
    More,
    /// More orders are needed.
    Unfinished,
    /// Some numbers are neither clearly zero nor clearly nonzero.
    Unclear,
}

/// Counts the functionals at the origin of equations in a few unknowns, given as series without
/// constant terms, up to the order of the basis; more than `bound` are not sought.
pub(crate) fn count<S: Number>(basis: &Basis, equations: &[Vec<S>], bound: usize) -> Count {
    let mut space = DualSpace::new(basis);
    for order in 1..=basis.order() {
        let Some(found) = space.grown(equations, order) else { return Count::Unclear };
        if found == 0 {
            return Count::All(space.functionals.len());
        }
        if space.functionals.len() > bound {
            return Count::More;
        }
    }
    Count::Unfinished
}

/// Functionals found so far.
struct DualSpace<'a, S> {
    basis: &'a Basis,
    /// Their coefficients at the monomials of the basis; the first functional is the value at the origin.
    functionals: Vec<Vec<S>>,
    /// `lowered[i][b]`: functional `b` with its exponents of variable `i` lowered, in terms of the
    /// functionals.
    lowered: Vec<Vec<Vec<S>>>,
}

impl<S: Number> DualSpace<'_, S> {
    fn new(basis: &Basis) -> DualSpace<'_, S> {
        DualSpace {
            basis,
            functionals: vec![basis.constant(S::one(), 0)],
            lowered: vec![vec![vec![S::zero()]]; basis.variables()],
        }
    }

    /// Adds the functionals of an order, and returns how many; `None` where that is not clear.
    fn grown(&mut self, equations: &[Vec<S>], order: usize) -> Option<usize> {
        let (n, m) = (self.basis.variables(), self.functionals.len());
        // Unknowns: functional `b` in what lowering variable `i` gives, at `i * m + b`.
        let mut rows: Vec<Vec<S>> = Vec::new();
        for i in 0..n {
            for j in i + 1..n {
                // Lowering `i` and then `j` is lowering `j` and then `i`.
                for a in 0..m {
                    let mut row = vec![S::zero(); n * m];
                    for b in 0..m {
                        row[i * m + b] = self.lowered[j][b][a];
                        row[j * m + b] = S::neg(&self.lowered[i][b][a]);
                    }
                    rows.push(row);
                }
            }
        }
        let integrals: Vec<Vec<S>> =
            (0..n * m).map(|k| self.integral(k / m, &self.functionals[k % m], order)).collect();
        for equation in equations {
            let value =
                |integral: &Vec<S>| integral.iter().zip(equation).fold(S::zero(), |sum, (a, b)| S::mul_add(a, b, &sum));
            rows.push(integrals.iter().map(value).collect());
        }
        // Functionals that are known already are left out.
        for b in 1..m {
            let known = |k: usize| self.lowered[k / m][b][k % m].conjugate();
            rows.push((0..n * m).map(known).collect());
        }
        for row in &mut rows {
            let size = largest(row.iter());
            if size > structure::ZERO * S::BITS && size < structure::CLEAR * S::BITS {
                return None;
            }
            // Rows of rounding errors stay as small as they are.
            if size.is_finite() && size >= structure::CLEAR * S::BITS {
                row.iter_mut().for_each(|z| *z = z.shifted(-(size.round() as i64)));
            }
        }
        let found =
            Elimination::new(rows, n * m, PivotLimit::Below(0.5 * (structure::ZERO + structure::CLEAR) * S::BITS));
        if !(found.rest <= structure::ZERO * S::BITS && found.smallest >= structure::CLEAR * S::BITS) {
            return None;
        }
        let vectors = found.null_space();
        for (new, vector) in vectors.iter().enumerate() {
            let mut functional = vec![S::zero(); self.basis.count(order)];
            for (integral, c) in integrals.iter().zip(vector) {
                for (sum, z) in functional.iter_mut().zip(integral) {
                    *sum = S::mul_add(c, z, sum);
                }
            }
            let size = largest(&functional);
            let unit = if size.is_finite() { -(size.round() as i64) } else { 0 };
            functional.iter_mut().for_each(|z| *z = z.shifted(unit));
            self.functionals.push(functional);
            for (i, lowered) in self.lowered.iter_mut().enumerate() {
                let mut row: Vec<S> = vector[i * m..(i + 1) * m].iter().map(|z| z.shifted(unit)).collect();
                row.resize(m + new + 1, S::zero());
                lowered.push(row);
            }
        }
        let total = self.functionals.len();
        self.lowered.iter_mut().flatten().for_each(|row| row.resize(total, S::zero()));
        Some(vectors.len())
    }

    /// The functional that gives this one when its exponents of variable `i` are lowered, as far as
    /// monomials go whose last variable is `i`.
    fn integral(&self, i: usize, functional: &[S], order: usize) -> Vec<S> {
        let mut integral = vec![S::zero(); self.basis.count(order)];
        for (k, c) in functional.iter().enumerate() {
            if self.basis.exponents()[k][i + 1..].iter().all(|&e| e == 0) {
                integral[self.basis.raised(k, i)] = *c;
            }
        }
        integral
    }
}
