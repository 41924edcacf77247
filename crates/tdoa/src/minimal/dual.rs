//! From a real root of the dual formulation to positions.

use super::chart::{COLUMNS, ROWS, compaction};
use crate::network::Network;
use num_complex::Complex64;

/// The network of a real root `p1 p2 p3 H11 H12 H22 b1 b2` with positive definite `H`, `None` if `H` is not.
///
/// With the upper triangular `L`, `L'L = H^{-1}`: `r_i = L^{-T} D_i'`, `s_1 = L b`, `s_j = s_1 - L e_{j-1} / 2` (paper,
/// equation (5)); the first receiver is the origin. Offsets are relative to the first receiver: `o_j - f_1j = p_j`.
pub(crate) fn network(f: &[f64], x: &[f64]) -> Option<Network> {
    let &[p1, p2, p3, h11, h12, h22, b1, b2] = x else { return None };
    let det = h11 * h22 - h12 * h12;
    if !(h11 > 0.0 && h22 > 0.0 && det > 0.0) {
        return None;
    }
    // G = H^{-1} = L'L
    let g = [h22 / det, -h12 / det, h11 / det];
    let l11 = g[0].sqrt();
    let l12 = g[1] / l11;
    // g22 - l12^2 = 1 / h22, without the cancellation.
    let l22 = (1.0 / h22).sqrt();
    let complex_f: Vec<Complex64> = f.iter().map(|&f| f.into()).collect();
    let rows = compaction(&complex_f, &[p1.into(), p2.into(), p3.into()]);
    let mut receivers = vec![[0.0, 0.0]];
    receivers.extend(rows[..ROWS].iter().map(|[_, d1, d2]| {
        let x = d1.re / l11;
        [x, (d2.re - l12 * x) / l22]
    }));
    let first = [l11 * b1 + l12 * b2, l22 * b2];
    let transmitters = vec![first, [first[0] - 0.5 * l11, first[1]], [first[0] - 0.5 * l12, first[1] - 0.5 * l22]];
    let network = Network { receivers, transmitters, offsets: vec![p1, p2, p3] };
    debug_assert_eq!(network.transmitters.len(), COLUMNS);
    network.is_finite().then_some(network)
}
