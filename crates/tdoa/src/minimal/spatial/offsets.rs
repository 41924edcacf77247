//! Offsets of five transmitters from nine receivers or more.

use faer::Mat;
use std::array::from_fn;

/// Singular values below this share of the largest are zero: what they belong to is not determined.
pub(super) const DEGENERATE: f64 = 1e-12;

/// Offsets of five transmitters.
pub(super) struct Offsets {
    pub(super) values: [f64; 5],
    /// How far they are from not being determined, 0 to 1: rounding errors grow by one over this.
    pub(super) margin: f64,
}

/// The offsets of measurements about zero and of size one, a row for each receiver; `None` where
/// they are not determined.
pub(super) fn offsets(values: &[[f64; 5]]) -> Option<Offsets> {
    // Columns: lambda_2 to lambda_5, lambda_k o_k, o_1 sum lambda, the common value.
    let entry = |i: usize, column: usize| {
        let row = &values[i];
        match column {
            0..4 => row[column + 1] * row[column + 1] - row[0] * row[0],
            4..8 => -2.0 * row[column - 3],
            8 => 2.0 * row[0],
            _ => -1.0,
        }
    };
    let svd = Mat::from_fn(values.len(), 10, entry).svd().ok()?;
    let unique = svd.S()[8] / svd.S()[0];
    let null: [f64; 10] = from_fn(|column| svd.V()[(column, 9)]);
    let sum = null[..4].iter().sum();
    let lambda: [f64; 5] = [sum, null[0], null[1], null[2], null[3]];
    let products = [null[8], null[4], null[5], null[6], null[7]];
    let largest = lambda.iter().fold(0.0f64, |a, b| a.max(b.abs()));
    // Zero if the other four transmitters lie in one plane.
    let least = lambda.iter().fold(largest, |a, b| a.min(b.abs())) / largest;
    // Written so that NaN is refused.
    let determined = unique > DEGENERATE && least > DEGENERATE;
    determined.then(|| Offsets { values: from_fn(|k| products[k] / lambda[k]), margin: unique * least })
}
