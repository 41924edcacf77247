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

    /// The Cholesky factor, with the diagonal times `grow` plus `floor`; `None` if that matrix is not
    /// positive definite.
    pub(crate) fn cholesky(&self, grow: f64, floor: f64) -> Option<Self> {
        let mut factor = Self::ZERO;
        let mut product = 1.0;
        for k in 0..=D {
            let (row, diagonal) = if k < D { (self.rows[k], self.rows[k][k]) } else { (self.border, self.corner) };
            let mut done = [0.0; D];
            for l in 0..k {
                let known = (0..l).fold(row[l], |rest, a| rest - done[a] * factor.rows[l][a]);
                done[l] = known / factor.rows[l][l];
            }
            let pivot = done[..k].iter().fold(diagonal * grow + floor, |rest, x| rest - x * x);
            if pivot.is_nan() || pivot <= 0.0 {
                return None;
            }
            let root = pivot.sqrt();
            product *= root;
            if k < D {
                done[k] = root;
                factor.rows[k] = done;
            } else {
                (factor.border, factor.corner) = (done, root);
            }
        }
        (1.0 / product).is_finite().then_some(factor)
    }

    /// The inverse of the Cholesky factor, which is lower triangular too; arguments as there.
    #[inline(always)]
    pub(crate) fn inverse_cholesky(&self, grow: f64, floor: f64) -> Option<Self> {
        let factor = self.cholesky(grow, floor)?;
        let mut inverse = Self::ZERO;
        for k in 0..=D {
            let (row, diagonal) =
                if k < D { (factor.rows[k], factor.rows[k][k]) } else { (factor.border, factor.corner) };
            let scale = 1.0 / diagonal;
            let mut done = [0.0; D];
            for l in 0..k {
                done[l] = -(l..k).map(|a| row[a] * inverse.rows[a][l]).sum::<f64>() * scale;
            }
            if k < D {
                done[k] = scale;
                inverse.rows[k] = done;
            } else {
                (inverse.border, inverse.corner) = (done, scale);
            }
        }
        Some(inverse)
    }

    /// Lower triangular times vector.
    pub(crate) fn forward(&self, (position, offset): Placed<D>) -> Placed<D> {
        let row = |k: usize| (0..=k).map(|l| self.rows[k][l] * position[l]).sum();
        (from_fn(row), dot(self.border, position) + self.corner * offset)
    }

    /// Its transpose times vector.
    pub(crate) fn backward(&self, (position, offset): Placed<D>) -> Placed<D> {
        let column = |k: usize| (k..D).map(|l| self.rows[l][k] * position[l]).sum::<f64>() + self.border[k] * offset;
        (from_fn(column), self.corner * offset)
    }

    /// Adds `factor` times the product of a column and a row.
    pub(crate) fn add_product(&mut self, factor: f64, (s, last): &Placed<D>, (t, end): &Placed<D>) {
        for a in 0..D {
            for b in 0..D {
                self.rows[a][b] += factor * s[a] * t[b];
            }
            self.border[a] += factor * last * t[a];
        }
        self.corner += factor * last * end;
    }

    /// Adds another matrix.
    pub(crate) fn add(&mut self, other: &Self) {
        self.rows.iter_mut().flatten().zip(other.rows.iter().flatten()).for_each(|(sum, x)| *sum += x);
        self.border.iter_mut().zip(other.border).for_each(|(sum, x)| *sum += x);
        self.corner += other.corner;
    }

    /// The determinant of a triangular matrix.
    pub(crate) fn determinant(&self) -> f64 {
        (0..D).map(|k| self.rows[k][k]).product::<f64>() * self.corner
    }

    /// With the inverse of a Cholesky factor, the inverse of the matrix times vector.
    pub(crate) fn invert(&self, right: Placed<D>) -> Placed<D> {
        self.backward(self.forward(right))
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
    use crate::points::distance;

    #[test]
    fn the_factor_solves_the_equations() {
        // A' A + I of A = (1 2 3 4; 0 1 -1 2; 2 0 1 1), by hand.
        let matrix = [[6.0, 2.0, 5.0, 6.0], [2.0, 6.0, 5.0, 10.0], [5.0, 5.0, 12.0, 11.0], [6.0, 10.0, 11.0, 22.0]];
        // Above the diagonal nothing counts.
        let rows = from_fn(|k| from_fn(|l| if l > k { f64::NAN } else { matrix[k][l] }));
        let bordered = Bordered { rows, border: [6.0, 10.0, 11.0], corner: 22.0 };
        let wanted = [1.0, -2.0, 0.5, 3.0];
        let right = matrix.map(|row: [f64; 4]| dot(row, wanted));
        let right = ([right[0], right[1], right[2]], right[3]);
        let (position, offset) = bordered.cholesky(1.0, 0.0).unwrap().solve(right);
        let other = bordered.inverse_cholesky(1.0, 0.0).unwrap().invert(right);
        let apart = distance(position, other.0) + (offset - other.1).abs();
        assert!(apart < 1e-13, "{other:?}");
        for (found, wanted) in position.into_iter().chain([offset]).zip(wanted) {
            assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
        }
        // By expansion along the first row.
        let determinant = bordered.cholesky(1.0, 0.0).unwrap().determinant().powi(2);
        assert!((determinant - 704.0).abs() < 1e-10, "{determinant}");
        // The determinant is negative with a smaller corner.
        assert!(Bordered { corner: 10.0, ..bordered }.cholesky(1.0, 0.0).is_none());
        assert!(Bordered { rows: [[-1.0; 3]; 3], ..bordered }.cholesky(1.0, 0.0).is_none());
    }
}
