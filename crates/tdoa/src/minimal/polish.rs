//! Gauss-Newton in the primal coordinates: the last digits of a candidate, and its condition.

use super::linear::LeastSquares;
use crate::clocks::Emissions;
use crate::network::Network;
use crate::points::centroid;

/// Iterations at most; candidates come with about ten digits and gain the rest in two.
const MAX_ITERATIONS: usize = 8;

/// Scratch space; keeps its memory from call to call.
#[derive(Default)]
pub(crate) struct NetworkPolisher<const D: usize = 2> {
    squares: LeastSquares,
    signs: Vec<f64>,
    /// What is known of offsets.
    emissions: Emissions,
    next: Network<D>,
}

impl<const D: usize> NetworkPolisher<D> {
    /// Moves the network to the least-squares solution of `|r_i - s_j| = +-(f_ij - o_j)`, signs as
    /// they are at the start, and returns the condition number of that problem (columns of unit
    /// length, rigid motions excluded). Offsets stay as they are where `f` are ranges, and are one unknown where these have a
    /// constant in common.
    ///
    /// `f` is row-major, receivers in rows. The network stays as it is where a step would not bring
    /// it nearer.
    pub(crate) fn polish(&mut self, f: &[f64], emissions: Emissions, network: &mut Network<D>) -> f64 {
        self.emissions = emissions;
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
            move_by(step, emissions, network, &mut self.next);
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

    /// Sets up the linear problem of a step: residuals and their Jacobian, and rows that hold
    /// position and rotation fixed.
    fn linearise(&mut self, f: &[f64], network: &Network<D>) {
        let (m, n) = (network.receivers.len(), network.transmitters.len());
        let offsets = match self.emissions {
            Emissions::Unknown => n,
            Emissions::Known => 0,
            Emissions::Constant => 1,
        };
        let (rows, unknowns) = (m * n + D * (D + 1) / 2, D * (m + n) + offsets);
        let (jacobian, values) = self.squares.start(rows, unknowns);
        let at = |row: usize, column: usize| column * rows + row;
        for i in 0..m {
            for j in 0..n {
                let (r, s) = (network.receivers[i], network.transmitters[j]);
                let (row, d, sign) = (i * n + j, network.distance(i, j), self.signs[i * n + j]);
                for k in 0..D {
                    let u = if d > 0.0 { (r[k] - s[k]) / d } else { 0.0 };
                    jacobian[at(row, D * i + k)] = u;
                    jacobian[at(row, D * (m + j) + k)] = -u;
                }
                if let Some(offset) = offset_of(j, self.emissions) {
                    jacobian[at(row, D * (m + n) + offset)] = sign;
                }
                values[row] = residual(f, &self.signs, network, row);
            }
        }
        // Translations and the rotations about the centroid of all nodes, one in each plane of two
        // axes: steps are orthogonal to them.
        let nodes = || network.receivers.iter().chain(&network.transmitters);
        let centre = centroid(nodes());
        for (a, p) in nodes().enumerate() {
            for k in 0..D {
                jacobian[at(m * n + k, D * a + k)] = 1.0;
            }
            let planes = (0..D).flat_map(|k| (k + 1..D).map(move |l| (k, l)));
            for (row, (k, l)) in planes.enumerate() {
                jacobian[at(m * n + D + row, D * a + k)] = -(p[l] - centre[l]);
                jacobian[at(m * n + D + row, D * a + l)] = p[k] - centre[k];
            }
        }
        for row in m * n..rows {
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
fn residual<const D: usize>(f: &[f64], signs: &[f64], network: &Network<D>, k: usize) -> f64 {
    let n = network.transmitters.len();
    network.distance(k / n, k % n) - signs[k] * (f[k] - network.offsets[k % n])
}

/// The Euclidean norm of all residuals.
fn norm<const D: usize>(f: &[f64], signs: &[f64], network: &Network<D>) -> f64 {
    (0..f.len()).map(|k| residual(f, signs, network, k).powi(2)).sum::<f64>().sqrt()
}

/// Which of the unknown offsets is that of transmitter `j`, if it is unknown.
fn offset_of(j: usize, emissions: Emissions) -> Option<usize> {
    match emissions {
        Emissions::Unknown => Some(j),
        Emissions::Known => None,
        Emissions::Constant => Some(0),
    }
}

/// Makes `next` the network less a step.
fn move_by<const D: usize>(step: &[f64], emissions: Emissions, network: &Network<D>, next: &mut Network<D>) {
    let (m, n) = (network.receivers.len(), network.transmitters.len());
    next.receivers.clone_from(&network.receivers);
    next.transmitters.clone_from(&network.transmitters);
    next.offsets.clone_from(&network.offsets);
    for (i, r) in next.receivers.iter_mut().enumerate() {
        for k in 0..D {
            r[k] -= step[D * i + k];
        }
    }
    for j in 0..n {
        for k in 0..D {
            next.transmitters[j][k] -= step[D * (m + j) + k];
        }
        if let Some(offset) = offset_of(j, emissions) {
            next.offsets[j] -= step[D * (m + n) + offset];
        }
    }
}
