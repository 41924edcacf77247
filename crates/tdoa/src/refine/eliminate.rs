//! The inner loop of the Schur complement, in the lanes of a vector unit.

use hc::poly::simd::{Isa, Kernel};
use std::array::from_fn;

/// Subtracts `B^T B` from the lower triangle of a column-major matrix; `B` has D + 1 rows, one after
/// the other.
pub(super) struct Eliminate<'a, const D: usize> {
    pub(super) schur: &'a mut [f64],
    pub(super) rows: &'a [f64],
}

impl<const D: usize> Kernel for Eliminate<'_, D> {
    type Output = ();
    const WIDEST: Isa = Isa::Avx512;

    #[inline(always)]
    fn run(self) {
        let size = self.rows.len() / (D + 1);
        let (positions, last) = self.rows.split_at(D * size);
        for (k, column) in self.schur.chunks_exact_mut(size).enumerate() {
            let (lead, end) = (from_fn::<f64, D, _>(|a| positions[a * size + k]), last[k]);
            // Receivers that have no measurement.
            if end == 0.0 && lead.iter().all(|&x| x == 0.0) {
                continue;
            }
            let column = &mut column[k..];
            let count = column.len();
            let rows: [&[f64]; D] = from_fn(|a| &positions[a * size + k..][..count]);
            for ((l, entry), y) in column.iter_mut().enumerate().zip(&last[k..]) {
                let mut sum = lead[0] * rows[0][l];
                for a in 1..D {
                    sum += lead[a] * rows[a][l];
                }
                *entry -= sum + end * y;
            }
        }
    }
}
