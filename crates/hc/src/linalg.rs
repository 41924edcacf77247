//! LU factorisation of small complex matrices, one or several at once.
//!
//! Entries that are zero whatever the input are left out, with those that the elimination leaves zero.
//!
//! Threshold pivoting is done lane by lane with implicitly scaled rows (Skeel 1979). The measure of
//! a row is `|a_ik| / max_j |a_ij| w_j`, where `w` are the weights of the unknowns. The row on the
//! diagonal stays if its measure is at least [`THRESHOLD`] of the largest. Lanes therefore never
//! influence each other, and a lane gives bit for bit what the one-lane factorisation gives. Rows
//! are moved only where it matters, because moving them costs time in lanes.

use num_complex::Complex64;
use poly::simd::{Isa, Kernel, across_lanes};
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

/// Scratch space of estimates of the condition.
#[derive(Debug, Default)]
pub(crate) struct Estimate {
    rows: Vec<[f64; 2]>,
    probe: Vec<Complex64>,
}

impl Lu<Complex64> {
    /// Replaces `b` by the solution of the system with the conjugate transpose of the factored
    /// matrix.
    pub(crate) fn solve_adjoint(&self, b: &mut [Complex64]) {
        let n = self.n;
        // A = P L U  =>  A^H = U^H L^H P^T
        for k in 0..n {
            let mut s = b[k];
            for i in 0..k {
                s -= self.factors[k * n + i].conj() * b[i];
            }
            b[k] = s * self.factors[k * n + k].conj();
        }
        for k in (0..n).rev() {
            let mut s = b[k];
            for i in k + 1..n {
                s -= self.factors[k * n + i].conj() * b[i];
            }
            b[k] = s;
        }
        for k in (0..n).rev().filter(|&k| self.moved[k]) {
            b.swap(k, self.pivots[k] as usize);
        }
    }

    /// Estimate of the condition number `|| D A W || * || (D A W)^{-1} ||` in the maximum norm, `W`
    /// the diagonal of the weights and `D` the scaling that gives rows of equal size.
    ///
    /// Hager's estimator (Higham, Accuracy and Stability of Numerical Algorithms, algorithm 15.1);
    /// a lower bound, rarely off by more than a factor 3. Infinite for a singular matrix. `a` is
    /// the matrix that was factored, `weights_sqr` are the squared weights.
    pub(crate) fn condition(&self, a: &[Complex64], weights_sqr: &[[f64; 1]], scratch: &mut Estimate) -> f64 {
        let n = self.n;
        let Estimate { rows, probe: x } = scratch;
        if n == 0 {
            return 1.0;
        }
        // Largest entry and sum of every row.
        rows.clear();
        rows.resize(n, [0.0; 2]);
        for (column, w) in a.chunks_exact(n).zip(weights_sqr) {
            for ([row, sum], z) in rows.iter_mut().zip(column) {
                let size = z.norm_sqr().sqrt() * w[0].sqrt();
                (*row, *sum) = (row.max(size), *sum + size);
            }
        }
        let norm = rows.iter().map(|[row, sum]| sum / row).fold(0.0, f64::max);
        // || B ||_inf = || B^H ||_1 for B = W^{-1} A^{-1} D^{-1}, estimated from products with B^H and B.
        let adjoint = |v: &mut [Complex64]| {
            for (v, w) in v.iter_mut().zip(weights_sqr) {
                *v /= w[0].sqrt();
            }
            self.solve_adjoint(v);
            for (v, r) in v.iter_mut().zip(&*rows) {
                *v *= r[0];
            }
        };
        let direct = |v: &mut [Complex64]| {
            for (v, r) in v.iter_mut().zip(&*rows) {
                *v *= r[0];
            }
            self.solve(v);
            for (v, w) in v.iter_mut().zip(weights_sqr) {
                *v /= w[0].sqrt();
            }
        };
        let length = |z: &Complex64| z.norm_sqr().sqrt();
        x.clear();
        x.resize(n, Complex64::new(1.0 / n as f64, 0.0));
        let mut estimate = 0.0;
        for _ in 0..5 {
            adjoint(x);
            let size: f64 = x.iter().map(length).sum();
            if !size.is_finite() {
                return f64::INFINITY;
            }
            if size <= estimate {
                break;
            }
            estimate = size;
            for z in x.iter_mut() {
                *z = if length(z) > 0.0 { *z / length(z) } else { Complex64::new(1.0, 0.0) };
            }
            direct(x);
            let best = (0..n).max_by(|&i, &j| length(&x[i]).total_cmp(&length(&x[j]))).unwrap_or(0);
            x.fill(Complex64::new(0.0, 0.0));
            x[best] = Complex64::new(1.0, 0.0);
        }
        norm * estimate
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

struct Factor<'a, S: Lane, const SPARSE: bool> {
    lu: &'a mut Lu<S>,
    a: &'a [S],
    weights_sqr: &'a [S::Real],
}

impl<S: Lane, const SPARSE: bool> Kernel for Factor<'_, S, SPARSE> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let Lu { n, factors, row_scale, pivots, moved, structure, pattern, .. } = self.lu;
        let n = *n;
        let f = &mut factors[..n * n];
        f.copy_from_slice(&self.a[..n * n]);

        if SPARSE {
            pattern.copy_from_slice(structure);
        }

        let scale = &mut row_scale[..n];
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

        for k in 0..n {
            let candidates = Rows::<SPARSE>::below(k, n, pattern);
            let pivots = &mut pivots[k * S::LANES..(k + 1) * S::LANES];
            moved[k] = exchange_rows::<S, SPARSE>(n, k, candidates, f, scale, pivots, pattern);
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

struct Solve<'a, S: Lane, const SPARSE: bool> {
    lu: &'a Lu<S>,
    b: &'a mut [S],
}

impl<S: Lane, const SPARSE: bool> Kernel for Solve<'_, S, SPARSE> {
    type Output = ();
    const WIDEST: Isa = S::WIDEST;

    #[inline(always)]
    fn run(self) {
        let n = self.lu.n;
        let f = &self.lu.factors[..n * n];
        let b = &mut self.b[..n];
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
            b[k] = S::mul(&b[k], &f[k * n + k]);
            let bottom = b[k];
            for i in Rows::<SPARSE>::above(k, &self.lu.pattern) {
                across_lanes();
                b[i] = S::sub_mul(&f[k * n + i], &bottom, &b[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Lu;
    use num_complex::Complex64;
    use poly::simd::Isa;
    use poly::{Evaluate, Lane, Lanes8, Scalar};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    fn random(rng: &mut Pcg64) -> Complex64 {
        Complex64::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0))
    }

    fn residual(n: usize, a: &[Complex64], x: &[Complex64], b: &[Complex64]) -> f64 {
        (0..n).map(|i| ((0..n).map(|j| a[j * n + i] * x[j]).sum::<Complex64>() - b[i]).norm()).fold(0.0, f64::max)
    }

    #[test]
    fn solves_and_every_lane_equals_the_one_lane_result() {
        let mut rng = Pcg64::seed_from_u64(1);
        for n in 1..=12 {
            let mut wide = Lu::<Lanes8>::new(n, Isa::detect());
            let mut portable = Lu::<Lanes8>::new(n, Isa::Portable);
            let mut a8 = vec![Lanes8::zero(); n * n];
            let mut b8 = vec![Lanes8::zero(); n];
            let mut w8 = vec![Lanes8::real(1.0); n];
            for l in 0..8 {
                for a in a8.iter_mut() {
                    a.set(l, random(&mut rng));
                }
                for b in b8.iter_mut() {
                    b.set(l, random(&mut rng));
                }
                for w in w8.iter_mut() {
                    w.as_mut()[l] = rng.random_range(0.1..10.0);
                }
            }
            wide.factor(&a8, &w8);
            portable.factor(&a8, &w8);
            let (mut x8, mut y8) = (b8.clone(), b8.clone());
            wide.solve(&mut x8);
            portable.solve(&mut y8);
            assert_eq!(x8, y8);
            for l in 0..8 {
                let a: Vec<_> = a8.iter().map(|a| a.get(l)).collect();
                let b: Vec<_> = b8.iter().map(|b| b.get(l)).collect();
                let w: Vec<_> = w8.iter().map(|w| [w.0[l]]).collect();
                let mut lu = Lu::<Complex64>::new(n, Isa::Portable);
                lu.factor(&a, &w);
                let mut x = b.clone();
                lu.solve(&mut x);
                assert!(residual(n, &a, &x, &b) < 1e-11, "order {n}");
                for j in 0..n {
                    assert_eq!(x[j], x8[j].get(l));
                }
                let mut y = b.clone();
                lu.solve_adjoint(&mut y);
                let adjoint: Vec<_> = (0..n * n).map(|e| a[(e % n) * n + e / n].conj()).collect();
                assert!(residual(n, &adjoint, &y, &b) < 1e-11, "order {n}");
            }
        }
    }

    /// A system whose Jacobian is zero where a mask says so; nothing else of it is used.
    struct Structure(Vec<u64>);

    impl Evaluate for Structure {
        type Memory<S: Scalar> = ();

        fn equations(&self) -> usize {
            self.0.len()
        }
        fn variables(&self) -> usize {
            self.0.len()
        }
        fn parameters(&self) -> usize {
            0
        }
        fn memory<S: Scalar>(&self, _: Isa) {}
        fn values<S: Scalar>(&self, (): &mut (), _: &[S], _: &[S], _: &mut [S]) {}
        fn jacobian<S: Scalar>(&self, (): &mut (), _: &[S], _: &[S], _: &mut [S], _: &mut [S]) {}
        fn taylor<S: Scalar>(&self, (): &mut (), _: usize, _: &[S], _: &[S], _: &mut [S]) {}
        fn vanishes(&self, row: usize, column: usize) -> bool {
            self.0[column] >> row & 1 == 0
        }
    }

    /// Factors without the zeros and with them give the same solutions and pivots, whatever rows are
    /// exchanged.
    #[test]
    fn zeros_left_out_change_nothing() {
        let mut rng = Pcg64::seed_from_u64(2);
        for (n, filled) in [(1, 0.5), (5, 0.4), (8, 0.5), (17, 0.3), (40, 0.1), (64, 0.1)] {
            for _ in 0..20 {
                // A permutation of the diagonal makes the matrix regular.
                let shift = rng.random_range(0..n);
                let column = |rng: &mut Pcg64, j: usize| {
                    (0..n).fold(1u64 << ((j + shift) % n), |m, i| m | u64::from(rng.random_bool(filled)) << i)
                };
                let structure = Structure((0..n).map(|j| column(&mut rng, j)).collect());
                let mut a = vec![Lanes8::zero(); n * n];
                for (e, a) in a.iter_mut().enumerate().filter(|(e, _)| !structure.vanishes(e % n, e / n)) {
                    let size = if rng.random_bool(0.3) || (e / n + shift) % n == e % n { 1.0 } else { 1e-3 };
                    (0..8).for_each(|l| a.set(l, random(&mut rng) * size));
                }
                let mut b = vec![Lanes8::zero(); n];
                b.iter_mut().for_each(|b| (0..8).for_each(|l| b.set(l, random(&mut rng))));
                let weights = vec![Lanes8::real(1.0); n];
                let [mut sparse, mut dense] = [Lu::of_jacobian(&structure, Isa::detect()), Lu::new(n, Isa::detect())];
                assert!(n < 5 || !sparse.structure.is_empty());
                let [mut x, mut y] = [b.clone(), b];
                for _ in 0..2 {
                    sparse.factor(&a, &weights);
                    dense.factor(&a, &weights);
                    sparse.solve(&mut x);
                    dense.solve(&mut y);
                    assert_eq!(x, y, "order {n}");
                    assert_eq!((&sparse.moved, &sparse.row_scale), (&dense.moved, &dense.row_scale));
                }
            }
        }
    }

    #[test]
    fn badly_scaled_rows_do_not_spoil_the_pivots() {
        // Without scaling, the first row would give the pivot 1e10 and lose all of (1, 1).
        let a = [1e10, 1.0, 1e20, 1.0].map(|v| Complex64::new(v, 0.0));
        let mut lu = Lu::new(2, Isa::Portable);
        lu.factor(&a, &[[1.0], [1.0]]);
        let mut x = [1e20 + 1e10, 2.0].map(|v| Complex64::new(v, 0.0));
        lu.solve(&mut x);
        assert!(x.iter().all(|z| (z - 1.0).norm() < 1e-9), "{x:?}");
    }

    #[test]
    fn smallest_pivots_of_known_matrices() {
        let mut lu = Lu::<Complex64>::new(3, Isa::Portable);
        let mut pivot = |a: [f64; 9], weights_sqr: &[[f64; 1]]| {
            lu.factor(&a.map(|v| Complex64::new(v, 0.0)), weights_sqr);
            lu.smallest_pivot(0, weights_sqr)
        };
        let ones = [[1.0]; 3];
        // A permutation, rows of different sizes: both are scaled away.
        assert_eq!(pivot([0.0, 0.0, 3.0, 1e9, 0.0, 0.0, 0.0, 1e-9, 0.0], &ones), 1.0);
        // Columns (1, 0, 0), (0, 1, 0), (0, 1, e): rank two but for e, measured against the 1 of
        // the row's scale.
        assert!((pivot([1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1e-30], &ones) / 1e-30 - 1.0).abs() < 1e-12);
        assert_eq!(pivot([1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0], &ones), 0.0);
        // An unknown on a scale of 1e-30 is as good as any other.
        assert!((pivot([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1e30], &[[1.0], [1.0], [1e-60]]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn condition_of_known_matrices() {
        let identity = [1.0, 0.0, 0.0, 1.0].map(|v| Complex64::new(v, 0.0));
        let (mut lu, mut scratch) = (Lu::new(2, Isa::Portable), super::Estimate::default());
        lu.factor(&identity, &[[1.0], [1.0]]);
        assert_eq!(lu.condition(&identity, &[[1.0]; 2], &mut scratch), 1.0);
        // [[1, 1], [1, 1 + e]] has condition (2 + e)^2 / e in the maximum norm (nearly unchanged by
        // row scaling).
        let e = 1e-6;
        let near = [1.0, 1.0, 1.0, 1.0 + e].map(|v| Complex64::new(v, 0.0));
        lu.factor(&near, &[[1.0], [1.0]]);
        let condition = lu.condition(&near, &[[1.0]; 2], &mut scratch);
        assert!((condition * e / 4.0 - 1.0).abs() < 1e-4, "{condition}");
        let singular = [1.0, 1.0, 1.0, 1.0].map(|v| Complex64::new(v, 0.0));
        lu.factor(&singular, &[[1.0], [1.0]]);
        assert_eq!(lu.condition(&singular, &[[1.0]; 2], &mut scratch), f64::INFINITY);
    }
}
