//! Gaussian elimination with complete pivoting: ranks, solutions and null spaces of small matrices
//! in many digits.

use super::number::Number;

/// When elimination ends.
#[derive(Clone, Copy, Debug)]
pub(crate) enum PivotLimit {
    /// At pivots of this size (logarithm to base 2) or less.
    Below(f64),
    /// After so many pivots.
    After(usize),
}

/// A matrix after elimination.
pub(crate) struct Elimination<S> {
    /// Rows and columns of the pivots, in their order.
    pub(crate) rows: Vec<usize>,
    pub(crate) columns: Vec<usize>,
    /// The logarithms to base 2 of the pivots, in their order.
    pub(crate) sizes: Vec<f64>,
    /// The least of these logarithms.
    pub(crate) smallest: f64,
    /// The logarithm to base 2 of the largest entry that is left.
    pub(crate) rest: f64,
    /// The factors, by rows.
    factors: Vec<Vec<S>>,
    width: usize,
}

impl<S: Number> Elimination<S> {
    /// Eliminates in a matrix that is given by rows of `width` entries. An entry that is not a number
    /// ends the elimination, with [`rest`](Elimination::rest) not a number.
    pub(crate) fn new(mut matrix: Vec<Vec<S>>, width: usize, stop: PivotLimit) -> Elimination<S> {
        let height = matrix.len();
        let (mut rows, mut columns) = (Vec::new(), Vec::new());
        let (mut free_rows, mut free_columns): (Vec<usize>, Vec<usize>) = ((0..height).collect(), (0..width).collect());
        let (mut sizes, mut rest) = (Vec::new(), f64::NEG_INFINITY);
        loop {
            let mut best = (f64::NEG_INFINITY, 0, 0);
            for (a, &i) in free_rows.iter().enumerate() {
                for (b, &j) in free_columns.iter().enumerate() {
                    let size = matrix[i][j].log2();
                    if size > best.0 || size.is_nan() && !best.0.is_nan() {
                        best = (size, a, b);
                    }
                }
            }
            let (size, a, b) = best;
            let ends = match stop {
                PivotLimit::Below(limit) => size <= limit,
                PivotLimit::After(count) => rows.len() >= count,
            };
            if ends || size == f64::NEG_INFINITY || size.is_nan() {
                rest = if size.is_nan() { f64::NAN } else { size };
                break;
            }
            let (row, column) = (free_rows.swap_remove(a), free_columns.swap_remove(b));
            free_rows.sort_unstable();
            free_columns.sort_unstable();
            sizes.push(size);
            let inverse = S::inv(&matrix[row][column]);
            let pivot_row = matrix[row].clone();
            for &i in &free_rows {
                if matrix[i][column].vanishes() {
                    continue;
                }
                let factor = S::mul(&matrix[i][column], &inverse);
                matrix[i][column] = factor;
                for &j in &free_columns {
                    matrix[i][j] = S::sub_mul(&factor, &pivot_row[j], &matrix[i][j]);
                }
            }
            rows.push(row);
            columns.push(column);
            if free_rows.is_empty() || free_columns.is_empty() {
                break;
            }
        }
        let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
        Elimination { rows, columns, sizes, smallest, rest, factors: matrix, width }
    }

    pub(crate) fn rank(&self) -> usize {
        self.rows.len()
    }

    /// The columns without a pivot.
    pub(crate) fn free(&self) -> Vec<usize> {
        (0..self.width).filter(|j| !self.columns.contains(j)).collect()
    }

    /// The entries of the pivots' columns that solve the pivots' rows for this right-hand side, one
    /// entry per row of the matrix.
    pub(crate) fn solve(&self, side: &[S]) -> Vec<S> {
        let mut x: Vec<S> = self.rows.iter().map(|&i| side[i]).collect();
        for k in 0..x.len() {
            for l in 0..k {
                x[k] = S::sub_mul(&self.factors[self.rows[k]][self.columns[l]], &x[l], &x[k]);
            }
        }
        self.back(&mut x);
        x
    }

    /// Where Newton's method leads from a point with these values of the equations, if the matrix is
    /// their Jacobian; the unknowns without a pivot stay.
    pub(crate) fn newton_step(&self, point: &[S], values: &[S]) -> Vec<S> {
        let mut point = point.to_vec();
        for (&j, d) in self.columns.iter().zip(self.solve(values)) {
            point[j] = S::sub(&point[j], &d);
        }
        point
    }

    /// Solves with the upper triangle.
    fn back(&self, x: &mut [S]) {
        for k in (0..x.len()).rev() {
            let row = &self.factors[self.rows[k]];
            for l in k + 1..x.len() {
                x[k] = S::sub_mul(&row[self.columns[l]], &x[l], &x[k]);
            }
            x[k] = S::div(&x[k], &row[self.columns[k]]);
        }
    }

    /// A basis of the vectors that the pivots' rows map to zero.
    pub(crate) fn null_space(&self) -> Vec<Vec<S>> {
        let vector = |free: usize| {
            let mut x: Vec<S> = self.rows.iter().map(|&i| S::neg(&self.factors[i][free])).collect();
            self.back(&mut x);
            let mut vector = vec![S::zero(); self.width];
            for (&column, x) in self.columns.iter().zip(x) {
                vector[column] = x;
            }
            vector[free] = S::one();
            vector
        };
        self.free().into_iter().map(vector).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Elimination, PivotLimit};
    use num_complex::Complex64;
    use poly::{ComplexMulti, Scalar};
    use proptest::prelude::{prop, prop_assert, proptest};

    type Number = ComplexMulti<4>;

    proptest! {
        /// A product of a tall and a wide matrix of integers has at most their common width as its
        /// rank, and what is left is rounding.
        #[test]
        fn products_have_the_rank_of_their_factors(a in prop::collection::vec(-9i32..9, 18), b in prop::collection::vec(-9i32..9, 15)) {
            let entry = |i: usize, j: usize| (0..3).map(|k| a[3 * i + k] * b[5 * k + j]).sum::<i32>();
            let number = |k: i32| Number::from_c64(Complex64::new(f64::from(k), 0.0));
            let matrix: Vec<Vec<Number>> = (0..6).map(|i| (0..5).map(|j| number(entry(i, j))).collect()).collect();
            let found = Elimination::new(matrix.clone(), 5, PivotLimit::Below(-128.0));
            prop_assert!(found.rank() <= 3 && found.rest < -200.0);
            for vector in found.null_space() {
                for row in &matrix {
                    let sum = row.iter().zip(&vector).fold(Number::zero(), |sum, (a, x)| Number::mul_add(a, x, &sum));
                    prop_assert!(sum.log2() < -180.0);
                }
            }
            // A combination of the columns is found again.
            let side: Vec<Number> = matrix.iter().map(|row| Number::add(&row[0], &row[4])).collect();
            let x = found.solve(&side);
            for (row, s) in matrix.iter().zip(&side) {
                let sum = found.columns.iter().zip(&x).fold(*s, |sum, (&j, x)| Number::sub_mul(&row[j], x, &sum));
                prop_assert!(sum.log2() < -180.0);
            }
        }
    }
}
