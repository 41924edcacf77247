//! The adjoint of a factored matrix, and an estimate of the condition.

use super::lu::Lu;
use num_complex::Complex64;
use poly::Lane;

/// Scratch space of estimates of the condition.
#[derive(Debug)]
pub(crate) struct Estimate {
    rows: Vec<[f64; 2]>,
    probe: Vec<Complex64>,
}

impl Estimate {
    /// With room for a matrix of order `n`.
    pub(crate) fn with_capacity(n: usize) -> Self {
        Estimate { rows: Vec::with_capacity(n), probe: Vec::with_capacity(n) }
    }
}

impl Lu<Complex64> {
    /// Takes over a matrix of the same order with its factors: that of lane `l`, whose rows were exchanged in that lane.
    pub(crate) fn take_lane<S: Lane>(&mut self, lanes: &Lu<S>, l: usize) {
        self.factors.iter_mut().zip(&lanes.factors).for_each(|(to, from)| *to = from.get(l));
        for k in 0..self.n {
            self.pivots[k] = lanes.pivots[k * S::LANES + l];
            self.moved[k] = lanes.moved[k] && self.pivots[k] as usize != k;
        }
        self.exchanged = false;
    }

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
