//! Symmetric matrices for a node's position and its offset, D + 1 rows, and their Cholesky factors.

use std::array::from_fn;

use crate::points::dot;

/// A position, or what belongs to one, and an offset.
pub(crate) type Placed<const D: usize> = ([f64; D], f64);

/// The lower triangle of a symmetric matrix of D + 1 rows, or a lower triangular matrix.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bordered<const D: usize> {
    /// Rows of the position; what is above the diagonal does not count.
    pub(crate) rows: [[f64; D]; D],
    /// The last row, of the offset, without its last entry.
    pub(crate) border: [f64; D],
    /// The last entry.
    pub(crate) corner: f64,
}

impl<const D: usize> Bordered<D> {
    pub(crate) const ZERO: Self = Bordered { rows: [[0.0; D]; D], border: [0.0; D], corner: 0.0 };

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    pub(crate) fn cholesky(&self) -> Option<Self> {
        let mut factor = Self::ZERO;
        for k in 0..=D {
            let row = if k < D { self.rows[k] } else { self.border };
            let mut done = [0.0; D];
            for l in 0..k {
                let known = (0..l).fold(row[l], |rest, a| rest - done[a] * factor.rows[l][a]);
                done[l] = known / factor.rows[l][l];
            }
            let diagonal = if k < D { row[k] } else { self.corner };
            let pivot = done[..k].iter().fold(diagonal, |rest, x| rest - x * x);
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            if k < D {
                done[k] = pivot.sqrt();
                factor.rows[k] = done;
            } else {
                (factor.border, factor.corner) = (done, pivot.sqrt());
            }
        }
        Some(factor)
    }

    /// Solves with this Cholesky factor.
    pub(crate) fn solve(&self, (position, offset): Placed<D>) -> Placed<D> {
        let mut x = position;
        for k in 0..D {
            x[k] = (0..k).fold(x[k], |rest, l| rest - self.rows[k][l] * x[l]) / self.rows[k][k];
        }
        let last = (offset - dot(self.border, x)) / (self.corner * self.corner);
        x = from_fn(|k| x[k] - self.border[k] * last);
        for k in (0..D).rev() {
            x[k] = (k + 1..D).fold(x[k], |rest, l| rest - self.rows[l][k] * x[l]) / self.rows[k][k];
        }
        (x, last)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_factor_solves_the_equations() {
        // A' A + I of A = (1 2 3 4; 0 1 -1 2; 2 0 1 1), by hand.
        let matrix = [[6.0, 2.0, 5.0, 6.0], [2.0, 6.0, 5.0, 10.0], [5.0, 5.0, 12.0, 11.0], [6.0, 10.0, 11.0, 22.0]];
        // Above the diagonal nothing counts.
        let rows = from_fn(|k| from_fn(|l| if l > k { f64::NAN } else { matrix[k][l] }));
        let bordered = Bordered { rows, border: [6.0, 10.0, 11.0], corner: 22.0 };
        let wanted = [1.0, -2.0, 0.5, 3.0];
        let right = matrix.map(|row: [f64; 4]| dot(row, wanted));
        let (position, offset) = bordered.cholesky().unwrap().solve(([right[0], right[1], right[2]], right[3]));
        for (found, wanted) in position.into_iter().chain([offset]).zip(wanted) {
            assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
        }
        // The determinant is negative with a smaller corner.
        assert!(Bordered { corner: 10.0, ..bordered }.cholesky().is_none());
        assert!(Bordered { rows: [[-1.0; 3]; 3], ..bordered }.cholesky().is_none());
    }
}
