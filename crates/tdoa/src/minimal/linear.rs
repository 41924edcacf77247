//! Small dense least squares.

use faer::linalg::solvers::SolveLstsqCore;
use faer::{Conj, Mat};

/// Columns that depend on the others to this relative precision make a problem underdetermined.
const DEPENDENT: f64 = 1e-12;

/// The least-squares solution of `rows` equations `sum_c a(i, c) x_c = b(i)` in `columns` unknowns; `None` if it is not unique or there
/// are fewer equations than unknowns. Columns are scaled to unit length first.
pub(crate) fn least_squares(
    rows: usize,
    columns: usize,
    a: impl Fn(usize, usize) -> f64,
    b: impl Fn(usize) -> f64,
) -> Option<Vec<f64>> {
    if rows < columns {
        return None;
    }
    let scales: Vec<f64> =
        (0..columns).map(|c| (0..rows).map(|i| a(i, c).powi(2)).sum::<f64>().sqrt().max(f64::MIN_POSITIVE)).collect();
    let matrix = Mat::from_fn(rows, columns, |i, c| a(i, c) / scales[c]);
    let mut rhs = Mat::from_fn(rows, 1, |i, _| b(i));
    let qr = matrix.col_piv_qr();
    let r = qr.thin_R();
    let (first, last) = (r[(0, 0)].abs(), r[(columns - 1, columns - 1)].abs());
    if last.is_nan() || last <= DEPENDENT * first {
        return None;
    }
    qr.solve_lstsq_in_place_with_conj(Conj::No, rhs.as_mut());
    let x: Vec<f64> = (0..columns).map(|c| rhs[(c, 0)] / scales[c]).collect();
    x.iter().all(|v| v.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::least_squares;

    #[test]
    fn a_line_through_points() {
        // Normal equations by hand: points (0, 1), (1, 2), (2, 4) give intercept 5/6 and slope 3/2.
        let x = least_squares(3, 2, |i, c| if c == 0 { 1.0 } else { i as f64 }, |i| [1.0, 2.0, 4.0][i]).unwrap();
        assert!((x[0] - 5.0 / 6.0).abs() < 1e-14 && (x[1] - 1.5).abs() < 1e-14);
    }

    #[test]
    fn dependent_columns_and_too_few_rows_are_refused() {
        assert_eq!(least_squares(3, 2, |_, c| c as f64 + 1.0, |_| 1.0), None);
        assert_eq!(least_squares(1, 2, |_, c| c as f64 + 1.0, |_| 1.0), None);
    }
}
