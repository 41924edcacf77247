//! Unknowns of clocks eliminated from the normal equations of receivers and clocks.
//!
//! With N_rr the receivers' part, N_cc the clocks' and X = N_cc^-1 N_cr, the receivers have the equations N_rr - N_rc X
//! and, with the covariance P of these, the clocks have N_cc^-1 + X P X^T, and -P X^T with the receivers.

use faer::linalg::solvers::{DenseSolveCore, Llt, Solve};
use faer::{Mat, Side};

/// Share of the entries that is added to the diagonal, so that clocks of which nothing is known have a large variance; of the
/// largest one the square of it.
const RIDGE: f64 = 1e-13;

/// The clocks' part, decomposed.
pub(super) struct EliminatedClocks {
    count: usize,
    factor: Llt<f64>,
    /// A row for each clock's unknown, a column for each free coordinate: how clocks follow receivers, but for the sign.
    follow: Mat<f64>,
    /// What clocks take from the receivers' equations.
    taken: Mat<f64>,
}

impl EliminatedClocks {
    /// Of `count` unknowns, which stand from `first` on, beside these `free` coordinates, from the entries of the normal
    /// equations. `None` where they cannot be decomposed.
    pub(super) fn new(
        count: usize,
        free: &[usize],
        first: usize,
        entry: impl Fn(usize, usize) -> f64,
    ) -> Option<EliminatedClocks> {
        let largest = (0..count).map(|a| entry(first + a, first + a)).fold(0.0, f64::max);
        let own = Mat::from_fn(count, count, |a, b| {
            let entry = entry(first + a, first + b);
            if a == b { entry + RIDGE * (entry + RIDGE * largest) } else { entry }
        });
        let factor = own.llt(Side::Lower).ok()?;
        let mixed = Mat::from_fn(count, free.len(), |a, b| entry(first + a, free[b]));
        let follow = factor.solve(&mixed);
        let taken = mixed.transpose() * &follow;
        Some(EliminatedClocks { count, factor, follow, taken })
    }

    /// What is taken from the equations of two free coordinates.
    pub(super) fn taken(&self, a: usize, b: usize) -> f64 {
        0.5 * (self.taken[(a, b)] + self.taken[(b, a)])
    }

    /// Adds the clocks to a covariance of the receivers, of measurements with deviation `sigma`.
    pub(super) fn extend(&self, covariance: &mut Mat<f64>, free: &[usize], first: usize, sigma: f64) {
        let own = self.factor.inverse();
        let with_receivers = |covariance: &Mat<f64>, clock: usize, a: usize| -> f64 {
            -free.iter().enumerate().map(|(b, &at)| self.follow[(clock, b)] * covariance[(at, a)]).sum::<f64>()
        };
        for clock in 0..self.count {
            for &a in free {
                let between = with_receivers(covariance, clock, a);
                (covariance[(first + clock, a)], covariance[(a, first + clock)]) = (between, between);
            }
        }
        for clock in 0..self.count {
            for other in 0..self.count {
                let followed: f64 = free
                    .iter()
                    .enumerate()
                    .map(|(b, &at)| self.follow[(other, b)] * covariance[(first + clock, at)])
                    .sum();
                covariance[(first + clock, first + other)] = sigma * sigma * own[(clock, other)] - followed;
            }
        }
    }
}
