//! Gauss-Newton in the primal coordinates: the last digits of a candidate, and its condition.

use super::linear::LeastSquares;
use crate::network::Network;
use crate::points::centroid;

/// Iterations at most; candidates come with about ten digits and gain the rest in two.
const MAX_ITERATIONS: usize = 8;

/// Scratch space; keeps its memory from call to call.
#[derive(Default)]
pub(crate) struct Polisher {
    squares: LeastSquares,
    signs: Vec<f64>,
    next: Network,
}

impl Polisher {
    /// Moves the network to the least-squares solution of `|r_i - s_j| = +-(f_ij - o_j)`, signs as
    /// they are at the start, and returns the condition number of that problem (columns of unit
    /// length, the three rigid motions excluded).
    ///
    /// `f` is row-major, receivers in rows. The network stays as it is where a step would not bring
    /// it nearer.
    pub(crate) fn polish(&mut self, f: &[f64], network: &mut Network) -> f64 {
        let n = network.transmitters.len();
        self.signs.clear();
        self.signs.extend((0..f.len()).map(|k| if f[k] < network.offsets[k % n] { -1.0 } else { 1.0 }));
        let mut residual = norm(f, &self.signs, network);
        let mut condition = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            self.linearise(f, network);
            let (first, last) = self.squares.solve();
            condition = (first / last).abs();
            let step = self.squares.solution();
            if step.iter().any(|d| !d.is_finite()) {
                break;
            }
            move_by(step, network, &mut self.next);
            let next_residual = norm(f, &self.signs, &self.next);
            if next_residual >= residual && residual > 0.0 {
                // Rounding error: keep the better of the two.
                break;
            }
            std::mem::swap(network, &mut self.next);
            residual = next_residual;
            if residual == 0.0 {
                break;
            }
        }
        if condition.is_nan() { f64::INFINITY } else { condition }
    }

    /// Sets up the linear problem of a step: residuals and their Jacobian, and three rows that hold
    /// position and rotation fixed.
    fn linearise(&mut self, f: &[f64], network: &Network) {
        let (m, n) = (network.receivers.len(), network.transmitters.len());
        let (rows, unknowns) = (m * n + 3, 2 * m + 3 * n);
        let (jacobian, values) = self.squares.start(rows, unknowns);
        let at = |row: usize, column: usize| column * rows + row;
        for i in 0..m {
            for j in 0..n {
                let (r, s) = (network.receivers[i], network.transmitters[j]);
                let (row, d, sign) = (i * n + j, network.distance(i, j), self.signs[i * n + j]);
                for k in 0..2 {
                    let u = if d > 0.0 { (r[k] - s[k]) / d } else { 0.0 };
                    jacobian[at(row, 2 * i + k)] = u;
                    jacobian[at(row, 2 * m + 2 * j + k)] = -u;
                }
                jacobian[at(row, 2 * m + 2 * n + j)] = sign;
                values[row] = residual(f, &self.signs, network, row);
            }
        }
        // Translations and the rotation about the centroid of all nodes: steps are orthogonal to
        // them.
        let nodes = || network.receivers.iter().chain(&network.transmitters);
        let centre = centroid(nodes());
        for (a, p) in nodes().enumerate() {
            jacobian[at(m * n, 2 * a)] = 1.0;
            jacobian[at(m * n + 1, 2 * a + 1)] = 1.0;
            jacobian[at(m * n + 2, 2 * a)] = -(p[1] - centre[1]);
            jacobian[at(m * n + 2, 2 * a + 1)] = p[0] - centre[0];
        }
        for row in m * n..m * n + 3 {
            let length = (0..unknowns).map(|j| jacobian[at(row, j)].powi(2)).sum::<f64>().sqrt();
            if length > 0.0 {
                for j in 0..unknowns {
                    jacobian[at(row, j)] /= length;
                }
            }
        }
    }
}

/// `|r_i - s_j| - sign (f_ij - o_j)` of entry `k` of the matrix.
fn residual(f: &[f64], signs: &[f64], network: &Network, k: usize) -> f64 {
    let n = network.transmitters.len();
    network.distance(k / n, k % n) - signs[k] * (f[k] - network.offsets[k % n])
}

/// The Euclidean norm of all residuals.
fn norm(f: &[f64], signs: &[f64], network: &Network) -> f64 {
    (0..f.len()).map(|k| residual(f, signs, network, k).powi(2)).sum::<f64>().sqrt()
}

/// Makes `next` the network less a step.
fn move_by(step: &[f64], network: &Network, next: &mut Network) {
    let (m, n) = (network.receivers.len(), network.transmitters.len());
    next.receivers.clone_from(&network.receivers);
    next.transmitters.clone_from(&network.transmitters);
    next.offsets.clone_from(&network.offsets);
    for (i, r) in next.receivers.iter_mut().enumerate() {
        for k in 0..2 {
            r[k] -= step[2 * i + k];
        }
    }
    for j in 0..n {
        for k in 0..2 {
            next.transmitters[j][k] -= step[2 * m + 2 * j + k];
        }
        next.offsets[j] -= step[2 * m + 2 * n + j];
    }
}
