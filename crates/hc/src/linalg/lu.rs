//! A factorisation and its workspace.

use poly::simd::Isa;
use poly::{Evaluate, Lane};

/// Share of the largest candidate from which on the diagonal is kept as the pivot.
pub(super) const THRESHOLD: f64 = 0.1;

/// Workspace and result of a factorisation of one `n x n` matrix a lane.
#[derive(Debug)]
pub(crate) struct Lu<S: Lane> {
    pub(super) n: usize,
    pub(super) isa: Isa,
    /// Column-major factors: unit lower triangle below the diagonal, upper triangle above, inverse
    /// pivots on it.
    pub(super) factors: Vec<S>,
    pub(super) row_scale: Vec<S::Real>,
    /// Row exchanged with row `k` in step `k`, for lane `l`: `pivots[k * LANES + l]`.
    pub(super) pivots: Vec<u32>,
    /// Whether any lane exchanges rows in step `k`.
    pub(super) moved: Vec<bool>,
    /// The rows of each column that are not always zero, a bit for each; empty if nothing is known.
    pub(super) structure: Vec<u64>,
    /// The rows of each column of the factors that are not always zero, a bit for each.
    pub(super) pattern: Vec<u64>,
    /// Rows that are exchanged, one pair after the other, before a factorisation in order.
    pub(super) exchanges: Vec<[usize; 2]>,
    /// Whether they were exchanged in the matrix that is factored.
    pub(super) exchanged: bool,
    /// The structure after these exchanges.
    pub(super) ordered: Vec<u64>,
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
            exchanges: Vec::new(),
            exchanged: false,
            ordered: Vec::new(),
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
            lu.ordered.clone_from(&lu.structure);
        }
        lu
    }

    /// Sets the rows that are exchanged before each later [factorisation in order](Self::factor_in_order).
    pub(crate) fn set_exchanges(&mut self, exchanges: &[[usize; 2]]) {
        self.exchanges = exchanges.to_vec();
        self.ordered.clone_from(&self.structure);
        for &[i, k] in exchanges {
            for column in &mut self.ordered {
                let differ = (*column >> i ^ *column >> k) & 1;
                *column ^= differ << i | differ << k;
            }
        }
    }

    /// The smallest pivot of lane `l`, each relative to the largest entry of its row of the matrix
    /// as it was, unknowns measured by the weights it was factored with: below the rounding error
    /// the matrix is singular as far as doubles can tell.
    pub(crate) fn smallest_pivot(&self, l: usize, weights_sqr: &[S::Real]) -> f64 {
        self.smallest(l, weights_sqr, |k| self.row_scale[k].as_ref()[l])
    }

    /// [`smallest_pivot`](Self::smallest_pivot) of the matrix `a`, factored without exchanges of rows.
    pub(crate) fn smallest_pivot_in_order(&self, l: usize, a: &[S], weights_sqr: &[S::Real]) -> f64 {
        let n = self.n;
        let size = |i: usize, j: usize| a[j * n + i].get(l).norm_sqr() * weights_sqr[j].as_ref()[l];
        // The row of `a` that has come to a place.
        let row = |place: usize| {
            self.exchanges.iter().rev().fold(place, |at, &[i, k]| match at {
                _ if at == i => k,
                _ if at == k => i,
                _ => at,
            })
        };
        self.smallest(l, weights_sqr, |i| 1.0 / (0..n).map(|j| size(row(i), j)).fold(0.0, f64::max))
    }

    /// The smallest pivot, with rows multiplied by the square roots of `scale`.
    fn smallest(&self, l: usize, weights_sqr: &[S::Real], scale: impl Fn(usize) -> f64) -> f64 {
        let relative = |k: usize| {
            let inverse = self.factors[k * self.n + k].get(l);
            let size = weights_sqr[k].as_ref()[l] * scale(k) / inverse.norm_sqr();
            if size.is_nan() { 0.0 } else { size }
        };
        (0..self.n).map(relative).fold(1.0, f64::min).sqrt()
    }
}
