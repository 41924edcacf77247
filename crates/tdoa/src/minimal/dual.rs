//! From a real root of the dual formulation to positions.

use super::chart::{COLUMNS, ROWS};
use crate::network::Network;

/// The network of a real root `p1 p2 p3 k l m u v`, `None` unless `H` is positive definite, that is `k > 0` and `m > 0`.
///
/// With the upper triangular `L`, `L'L = H^{-1}`, which is `(1 / sqrt k) (1, l; 0, sqrt(k / m))`: `r_i = L^{-T} D_i'`, `s_1 = L b`,
/// `s_j = s_1 - L e_{j-1} / 2` (paper, equation (5)); the first receiver is the origin. Offsets are relative to the first
/// receiver's measurements: `o_j - f_1j = p_j`. `f` holds `f_ij - f_1j` for `i = 2..6`, row-major.
pub(crate) fn network(f: &[f64], x: &[f64]) -> Option<Network> {
    let &[p1, p2, p3, k, l, m, u, v] = x else { return None };
    if !(k > 0.0 && m > 0.0) {
        return None;
    }
    let p = [p1, p2, p3];
    let (root_k, root_m) = (k.sqrt(), m.sqrt());
    let mut receivers = vec![[0.0, 0.0]];
    receivers.extend((0..ROWS).map(|i| {
        let q: [f64; COLUMNS] = std::array::from_fn(|j| {
            let f = f[i * COLUMNS + j];
            f * (f - 2.0 * p[j])
        });
        let (d1, d2) = (q[1] - q[0], q[2] - q[0]);
        [d1 * root_k, (d2 - l * d1) * root_m]
    }));
    let first = [u / root_k, v / root_m];
    let transmitters =
        vec![first, [first[0] - 0.5 / root_k, first[1]], [first[0] - 0.5 * l / root_k, first[1] - 0.5 / root_m]];
    let network = Network { receivers, transmitters, offsets: p.to_vec() };
    network.is_finite().then_some(network)
}
