//! Small dense least squares.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::col_pivoting::{factor, solve};
use faer::linalg::qr::no_pivoting::factor::recommended_block_size;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Conj, MatMut, Par};
use smallvec::SmallVec;

/// Columns that depend on the others to this relative precision make a problem underdetermined.
const DEPENDENT: f64 = 1e-12;

/// Solves least-squares problems by orthogonal factors with pivoting; keeps its memory from call to
/// call.
#[derive(Default)]
pub(crate) struct LeastSquares {
    rows: usize,
    columns: usize,
    /// Column-major, and so are the factors that take its place.
    matrix: Vec<f64>,
    rhs: Vec<f64>,
    /// Lengths of the columns.
    scales: Vec<f64>,
    coefficients: Vec<f64>,
    order: [Vec<usize>; 2],
    scratch: Option<MemBuffer>,
}

impl LeastSquares {
    /// Starts a problem: the matrix of zeros, column-major, and the right-hand side, to be filled
    /// in. There are at least as many rows as columns.
    pub(crate) fn start(&mut self, rows: usize, columns: usize) -> (&mut [f64], &mut [f64]) {
        (self.rows, self.columns) = (rows, columns);
        self.matrix.clear();
        self.matrix.resize(rows * columns, 0.0);
        self.rhs.clear();
        self.rhs.resize(rows, 0.0);
        (&mut self.matrix, &mut self.rhs)
    }

    /// Solves it, with columns scaled to unit length; returns the first and the last entry on the
    /// diagonal of the triangular factor, whose quotient is an estimate of the condition.
    pub(crate) fn solve(&mut self) -> (f64, f64) {
        let (rows, columns) = (self.rows, self.columns);
        self.scales.clear();
        for column in self.matrix.chunks_exact_mut(rows) {
            let length = column.iter().map(|a| a * a).sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
            for a in column.iter_mut() {
                *a /= length;
            }
            self.scales.push(length);
        }
        let block = recommended_block_size::<f64>(rows, columns);
        self.coefficients.clear();
        self.coefficients.resize(block * columns, 0.0);
        for order in self.order.iter_mut() {
            order.resize(columns, 0);
        }
        let parameters = Default::default();
        let factoring = factor::qr_in_place_scratch::<usize, f64>(rows, columns, block, Par::Seq, parameters);
        let solving = solve::solve_lstsq_in_place_scratch::<usize, f64>(rows, columns, block, 1, Par::Seq);
        let needed = factoring.or(solving);
        let scratch = self.scratch.get_or_insert_with(|| MemBuffer::new(needed));
        if !MemStack::new(scratch).can_hold(needed) {
            *scratch = MemBuffer::new(needed);
        }

        let mut matrix = MatMut::from_column_major_slice_mut(&mut self.matrix, rows, columns);
        let mut coefficients = MatMut::from_column_major_slice_mut(&mut self.coefficients, block, columns);
        let [forward, backward] = &mut self.order;
        let (_, order) = factor::qr_in_place(
            matrix.rb_mut(),
            coefficients.rb_mut(),
            forward,
            backward,
            Par::Seq,
            MemStack::new(scratch),
            parameters,
        );
        let matrix = matrix.rb();
        let rhs = MatMut::from_column_major_slice_mut(&mut self.rhs, rows, 1);
        let (triangle, stack) = (matrix.get(..columns, ..), MemStack::new(scratch));
        solve::solve_lstsq_in_place_with_conj(
            matrix,
            coefficients.rb(),
            triangle,
            order,
            Conj::No,
            rhs,
            Par::Seq,
            stack,
        );
        for (x, scale) in self.rhs.iter_mut().zip(&self.scales) {
            *x /= scale;
        }
        (matrix[(0, 0)], matrix[(columns - 1, columns - 1)])
    }

    /// The solution, one entry per column.
    pub(crate) fn solution(&self) -> &[f64] {
        &self.rhs[..self.columns]
    }

    /// The least-squares solution of `rows` equations `sum_c a(i, c) x_c = b(i)` in `columns`
    /// unknowns; `None` if it is not unique or there are fewer equations than unknowns.
    pub(crate) fn fit(
        &mut self,
        rows: usize,
        columns: usize,
        a: impl Fn(usize, usize) -> f64,
        b: impl Fn(usize) -> f64,
    ) -> Option<SmallVec<[f64; 6]>> {
        if rows < columns {
            return None;
        }
        let (matrix, rhs) = self.start(rows, columns);
        for (entry, value) in matrix.iter_mut().enumerate() {
            *value = a(entry % rows, entry / rows);
        }
        for (i, value) in rhs.iter_mut().enumerate() {
            *value = b(i);
        }
        let (first, last) = self.solve();
        if last.is_nan() || last.abs() <= DEPENDENT * first.abs() {
            return None;
        }
        let x: SmallVec<[f64; 6]> = SmallVec::from_slice(self.solution());
        x.iter().all(|v| v.is_finite()).then_some(x)
    }
}

#[cfg(test)]
mod tests {
    use super::LeastSquares;

    #[test]
    fn a_line_through_points() {
        let mut squares = LeastSquares::default();
        // Memory of a larger problem does not matter.
        assert!(squares.fit(9, 3, |i, c| (i as f64).powi(c as i32), |i| i as f64).is_some());
        // Normal equations by hand: points (0, 1), (1, 2), (2, 4) give intercept 5/6 and slope 3/2.
        let x = squares.fit(3, 2, |i, c| if c == 0 { 1.0 } else { i as f64 }, |i| [1.0, 2.0, 4.0][i]).unwrap();
        assert!((x[0] - 5.0 / 6.0).abs() < 1e-14 && (x[1] - 1.5).abs() < 1e-14);
    }

    #[test]
    fn dependent_columns_and_too_few_rows_are_refused() {
        let mut squares = LeastSquares::default();
        assert_eq!(squares.fit(3, 2, |_, c| c as f64 + 1.0, |_| 1.0), None);
        assert_eq!(squares.fit(1, 2, |_, c| c as f64 + 1.0, |_| 1.0), None);
    }
}
