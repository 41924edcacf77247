//! LU factorisation of small complex matrices, one or several at once.
//!
//! Entries that are zero whatever the input are left out, with those that the elimination leaves zero.
//!
//! Threshold pivoting is done lane by lane with implicitly scaled rows (Skeel 1979). The measure of
//! a row is `|a_ik| / max_j |a_ij| w_j`, where `w` are the weights of the unknowns. The row on the
//! diagonal stays if its measure is at least [`THRESHOLD`] of the largest. Lanes therefore never
//! influence each other, and a lane gives bit for bit what the one-lane factorisation gives. Rows
//! are moved only where it matters, because moving them costs time in lanes.

mod condition;
mod kernels;
#[cfg(test)]
mod tests;

pub(crate) use condition::Estimate;

use kernels::{Factor, Solve};
use poly::simd::Isa;
use poly::{Evaluate, Lane};

/// Share of the largest candidate from which on the diagonal is kept as the pivot.
pub(crate) const THRESHOLD: f64 = 0.1;

/// Workspace and result of a factorisation of one `n x n` matrix a lane.
#[derive(Debug)]
pub(crate) struct Lu<S: Lane> {
    n: usize,
    isa: Isa,
    /// Column-major factors: unit lower triangle below the diagonal, upper triangle above, inverse
    /// pivots on it.
    factors: Vec<S>,
    row_scale: Vec<S::Real>,
    /// Row exchanged with row `k` in step `k`, for lane `l`: `pivots[k * LANES + l]`.
    pivots: Vec<u32>,
    /// Whether any lane exchanges rows in step `k`.
    moved: Vec<bool>,
    /// The rows of each column that are not always zero, a bit for each; empty if nothing is known.
    structure: Vec<u64>,
    /// The same of the factors.
    pattern: Vec<u64>,
}

/// Largest order of matrices whose zeros are left out.
const SPARSE_ORDER: usize = u64::BITS as usize;
/// If more than this share of a matrix may be other than zero, all of it is treated alike.
const DENSE_SHARE: f64 = 0.9;

impl<S: Lane> Lu<S> {
    /// Workspace for matrices of order `n`.
    pub(crate) fn new(n: usize, isa: Isa) -> Self {
        Lu {
            n,
            isa,
            factors: vec![S::zero(); n * n],
            row_scale: vec![S::real(0.0); n],
            pivots: vec![0; n * S::LANES],
            moved: vec![false; n],
            structure: Vec::new(),
            pattern: Vec::new(),
        }
    }

    /// Workspace for the Jacobians of a square system.
    pub(crate) fn of_jacobian<E: Evaluate>(system: &E, isa: Isa) -> Self {
        let n = system.variables();
        let mut lu = Lu::new(n, isa);
        if n > SPARSE_ORDER {
            return lu;
        }
        let rows = |j: usize| (0..n).filter(move |&i| !system.vanishes(i, j));
        let filled: usize = (0..n).map(|j| rows(j).count()).sum();
        if (filled as f64) < DENSE_SHARE * (n * n) as f64 {
            lu.structure = (0..n).map(|j| rows(j).fold(0, |mask, i| mask | 1 << i)).collect();
            lu.pattern.clone_from(&lu.structure);
        }
        lu
    }

    /// Factors the column-major matrix `a` (`n * n` entries); `weights_sqr[j]` is the square of the
    /// weight of unknown `j`.
    ///
    /// A singular matrix is not an error: its solutions are not finite.
    pub(crate) fn factor(&mut self, a: &[S], weights_sqr: &[S::Real]) {
        let isa = self.isa;
        if self.structure.is_empty() {
            isa.run(Factor::<S, false> { lu: self, a, weights_sqr });
        } else {
            isa.run(Factor::<S, true> { lu: self, a, weights_sqr });
        }
    }

    /// The smallest pivot of lane `l`, each relative to the largest entry of its row of the matrix
    /// as it was, unknowns measured by the weights it was factored with: below the rounding error
    /// the matrix is singular as far as doubles can tell.
    pub(crate) fn smallest_pivot(&self, l: usize, weights_sqr: &[S::Real]) -> f64 {
        let relative = |k: usize| {
            let inverse = self.factors[k * self.n + k].get(l);
            let size = weights_sqr[k].as_ref()[l] * self.row_scale[k].as_ref()[l] / inverse.norm_sqr();
            if size.is_nan() { 0.0 } else { size }
        };
        (0..self.n).map(relative).fold(1.0, f64::min).sqrt()
    }

    /// Replaces the right-hand side `b` (`n` entries) by the solution.
    pub(crate) fn solve(&self, b: &mut [S]) {
        if self.structure.is_empty() {
            self.isa.run(Solve::<S, false> { lu: self, b });
        } else {
            self.isa.run(Solve::<S, true> { lu: self, b });
        }
    }
}
