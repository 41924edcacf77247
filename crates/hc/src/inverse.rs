//! Inverses of small matrices in double-double, through matrices with rows and columns of equal
//! size.

use poly::{ComplexDd, Scalar};

/// Sizes of the rows of a column-major matrix of order `n`, and of its columns once rows are
/// divided by theirs: the largest entries, one where all are zero.
pub(crate) fn sizes(n: usize, matrix: &[ComplexDd]) -> (Vec<f64>, Vec<f64>) {
    let norm = |entry: usize| matrix[entry].high().norm();
    let largest = |entries: &mut dyn Iterator<Item = f64>| {
        let largest = entries.fold(0.0, f64::max);
        if largest > 0.0 { largest } else { 1.0 }
    };
    let rows: Vec<f64> = (0..n).map(|k| largest(&mut (0..n).map(|j| norm(j * n + k)))).collect();
    let columns = (0..n).map(|j| largest(&mut (0..n).map(|k| norm(j * n + k) / rows[k]))).collect();
    (rows, columns)
}

/// Leaves the inverse of a column-major matrix of order `n`; some of it is not finite if the matrix
/// is singular.
pub(crate) fn invert(n: usize, matrix: &[ComplexDd], inverse: &mut [ComplexDd]) {
    let (rows, columns) = sizes(n, matrix);
    // Powers of two scale without rounding.
    let power = |size: &f64| size.log2().round().exp2().recip();
    let rows: Vec<f64> = rows.iter().map(power).collect();
    let columns: Vec<f64> = columns.iter().map(power).collect();
    let mut scaled: Vec<ComplexDd> = matrix.to_vec();
    for (entry, z) in scaled.iter_mut().enumerate() {
        *z = ComplexDd::scale(&ComplexDd::scale(z, rows[entry % n]), columns[entry / n]);
    }
    eliminate(n, &mut scaled, inverse);
    for (entry, z) in inverse.iter_mut().enumerate() {
        *z = ComplexDd::scale(&ComplexDd::scale(z, columns[entry % n]), rows[entry / n]);
    }
}

/// The inverse by elimination with row pivoting.
fn eliminate(n: usize, matrix: &mut [ComplexDd], inverse: &mut [ComplexDd]) {
    for (entry, z) in inverse.iter_mut().enumerate() {
        *z = if entry / n == entry % n { ComplexDd::one() } else { ComplexDd::zero() };
    }
    for k in 0..n {
        let size = |i: &usize| matrix[k * n + i].high().norm_sqr();
        let pivot = (k..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(k);
        let reciprocal = ComplexDd::inv(&matrix[k * n + pivot]);
        let factors: Vec<ComplexDd> = {
            let column = &mut matrix[k * n..][..n];
            column.swap(k, pivot);
            column.to_vec()
        };
        for column in matrix[(k + 1) * n..].chunks_mut(n).chain(inverse.chunks_mut(n)) {
            column.swap(k, pivot);
            let row = ComplexDd::mul(&column[k], &reciprocal);
            for (i, z) in column.iter_mut().enumerate() {
                *z = if i == k { row } else { ComplexDd::sub_mul(&factors[i], &row, z) };
            }
        }
    }
}

/// The product of a column-major matrix of order `n` with a vector.
pub(crate) fn product(n: usize, matrix: &[ComplexDd], vector: &[ComplexDd]) -> Vec<ComplexDd> {
    let row = |i: usize| vector.iter().enumerate().map(move |(k, z)| (&matrix[k * n + i], z));
    (0..n).map(|i| row(i).fold(ComplexDd::zero(), |sum, (a, z)| ComplexDd::mul_add(a, z, &sum))).collect()
}

#[cfg(test)]
mod tests {
    use super::{invert, product};
    use num_complex::Complex64;
    use poly::{ComplexDd, Scalar};

    #[test]
    fn a_matrix_times_its_inverse_is_one_whatever_its_scales_and_condition() {
        // Columns (1e12, 1) and (1e12, 1 + e): a condition of about 1 / e, beyond doubles, and rows
        // of unequal size.
        let number = |x: f64| ComplexDd::from(Complex64::new(x, 0.0));
        let e = 2f64.powi(-60);
        let sum = Scalar::add(&number(1.0), &number(e));
        let matrix = [number(1e12), number(1.0), number(1e12), sum];
        let mut inverse = vec![ComplexDd::zero(); 4];
        invert(2, &matrix, &mut inverse);
        for (k, column) in matrix.chunks(2).enumerate() {
            for (i, z) in product(2, &inverse, column).into_iter().enumerate() {
                let one = if i == k { 1.0 } else { 0.0 };
                assert!((z.high() - one).norm() < 1e-12, "{i} {k}: {z:?}");
            }
        }
        // The same without `e` has no inverse.
        invert(2, &[matrix[0], matrix[1], matrix[0], matrix[1]], &mut inverse);
        assert!(inverse.iter().any(|z| !z.high().is_finite()), "{inverse:?}");
    }
}
