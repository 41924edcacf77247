//! Positions from squared distances of known offsets.

use super::offsets::DEGENERATE;
use super::polynomial::{Polynomial, common_root};
use crate::minimal::error::MinimalError;
use faer::{Mat, Side};
use std::array::from_fn;

/// Rows and columns of the six entries of a symmetric matrix.
pub(super) const ENTRIES: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [0, 2], [1, 2]];

/// The place of an entry in [`ENTRIES`].
pub(super) fn entry(row: usize, column: usize) -> usize {
    if row == column { row } else { row + column + 2 }
}

/// Positions of all nodes, the first receiver at the origin.
pub(super) struct Positions {
    pub(super) receivers: Vec<[f64; 3]>,
    pub(super) transmitters: Vec<[f64; 3]>,
}

/// Vectors u_i for all receivers but the first, and v_j for all transmitters but the first, with
/// u_i . v_j = (r_i - r_1) . (s_j - s_1).
pub(super) struct Factors {
    pub(super) u: Vec<[f64; 3]>,
    pub(super) v: Vec<[f64; 3]>,
}

/// The positions, from the squared distances of at least nine
/// receivers, a row each, to five transmitters.
///
/// The differences r_i - r_1 and s_j - s_1 are u_i and v_j up to a matrix A: r_i - r_1 = A u_i and
/// s_j - s_1 = A^-T v_j. With H = A^T A and b = A^T (s_1 - r_1), the squared distances to the first
/// transmitter give u_i^T H u_i - 2 u_i^T b.
pub(super) fn positions(squared: &[[f64; 5]]) -> Result<Positions, MinimalError> {
    let factors = factors(squared.len(), 5, |i, j| squared[i][j]).ok_or(MinimalError::SpecialPosition)?;
    let unknowns = gram(squared, &factors).ok_or(MinimalError::SpecialPosition)?;
    place(&unknowns, &factors).ok_or(MinimalError::NoNetwork)
}

/// Positions by the entries of H and b; `None` unless they are real.
pub(super) fn place(unknowns: &[f64; 9], factors: &Factors) -> Option<Positions> {
    let h = Mat::from_fn(3, 3, |row, column| unknowns[entry(row, column)]);
    // H is not positive definite where the measurements are not those of a network.
    let factor = h.llt(Side::Lower).ok()?;
    let l = factor.L();
    // H = L L^T, and A = L^T.
    let receiver = |u: &[f64; 3]| from_fn(|k| (k..3).map(|a| l[(a, k)] * u[a]).sum::<f64>());
    let dual = |w: [f64; 3]| {
        let x = w[0] / l[(0, 0)];
        let y = (w[1] - l[(1, 0)] * x) / l[(1, 1)];
        [x, y, (w[2] - l[(2, 0)] * x - l[(2, 1)] * y) / l[(2, 2)]]
    };
    let b = [unknowns[6], unknowns[7], unknowns[8]];
    let transmitter = |v: &[f64; 3]| dual(from_fn(|k| b[k] + v[k]));
    let receivers = std::iter::once([0.0; 3]).chain(factors.u.iter().map(receiver)).collect();
    let transmitters = std::iter::once(dual(b)).chain(factors.v.iter().map(transmitter)).collect();
    Some(Positions { receivers, transmitters })
}

/// The factors of the squared distances of `m` receivers to `n` transmitters; `None` if they lie in a
/// plane.
pub(super) fn factors(m: usize, n: usize, squared: impl Fn(usize, usize) -> f64) -> Option<Factors> {
    let product =
        |i: usize, j: usize| -0.5 * (squared(i + 1, j + 1) - squared(0, j + 1) - squared(i + 1, 0) + squared(0, 0));
    let svd = Mat::from_fn(m - 1, n - 1, product).svd().ok()?;
    // Written so that NaN is refused.
    let spans_space = svd.S()[2] > DEGENERATE * svd.S()[0];
    let roots: [f64; 3] = from_fn(|k| svd.S()[k].sqrt());
    spans_space.then(|| Factors {
        u: (0..m - 1).map(|i| from_fn(|k| roots[k] * svd.U()[(i, k)])).collect(),
        v: (0..n - 1).map(|j| from_fn(|k| roots[k] * svd.V()[(j, k)])).collect(),
    })
}

/// The coefficients of u^T H u - 2 u^T b in the entries of H and b.
pub(super) fn equation(u: &[f64; 3], column: usize) -> f64 {
    match ENTRIES.get(column) {
        Some(&[row, column]) => (if row == column { 1.0 } else { 2.0 }) * u[row] * u[column],
        None => -2.0 * u[column - 6],
    }
}

/// The entries of H and b. Eight equations leave a line, on which the squared distances of the first
/// receiver decide. `None` where they are not determined.
fn gram(squared: &[[f64; 5]], Factors { u, v }: &Factors) -> Option<[f64; 9]> {
    let svd = Mat::from_fn(u.len(), 9, |i, column| equation(&u[i], column)).svd().ok()?;
    let rank = u.len().min(9);
    let determined = svd.S()[rank - 1] > DEGENERATE * svd.S()[0];
    if !determined {
        return None;
    }
    let mut solution = [0.0; 9];
    for k in 0..rank {
        let side = squared[1..].iter().map(|row| row[0] - squared[0][0]);
        let along = side.enumerate().map(|(i, side)| svd.U()[(i, k)] * side).sum::<f64>() / svd.S()[k];
        solution.iter_mut().enumerate().for_each(|(column, x)| *x += along * svd.V()[(column, k)]);
    }
    if rank < 9 {
        let direction: [f64; 9] = from_fn(|column| svd.V()[(column, 8)]);
        let t = common_root(&conditions(&solution, &direction, v, &squared[0]))?;
        solution.iter_mut().zip(direction).for_each(|(x, d)| *x += t * d);
    }
    Some(solution)
}

/// What vanishes where |s_j - r_1| has the squares `first`: for j = 1 the quartic
/// b^T adj(H) b - first_1 det H, for the others the cubics
/// v_j^T adj(H) (v_j + 2 b) - (first_j - first_1) det H.
fn conditions(solution: &[f64; 9], direction: &[f64; 9], v: &[[f64; 3]], first: &[f64; 5]) -> [Polynomial; 5] {
    let line = |k: usize| Polynomial::line(solution[k], direction[k]);
    let h = |row: usize, column: usize| line(entry(row % 3, column % 3));
    // Cyclic minors have their signs.
    let cofactor = |row: usize, column: usize| {
        let product = h(row + 1, column + 1).times(&h(row + 2, column + 2));
        product.plus(-1.0, &h(row + 1, column + 2).times(&h(row + 2, column + 1)))
    };
    let adjugate: [[Polynomial; 3]; 3] = from_fn(|row| from_fn(|column| cofactor(row, column)));
    let determinant = (0..3).fold(Polynomial::ZERO, |sum, k| sum.plus(1.0, &h(0, k).times(&adjugate[0][k])));
    let form = |left: &[Polynomial; 3], right: &[Polynomial; 3]| {
        let term = |k: usize| left[k / 3].times(&adjugate[k / 3][k % 3]).times(&right[k % 3]);
        (0..9).fold(Polynomial::ZERO, |sum, k| sum.plus(1.0, &term(k)))
    };
    let b: [Polynomial; 3] = from_fn(|k| line(6 + k));
    from_fn(|j| match j.checked_sub(1).map(|j| v[j].map(|x| Polynomial::line(x, 0.0))) {
        None => form(&b, &b).plus(-first[0], &determinant),
        Some(v) => form(&v, &from_fn(|k| v[k].plus(2.0, &b[k]))).plus(first[0] - first[j], &determinant),
    })
}
