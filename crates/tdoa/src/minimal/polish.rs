//! Gauss-Newton in the primal coordinates: the last digits of a candidate, and its condition.

use crate::network::Network;
use faer::linalg::solvers::SolveLstsqCore;
use faer::{Conj, Mat};

/// Iterations at most; candidates come with about ten digits and gain the rest in two.
const MAX_ITERATIONS: usize = 8;

/// Moves the network to the least-squares solution of `|r_i - s_j| = +-(f_ij - o_j)`, signs as they are at the start, and returns
/// the condition number of that problem (columns of unit length, the three rigid motions excluded).
///
/// `f` is row-major, receivers in rows. The network stays as it is where a step would not bring it nearer.
pub(crate) fn polish(f: &[f64], network: &mut Network) -> f64 {
    let (m, n) = (network.receivers.len(), network.transmitters.len());
    let signs: Vec<f64> = (0..m * n).map(|k| if f[k] < network.offsets[k % n] { -1.0 } else { 1.0 }).collect();
    let mut residual = norm(&residuals(f, &signs, network));
    let mut condition = f64::INFINITY;
    for _ in 0..MAX_ITERATIONS {
        let (jacobian, scales) = jacobian(&signs, network);
        let values = residuals(f, &signs, network);
        let mut rhs = Mat::from_fn(jacobian.nrows(), 1, |i, _| if i < m * n { values[i] } else { 0.0 });
        let qr = jacobian.col_piv_qr();
        let r = qr.thin_R();
        let last = r.ncols() - 1;
        condition = (r[(0, 0)] / r[(last, last)]).abs();
        qr.solve_lstsq_in_place_with_conj(Conj::No, rhs.as_mut());
        let step: Vec<f64> = (0..scales.len()).map(|j| rhs[(j, 0)] / scales[j]).collect();
        if step.iter().any(|d| !d.is_finite()) {
            break;
        }
        let next = moved(network, &step);
        let next_residual = norm(&residuals(f, &signs, &next));
        if next_residual >= residual && residual > 0.0 {
            // Rounding error: keep the better of the two.
            break;
        }
        *network = next;
        residual = next_residual;
        if residual == 0.0 {
            break;
        }
    }
    if condition.is_nan() { f64::INFINITY } else { condition }
}

/// `|r_i - s_j| - sign (f_ij - o_j)`, row-major.
fn residuals(f: &[f64], signs: &[f64], network: &Network) -> Vec<f64> {
    let n = network.transmitters.len();
    (0..f.len()).map(|k| network.distance(k / n, k % n) - signs[k] * (f[k] - network.offsets[k % n])).collect()
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The Jacobian with columns scaled to unit length, and three rows that hold position and rotation fixed.
fn jacobian(signs: &[f64], network: &Network) -> (Mat<f64>, Vec<f64>) {
    let (m, n) = (network.receivers.len(), network.transmitters.len());
    let unknowns = 2 * m + 3 * n;
    let mut jacobian = Mat::<f64>::zeros(m * n + 3, unknowns);
    for i in 0..m {
        for j in 0..n {
            let (r, s) = (network.receivers[i], network.transmitters[j]);
            let d = network.distance(i, j);
            for k in 0..2 {
                let u = if d > 0.0 { (r[k] - s[k]) / d } else { 0.0 };
                jacobian[(i * n + j, 2 * i + k)] = u;
                jacobian[(i * n + j, 2 * m + 2 * j + k)] = -u;
            }
            jacobian[(i * n + j, 2 * m + 2 * n + j)] = signs[i * n + j];
        }
    }
    // Translations and the rotation about the centroid of all nodes: steps are orthogonal to them.
    let nodes: Vec<[f64; 2]> = network.receivers.iter().chain(&network.transmitters).copied().collect();
    let centre = [0, 1].map(|k| nodes.iter().map(|p| p[k]).sum::<f64>() / nodes.len() as f64);
    for (a, p) in nodes.iter().enumerate() {
        jacobian[(m * n, 2 * a)] = 1.0;
        jacobian[(m * n + 1, 2 * a + 1)] = 1.0;
        jacobian[(m * n + 2, 2 * a)] = -(p[1] - centre[1]);
        jacobian[(m * n + 2, 2 * a + 1)] = p[0] - centre[0];
    }
    for row in m * n..m * n + 3 {
        let length = (0..unknowns).map(|j| jacobian[(row, j)].powi(2)).sum::<f64>().sqrt();
        if length > 0.0 {
            (0..unknowns).for_each(|j| jacobian[(row, j)] /= length);
        }
    }
    let scales: Vec<f64> = (0..unknowns)
        .map(|j| (0..m * n + 3).map(|i| jacobian[(i, j)].powi(2)).sum::<f64>().sqrt().max(f64::MIN_POSITIVE))
        .collect();
    for j in 0..unknowns {
        (0..m * n + 3).for_each(|i| jacobian[(i, j)] /= scales[j]);
    }
    (jacobian, scales)
}

fn moved(network: &Network, step: &[f64]) -> Network {
    let (m, n) = (network.receivers.len(), network.transmitters.len());
    let mut next = network.clone();
    for (i, r) in next.receivers.iter_mut().enumerate() {
        (0..2).for_each(|k| r[k] -= step[2 * i + k]);
    }
    for j in 0..n {
        (0..2).for_each(|k| next.transmitters[j][k] -= step[2 * m + 2 * j + k]);
        next.offsets[j] -= step[2 * m + 2 * n + j];
    }
    next
}
