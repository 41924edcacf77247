//! Charts of the 6r/3s equations: the same network seen with another reference transmitter.
//!
//! A path that comes near a far transmitter is hard in one chart and easy in another. The equations keep their form when the columns of
//! the measurements are permuted, so a path continues in another chart with the same family: its start solution is
//! carried over, and its end carried back.

use hc::linalg::Lu;
use hc::poly::Isa;
use num_complex::Complex64;

/// Number of receivers besides the reference.
pub(crate) const ROWS: usize = 5;
/// Number of transmitters.
pub(crate) const COLUMNS: usize = 3;
/// Unknowns `p1 p2 p3 H11 H12 H22 b1 b2`.
pub(crate) const UNKNOWNS: usize = 8;
/// Parameters `f_ij - f_1j`, rows `i = 2..6`.
pub(crate) const PARAMETERS: usize = ROWS * COLUMNS;

/// Orders of the transmitters; the first one listed is the reference.
pub(crate) const CHARTS: [[usize; COLUMNS]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// Parameters with columns in the order of a chart.
pub(crate) fn permute_parameters(f: &[Complex64], chart: &[usize; COLUMNS]) -> Vec<Complex64> {
    (0..ROWS).flat_map(|i| chart.map(|j| f[i * COLUMNS + j])).collect()
}

/// Carries a solution over into a chart: `p` permuted, `H` and `b` from the equations (C), which are linear in them.
///
/// `f` are the parameters in the chart. Not finite where the five equations are dependent.
pub(crate) fn enter(f: &[Complex64], chart: &[usize; COLUMNS], x: &[Complex64]) -> [Complex64; UNKNOWNS] {
    with_linear_part(f, chart.map(|j| x[j]))
}

/// Carries a solution of a chart back into the first one; `f` are the parameters there.
pub(crate) fn leave(f: &[Complex64], chart: &[usize; COLUMNS], x: &[Complex64]) -> [Complex64; UNKNOWNS] {
    let mut p = [Complex64::new(0.0, 0.0); COLUMNS];
    chart.iter().enumerate().for_each(|(k, &j)| p[j] = x[k]);
    with_linear_part(f, p)
}

/// The rows `(q_i1, D_i1, D_i2)`, `q_ij = f_ij (f_ij - 2 p_j)`, `D_ik = q_i,k+1 - q_i1`.
pub(crate) fn compaction(f: &[Complex64], p: &[Complex64; COLUMNS]) -> [[Complex64; 3]; ROWS] {
    std::array::from_fn(|i| {
        let q: [Complex64; COLUMNS] = std::array::from_fn(|j| {
            let f = f[i * COLUMNS + j];
            f * (f - 2.0 * p[j])
        });
        [q[0], q[1] - q[0], q[2] - q[0]]
    })
}

fn with_linear_part(f: &[Complex64], p: [Complex64; COLUMNS]) -> [Complex64; UNKNOWNS] {
    let rows = compaction(f, &p);
    let mut matrix = [Complex64::new(0.0, 0.0); ROWS * ROWS];
    let mut b = [Complex64::new(0.0, 0.0); ROWS];
    for (i, [q, d1, d2]) in rows.iter().enumerate() {
        let row = [d1 * d1, 2.0 * d1 * d2, d2 * d2, -2.0 * d1, -2.0 * d2];
        (0..ROWS).for_each(|j| matrix[j * ROWS + i] = row[j]);
        b[i] = *q;
    }
    let mut lu = Lu::new(ROWS, Isa::Portable);
    lu.factor(&matrix, &[[1.0]; ROWS]);
    lu.solve(&mut b);
    [p[0], p[1], p[2], b[0], b[1], b[2], b[3], b[4]]
}
