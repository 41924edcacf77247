//! From a real root of the dual formulation to positions.

use super::chart::COLUMNS;
use crate::minimal::linear::LeastSquares;
use crate::network::Network;

/// `D_i1`, `D_i2` of receiver `i = 2..m` (row `i - 2` of `f`), and `q_i1`.
fn differences(row: &[f64], x: &[f64]) -> [f64; COLUMNS] {
    let q: [f64; COLUMNS] = std::array::from_fn(|j| row[j] * (row[j] - 2.0 * x[j]));
    [q[1] - q[0], q[2] - q[0], q[0]]
}

/// The network of a real root `p1 p2 p3 k l m u v`, `None` unless `H` is positive definite, that is
/// `k > 0` and `m > 0`.
///
/// With the upper triangular `L`, `L'L = H^{-1}`, which is `(1 / sqrt k) (1, l; 0, sqrt(k / m))`:
/// `r_i = L^{-T} D_i'`, `s_1 = L b`, `s_j = s_1 - L e_{j-1} / 2` (paper, equation (5)); the first
/// receiver is the origin. Offsets are relative to the first receiver's measurements:
/// `o_j - f_1j = p_j`. `f` holds `f_ij - f_1j` for `i = 2..m` in rows of `width`.
pub(crate) fn network(f: &[f64], width: usize, x: &[f64]) -> Option<Network> {
    let &[p1, p2, p3, k, l, m, u, v] = x else { return None };
    if !(k > 0.0 && m > 0.0) {
        return None;
    }
    let (root_k, root_m) = (k.sqrt(), m.sqrt());
    let mut receivers = Vec::with_capacity(f.len() / width + 1);
    receivers.push([0.0, 0.0]);
    receivers.extend(f.chunks_exact(width).map(|row| {
        let [d1, d2, _] = differences(row, x);
        [d1 * root_k, (d2 - l * d1) * root_m]
    }));
    let first = [u / root_k, v / root_m];
    // Room for a fourth.
    let (mut transmitters, mut offsets) = (Vec::with_capacity(COLUMNS + 1), Vec::with_capacity(COLUMNS + 1));
    transmitters.extend([
        first,
        [first[0] - 0.5 / root_k, first[1]],
        [first[0] - 0.5 * l / root_k, first[1] - 0.5 / root_m],
    ]);
    offsets.extend([p1, p2, p3]);
    let network = Network::new(receivers, transmitters, offsets);
    network.is_finite().then_some(network)
}

/// Position and offset of the transmitter in column `j` beyond the third, by rank:
/// `f_ij^2 - q_i1 = y D_i1 + z D_i2 + 2 f_ij p_j` over the receivers, and then
/// `s_j = s_1 + y (s_2 - s_1) + z (s_3 - s_1)`.
pub(crate) fn further_transmitter(
    f: &[f64],
    width: usize,
    j: usize,
    x: &[f64],
    network: &Network,
    squares: &mut LeastSquares,
) -> Option<([f64; 2], f64)> {
    let equation = |i: usize| {
        let row = &f[i * width..(i + 1) * width];
        let [d1, d2, q] = differences(row, x);
        [d1, d2, 2.0 * row[j], row[j] * row[j] - q]
    };
    let solution = squares.fit(f.len() / width, 3, |i, c| equation(i)[c], |i| equation(i)[3])?;
    let [s1, s2, s3] = [0, 1, 2].map(|k| network.transmitters[k]);
    let (y, z) = (solution[0], solution[1]);
    Some(([0, 1].map(|k| s1[k] + y * (s2[k] - s1[k]) + z * (s3[k] - s1[k])), solution[2]))
}
