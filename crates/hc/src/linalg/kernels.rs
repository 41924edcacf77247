//! The kernels: factorisation with threshold pivoting lane by lane, and solution.

use super::lu::{Lu, THRESHOLD};
use poly::Lane;
use poly::simd::{Isa, Kernel, across_lanes};

impl<S: Lane> Lu<S> {
    /// Factors the column-major matrix `a` (`n * n` entries); `weights_sqr[j]` is the square of the
    /// weight of unknown `j`.
    ///
    /// A singular matrix is not an error: its solutions are not finite.
    pub(crate) fn factor(&mut self, a: &[S], weights_sqr: &[S::Real]) {
        let isa = self.isa;
        if self.structure.is_empty() {
            isa.run(Factor::<S, false, true> { lu: self, a, weights_sqr });
        } else {
            isa.run(Factor::<S, true, true> { lu: self, a, weights_sqr });
        }
    }

    /// Where to write the column-major matrix for [`factor_in_order`](Self::factor_in_order).
    pub(crate) fn matrix(&mut self) -> &mut [S] {
        &mut self.factors
    }

    /// Factors the [matrix](Self::matrix) in place, with no other [exchanges](Self::set_exchanges) of rows than in all
    /// lanes, whatever the pivots: for those who judge the solutions.
    pub(crate) fn factor_in_order(&mut self) {
        let isa = self.isa;
        if self.structure.is_empty() {
            isa.run(Factor::<S, false, false> { lu: self, a: &[], weights_sqr: &[] });
        } else {
            isa.run(Factor::<S, true, false> { lu: self, a: &[], weights_sqr: &[] });
        }
    }

    /// Replaces the right-hand side `b` (`n` entries) by the solution.
    pub(crate) fn solve(&self, b: &mut [S]) {
        if self.structure.is_empty() {
            self.isa.run(Solve::<S, false, false> { lu: self, b });
        } else {
            self.isa.run(Solve::<S, true, false> { lu: self, b });
        }
    }

    /// Replaces the right-hand side `b` by the solution with its sign changed.
    pub(crate) fn solve_negated(&self, b: &mut [S]) {
        if self.structure.is_empty() {
            self.isa.run(Solve::<S, false, true> { lu: self, b });
        } else {
            self.isa.run(Solve::<S, true, true> { lu: self, b });
        }
    }
}

/// Rows of a column: all of a range, or those with a bit in a mask.
#[derive(Clone, Copy)]
struct Rows<const SPARSE: bool> {
    mask: u64,
    next: usize,
    end: usize,
}

impl<const SPARSE: bool> Rows<SPARSE> {
    /// The rows below `k` of `n`.
    #[inline(always)]
    fn below(k: usize, n: usize, pattern: &[u64]) -> Self {
        let mask = if SPARSE { pattern[k] & !(u64::MAX >> (63 - k)) } else { 0 };
        Rows { mask, next: k + 1, end: n }
    }

    /// The rows above `k`.
    #[inline(always)]
    fn above(k: usize, pattern: &[u64]) -> Self {
        Rows { mask: if SPARSE { pattern[k] & ((1 << k) - 1) } else { 0 }, next: 0, end: k }
    }
}

impl<const SPARSE: bool> Iterator for Rows<SPARSE> {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let row = if SPARSE { self.mask.trailing_zeros() as usize } else { self.next };
        if row >= self.end {
            return None;
        }
        self.mask &= self.mask.wrapping_sub(1);
        self.next = row + 1;
        Some(row)
    }
}

/// Factors the column-major matrix `a` with exchanges of rows in each lane, or the one in place of the factors without.
struct Factor<'a, S: Lane, const SPARSE: bool, const EXCHANGE: bool> {
    lu: &'a mut Lu<S>,
    a: &'a [S],
    weights_sqr: &'a [S::Real],
}

impl<S: Lane, const SPARSE: bool, const EXCHANGE: bool> Kernel for Factor<'_, S, SPARSE, EXCHANGE> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let Lu { n, factors, row_scale, pivots, moved, structure, pattern, exchanges, exchanged, ordered, .. } =
            self.lu;
        let n = *n;
        let f = &mut factors[..n * n];
        if EXCHANGE {
            f.copy_from_slice(&self.a[..n * n]);
        }

        if SPARSE {
            pattern.copy_from_slice(if EXCHANGE { structure } else { ordered });
        }
        *exchanged = !EXCHANGE && !exchanges.is_empty();
        if *exchanged {
            for column in f.chunks_exact_mut(n) {
                exchanges.iter().for_each(|&[i, k]| column.swap(i, k));
            }
        }

        let scale = &mut row_scale[..n];
        if EXCHANGE {
            for i in 0..n {
                let mut largest = S::real(0.0);
                for j in 0..n {
                    if SPARSE && pattern[j] >> i & 1 == 0 {
                        continue;
                    }
                    across_lanes();
                    largest = S::real_max(&S::real_mul(&f[j * n + i].norm_sqr(), &self.weights_sqr[j]), &largest);
                }
                scale[i] = reciprocal::<S>(&largest);
            }
        }

        for k in 0..n {
            let candidates = Rows::<SPARSE>::below(k, n, pattern);
            let pivots = &mut pivots[k * S::LANES..(k + 1) * S::LANES];
            moved[k] = EXCHANGE && exchange_rows::<S, SPARSE>(n, k, candidates, f, scale, pivots, pattern);
            let below = Rows::<SPARSE>::below(k, n, pattern);
            let inverse = S::inv(&f[k * n + k]);
            f[k * n + k] = inverse;
            for i in below {
                across_lanes();
                f[k * n + i] = S::mul(&f[k * n + i], &inverse);
            }
            for j in k + 1..n {
                if SPARSE {
                    if pattern[j] >> k & 1 == 0 {
                        continue;
                    }
                    pattern[j] |= below.mask;
                }
                let (left, right) = f.split_at_mut(j * n);
                let pivot_column = &left[k * n..(k + 1) * n];
                let column = &mut right[..n];
                let top = column[k];
                for i in below {
                    across_lanes();
                    column[i] = S::sub_mul(&pivot_column[i], &top, &column[i]);
                }
            }
        }
    }
}

/// Finds the pivot row of column `k` in every lane, among `candidates`, and exchanges it with row `k` where
/// the diagonal is too small.
#[inline(always)]
fn exchange_rows<S: Lane, const SPARSE: bool>(
    n: usize,
    k: usize,
    candidates: Rows<SPARSE>,
    f: &mut [S],
    scale: &mut [S::Real],
    pivots: &mut [u32],
    pattern: &mut [u64],
) -> bool {
    let diagonal = S::real_mul(&f[k * n + k].norm_sqr(), &scale[k]);
    let (mut best, mut row) = (diagonal, S::real(k as f64));
    for i in candidates {
        let score = S::real_mul(&f[k * n + i].norm_sqr(), &scale[i]);
        row = S::real_where_less(&best, &score, &S::real(i as f64), &row);
        best = S::real_max(&score, &best);
    }
    let limit = S::real_mul(&best, &S::real(THRESHOLD * THRESHOLD));
    // The row to exchange with; -1 where the diagonal stays.
    let row = S::real_where_less(&diagonal, &limit, &row, &S::real(-1.0));
    let mut moved = false;
    for i in candidates {
        if !S::any_equal(&row, i as f64) {
            continue;
        }
        moved = true;
        for j in 0..n {
            if SPARSE {
                // Other lanes may keep the rows where they are.
                let either = (pattern[j] >> k | pattern[j] >> i) & 1;
                if either == 0 {
                    continue;
                }
                pattern[j] |= 1 << k | 1 << i;
            }
            let (upper, lower) = (f[j * n + k], f[j * n + i]);
            f[j * n + k] = S::select_equal(&upper, &lower, &row, i as f64);
            f[j * n + i] = S::select_equal(&lower, &upper, &row, i as f64);
        }
        // Their scales go with them.
        let (upper, lower) = (scale[k], scale[i]);
        for l in 0..S::LANES {
            if row.as_ref()[l] == i as f64 {
                scale[i].as_mut()[l] = upper.as_ref()[l];
                scale[k].as_mut()[l] = lower.as_ref()[l];
            }
        }
    }
    if moved {
        for l in 0..S::LANES {
            let row = row.as_ref()[l];
            pivots[l] = if row < 0.0 { k as u32 } else { row as u32 };
        }
    }
    moved
}

#[inline(always)]
fn reciprocal<S: Lane>(a: &S::Real) -> S::Real {
    let mut out = *a;
    for l in 0..S::LANES {
        out.as_mut()[l] = 1.0 / a.as_ref()[l];
    }
    out
}

/// Replaces `b` by the solution, with its sign changed or not.
struct Solve<'a, S: Lane, const SPARSE: bool, const NEGATED: bool> {
    lu: &'a Lu<S>,
    b: &'a mut [S],
}

impl<S: Lane, const SPARSE: bool, const NEGATED: bool> Kernel for Solve<'_, S, SPARSE, NEGATED> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let n = self.lu.n;
        let f = &self.lu.factors[..n * n];
        let b = &mut self.b[..n];
        if self.lu.exchanged {
            self.lu.exchanges.iter().for_each(|&[i, k]| b.swap(i, k));
        }
        for k in (0..n).filter(|&k| self.lu.moved[k]) {
            for l in 0..S::LANES {
                let i = self.lu.pivots[k * S::LANES + l] as usize;
                if i != k {
                    let (upper, lower) = (b[k].get(l), b[i].get(l));
                    b[k].set(l, lower);
                    b[i].set(l, upper);
                }
            }
        }
        for k in 0..n {
            let top = b[k];
            for i in Rows::<SPARSE>::below(k, n, &self.lu.pattern) {
                across_lanes();
                b[i] = S::sub_mul(&f[k * n + i], &top, &b[i]);
            }
        }
        for k in (0..n).rev() {
            let bottom = S::mul(&b[k], &f[k * n + k]);
            b[k] = if NEGATED { S::neg(&bottom) } else { bottom };
            for i in Rows::<SPARSE>::above(k, &self.lu.pattern) {
                across_lanes();
                b[i] = S::sub_mul(&f[k * n + i], &bottom, &b[i]);
            }
        }
    }
}
