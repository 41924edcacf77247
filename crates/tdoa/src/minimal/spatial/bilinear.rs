//! Positions from squared distances of few receivers and few transmitters.

use super::monomials::{Monomial, Monomials, of_unit_length};
use super::offsets::DEGENERATE;
use super::upgrade::{ENTRIES, Positions, entry, equation, factors, place};
use faer::Mat;
use std::array::from_fn;

/// A symmetric matrix and a vector that are linear in homogeneous coordinates.
struct LinearFamily {
    matrices: Vec<[[f64; 3]; 3]>,
    vectors: Vec<[f64; 3]>,
    /// What the number one is in these coordinates, a factor of the first.
    one: f64,
}

impl LinearFamily {
    /// All with x^T M x + 2 sign x^T v equal to the sides; `None` where these depend on each other.
    fn new(points: &[[f64; 3]], sign: f64, sides: &[f64]) -> Option<LinearFamily> {
        let svd =
            Mat::from_fn(points.len(), 9, |i, column| equation(&points[i].map(|x| -sign * x), column)).svd().ok()?;
        let rank = points.len().min(9);
        // Written so that NaN is refused.
        let determined = svd.S()[rank - 1] > DEGENERATE * svd.S()[0];
        let along =
            |k: usize| sides.iter().enumerate().map(|(i, side)| svd.U()[(i, k)] * side).sum::<f64>() / svd.S()[k];
        let parts: Vec<f64> = (0..rank).map(along).collect();
        let length = parts.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !determined || length.is_nan() || length <= 0.0 {
            return None;
        }
        let particular: [f64; 9] = from_fn(|row| (0..rank).map(|k| svd.V()[(row, k)] * parts[k]).sum::<f64>() / length);
        let others = (rank..9).map(|k| from_fn(|row| svd.V()[(row, k)]));
        let columns: Vec<[f64; 9]> = std::iter::once(particular).chain(others).collect();
        Some(LinearFamily {
            matrices: columns.iter().map(|c| from_fn(|i| from_fn(|j| c[entry(i, j)]))).collect(),
            vectors: columns.iter().map(|c| from_fn(|k| c[6 + k])).collect(),
            one: 1.0 / length,
        })
    }

    fn len(&self) -> usize {
        self.vectors.len()
    }

    /// The number one by the coordinate `k`.
    fn one(&self, k: usize) -> f64 {
        if k == 0 { self.one } else { 0.0 }
    }
}

/// The positions of receivers and transmitters, from their squared distances, receivers in rows of `n`;
/// `None` if they are not real or not determined.
///
/// With the vectors and matrices of [`super::upgrade`], H and b satisfy an equation for each receiver, and
/// G = H^-1 and c = G b one for each transmitter, all linear. What these leave satisfies H G = 1, H c = b,
/// G b = c and b . c = |s_1 - r_1|^2, which are bilinear; multiplied by monomials up to these degrees in
/// either half, they leave a single vector, that of the monomials of the solution.
pub(super) fn positions(squared: &[f64], n: usize, degrees: (usize, usize)) -> Option<Positions> {
    let at = |i: usize, j: usize| squared[i * n + j];
    let m = squared.len() / n;
    let factors = factors(m, n, at)?;
    let of_receivers: Vec<f64> = (1..m).map(|i| at(i, 0) - at(0, 0)).collect();
    let of_transmitters: Vec<f64> = (1..n).map(|j| at(0, j) - at(0, 0)).collect();
    let primal = LinearFamily::new(&factors.u, -1.0, &of_receivers)?;
    let dual = LinearFamily::new(&factors.v, 1.0, &of_transmitters)?;
    let coordinates = common_zero(&equations(&primal, &dual, at(0, 0)), primal.len(), dual.len(), degrees)?;
    let scale = coordinates[0] * primal.one;
    let combined =
        |pick: &dyn Fn(usize) -> f64| coordinates.iter().enumerate().map(|(k, y)| y * pick(k)).sum::<f64>() / scale;
    let unknowns: [f64; 9] = from_fn(|e| match ENTRIES.get(e) {
        Some(&[row, column]) => combined(&|k| primal.matrices[k][row][column]),
        None => combined(&|k| primal.vectors[k][e - 6]),
    });
    place(&unknowns, &factors)
}

/// The bilinear equations, each a matrix in the coordinates of both families.
fn equations(primal: &LinearFamily, dual: &LinearFamily, squared: f64) -> Vec<Mat<f64>> {
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let matrix = |entry: &dyn Fn(usize, usize) -> f64| Mat::from_fn(primal.len(), dual.len(), entry);
    let ones = |i: usize, j: usize| primal.one(i) * dual.one(j);
    let mut all = Vec::with_capacity(16);
    for r in 0..3 {
        for c in 0..3 {
            let unit = if r == c { 1.0 } else { 0.0 };
            // Both matrices are symmetric.
            all.push(matrix(&|i, j| dot(primal.matrices[i][r], dual.matrices[j][c]) - unit * ones(i, j)));
        }
        all.push(matrix(&|i, j| dot(primal.matrices[i][r], dual.vectors[j]) - primal.vectors[i][r] * dual.one(j)));
        all.push(matrix(&|i, j| dot(dual.matrices[j][r], primal.vectors[i]) - dual.vectors[j][r] * primal.one(i)));
    }
    all.push(matrix(&|i, j| dot(primal.vectors[i], dual.vectors[j]) - squared * ones(i, j)));
    all
}

/// The first half of the common zero of bilinear equations in `a` and `b` homogeneous coordinates.
fn common_zero(equations: &[Mat<f64>], a: usize, b: usize, degrees: (usize, usize)) -> Option<Vec<f64>> {
    let [first, second] = [Monomials::new(a, degrees.0), Monomials::new(b, degrees.1)];
    let [less, fewer] = [Monomials::new(a, degrees.0 - 1), Monomials::new(b, degrees.1 - 1)];
    let product = |equation: &Mat<f64>, s: &Monomial, t: &Monomial| {
        let mut row = vec![0.0; first.len() * second.len()];
        for i in 0..a {
            for j in 0..b {
                row[first.place(s, &[i as u8]) * second.len() + second.place(t, &[j as u8])] += equation[(i, j)];
            }
        }
        row
    };
    let mut rows = Vec::new();
    for equation in equations {
        for s in less.all() {
            rows.extend(fewer.all().iter().map(|t| product(equation, s, t)));
        }
    }
    let svd = of_unit_length(rows).svd().ok()?;
    let columns = first.len() * second.len();
    let value = |k: usize, l: usize| svd.V()[(k * second.len() + l, columns - 1)];
    // The largest monomials are the most accurate.
    let size = |l: usize| (0..first.len()).map(|k| value(k, l).powi(2)).sum::<f64>();
    let column = (0..second.len()).max_by(|&k, &l| size(k).total_cmp(&size(l)))?;
    let largest = (0..first.len()).max_by(|&k, &l| value(k, column).abs().total_cmp(&value(l, column).abs()))?;
    let rest = &first.all()[largest][1..];
    Some((0..a).map(|k| value(first.place(rest, &[k as u8]), column)).collect())
}
