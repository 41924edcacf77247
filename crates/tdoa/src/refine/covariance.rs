//! Covariance of all nodes.
//!
//! Arrival times leave a rigid motion of the plane open, so that a covariance needs a gauge. Here
//! the gauge is the inner constraint over the receivers: among all covariances that explain the
//! same data, the one with the smallest trace over the receivers. It is sigma^2 times the
//! pseudo-inverse of the normal equations reduced to the receivers. It says how well the nodes lie
//! relative to the receivers as a whole, after the best rigid alignment of the receivers. Held
//! receivers are the gauge themselves: they have no error, and the normal equations of the other
//! receivers are inverted. The same holds for measured coordinates, with their errors.

use faer::Mat;
use faer::Side;

use super::cancel::{Cancelled, apart, check};
use super::normal::{Normal, backward, forward};
use super::refiner::NetworkRefiner;
use crate::loss::Loss;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Eigenvalues of the reduced normal equations below this share of the largest count as zero.
pub(super) const RANK_TOLERANCE: f64 = 1e-11;

/// Columns of the covariance that are summed together.
const TILE: usize = 16;

/// Coordinates of receivers from which on the decomposition of their equations takes some time.
const LONG: usize = 200;

/// Covariances of the nodes, metres squared.
#[derive(Debug, Clone, Default)]
pub(crate) struct Covariance {
    /// Per receiver.
    pub(crate) receivers: Vec<[[f64; 2]; 2]>,
    /// The covariance of all coordinates of the receivers, 2m x 2m by rows.
    pub(crate) joint: Vec<f64>,
    /// Per transmitter: x, y, offset; `None` where its own measurements do not determine it.
    pub(crate) transmitters: Vec<Option<[[f64; 3]; 3]>>,
    /// Receivers that could move without a change of the measurements (to first order) beyond a
    /// rigid motion.
    pub(crate) loose: Vec<usize>,
}

/// The normal equations reduced to the receivers, inverted.
pub(super) struct Reduced<'a> {
    refiner: NetworkRefiner<'a>,
    /// The inverse for all coordinates of the receivers, 2m x 2m.
    inverse: Mat<f64>,
    /// Eigenvectors of the normal equations of the free coordinates, by ascending eigenvalue.
    modes: Mat<f64>,
    /// Indices of the free coordinates.
    free: Vec<usize>,
    /// Eigenvalues that count as zero, and those of them that are rigid motions.
    zero: usize,
    rigid: usize,
}

/// `None` if the decomposition fails.
pub(super) fn reduced<'a>(
    observations: &'a Observations,
    network: &Network,
    sigma: f64,
    monitor: &Monitor,
) -> Result<Option<Reduced<'a>>, Cancelled> {
    let mut refiner = NetworkRefiner::new(observations, f64::INFINITY).heeding(monitor);
    let normal = refiner.normal_at(network, &Loss { nu: f64::INFINITY, scale: 1.0 })?;
    let size = 2 * observations.receivers;
    let lower = normal.schur();
    let free: Vec<usize> = (0..size).filter(|&k| !observations.held()[k / 2]).collect();
    let schur = Mat::from_fn(free.len(), free.len(), |a, b| {
        let (a, b) = (free[a], free[b]);
        lower[a.min(b) * size + a.max(b)]
    });
    // Where all receivers are held there is nothing to decompose, which faer does not take.
    let (values, modes) = if free.is_empty() {
        (Vec::new(), Mat::zeros(0, 0))
    } else {
        let decomposed = apart(monitor, free.len() >= LONG, move || schur.self_adjoint_eigen(Side::Lower))?;
        let Ok(eigen) = decomposed else { return Ok(None) };
        ((0..free.len()).map(|k| eigen.S()[k]).collect::<Vec<f64>>(), eigen.U().to_owned())
    };
    let largest = values.last().copied().unwrap_or(1.0);
    if !(largest.is_finite() && largest > 0.0) {
        return Ok(None);
    }
    // Eigenvalues ascend; the three smallest belong to the rigid motions.
    let rigid = if observations.leave_rigid_motions() { 3 } else { 0 };
    let zero = (0..free.len()).filter(|&k| values[k] < RANK_TOLERANCE * largest).count().max(rigid);
    let mut scaled = modes.clone();
    for (k, value) in values.iter().enumerate().skip(zero) {
        scaled.col_as_slice_mut(k).iter_mut().for_each(|x| *x *= sigma * sigma / value);
    }
    let mut inverse = Mat::<f64>::zeros(size, size);
    // A few columns at a time, which stay in the cache.
    let mut columns = vec![0.0; TILE * free.len()];
    for (tile, targets) in free.chunks(TILE).enumerate() {
        check(monitor)?;
        columns.fill(0.0);
        for k in zero..free.len() {
            let scaled = scaled.col_as_slice(k);
            for (l, column) in columns.chunks_exact_mut(free.len()).take(targets.len()).enumerate() {
                let factor = modes[(tile * TILE + l, k)];
                column.iter_mut().zip(scaled).for_each(|(sum, x)| *sum += x * factor);
            }
        }
        for (&to, column) in targets.iter().zip(columns.chunks_exact(free.len())) {
            free.iter().zip(column).for_each(|(&a, x)| inverse[(a, to)] = *x);
        }
    }
    Ok(Some(Reduced { refiner, inverse, modes, free, zero, rigid }))
}

impl Reduced<'_> {
    /// The covariance of all coordinates of the receivers, 2m x 2m by rows.
    pub(super) fn joint(&self) -> Vec<f64> {
        let size = self.inverse.nrows();
        (0..size * size).map(|k| self.inverse[(k / size, k % size)]).collect()
    }

    pub(super) fn normal(&self) -> &Normal {
        self.refiner.normal()
    }
}

/// The covariance at `network` of least squares over `observations` with deviation `sigma` (a
/// factor on the deviations of the measurements where they have their own). `None` if the
/// decomposition fails.
pub(crate) fn covariance(
    observations: &Observations,
    network: &Network,
    sigma: f64,
    monitor: &Monitor,
) -> Result<Option<Covariance>, Cancelled> {
    let m = observations.receivers;
    let Some(reduced) = reduced(observations, network, sigma, monitor)? else { return Ok(None) };
    let (normal, joint) = (reduced.normal(), reduced.joint());
    let Reduced { inverse, modes, free, zero, rigid, .. } = &reduced;
    let zero = *zero;
    let receivers = (0..m).map(|i| [0, 1].map(|a| [0, 1].map(|b| inverse[(2 * i + a, 2 * i + b)]))).collect();
    let mut first = 0;
    let mut transmitters = Vec::with_capacity(observations.transmitters);
    for j in 0..observations.transmitters {
        check(monitor)?;
        let column = observations.of_transmitter(j);
        let rays = &normal.rays()[first..first + column.len()];
        first += column.len();
        transmitters.push(normal.inverse_factor(j).map(|factor| {
            // dt = C^-1 (own noise + sum_i w g u^T dr_i), so Cov = sigma^2 C^-1 + K Cov_r K^T with
            // K_i = C^-1 g w u^T.
            let gains: Vec<([f64; 3], [f64; 2], usize)> = column
                .iter()
                .zip(rays)
                .map(|(o, (u, w))| (backward(factor, forward(factor, [w * u[0], w * u[1], *w])), *u, 2 * o.receiver))
                .collect();
            let mut sum = [[0.0; 3]; 3];
            for (a, u, i) in &gains {
                for (b, v, k) in &gains {
                    let between = (0..2)
                        .map(|p| u[p] * (inverse[(i + p, *k)] * v[0] + inverse[(i + p, k + 1)] * v[1]))
                        .sum::<f64>();
                    for x in 0..3 {
                        for y in 0..3 {
                            sum[x][y] += between * a[x] * b[y];
                        }
                    }
                }
            }
            for y in 0..3 {
                let mut unit = [0.0; 3];
                unit[y] = sigma * sigma;
                let column = backward(factor, forward(factor, unit));
                for x in 0..3 {
                    sum[x][y] += column[x];
                }
            }
            sum
        }));
    }
    let loose =
        if *rigid > 0 { loose(&modes.as_ref(), zero, network) } else { loose_beside_held(&modes.as_ref(), zero, free) };
    Ok(Some(Covariance { receivers, joint, transmitters, loose }))
}

/// Coordinate `axis` of receiver `i` in the orthonormal rigid motions: two translations and the
/// rotation about the centroid.
pub(super) fn rigid_motion(network: &Network) -> impl Fn(usize, usize) -> [f64; 3] {
    let centre = crate::points::centroid(network.receivers.iter());
    let root = (network.receivers.len() as f64).sqrt();
    let spread = network.size().max(f64::MIN_POSITIVE) * root;
    move |i: usize, axis: usize| {
        let r = [network.receivers[i][0] - centre[0], network.receivers[i][1] - centre[1]];
        if axis == 0 { [1.0 / root, 0.0, -r[1] / spread] } else { [0.0, 1.0 / root, r[0] / spread] }
    }
}

/// Receivers that take part in the zero modes beyond the rigid motions.
fn loose(modes: &faer::MatRef<'_, f64>, zero: usize, network: &Network) -> Vec<usize> {
    if zero <= 3 {
        return Vec::new();
    }
    let m = network.receivers.len();
    let rigid = rigid_motion(network);
    let freedom = |i: usize| -> f64 {
        (0..2)
            .map(|axis| {
                let all: f64 = (0..zero).map(|k| modes[(2 * i + axis, k)].powi(2)).sum();
                all - rigid(i, axis).iter().map(|x| x * x).sum::<f64>()
            })
            .sum()
    };
    (0..m).filter(|&i| freedom(i) > 0.01).collect()
}

/// Loose nodes where receivers are held, which leaves no rigid motion.
fn loose_beside_held(modes: &faer::MatRef<'_, f64>, zero: usize, free: &[usize]) -> Vec<usize> {
    let freedom = |at: usize| (0..zero).map(|k| modes[(at, k)].powi(2) + modes[(at + 1, k)].powi(2)).sum::<f64>();
    (0..free.len()).step_by(2).filter(|&at| freedom(at) > 0.01).map(|at| free[at] / 2).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::{SimulateOptions, simulate};

    #[test]
    fn receivers_that_are_all_held_have_no_error() {
        let simulation = simulate(&SimulateOptions::default()).unwrap();
        let held = vec![true; simulation.pseudoranges.receivers()];
        let observations = Observations::new(&simulation.pseudoranges, |_, _| true).holding(&held);
        let found = covariance(&observations, &simulation.network, 0.1, &Monitor::default()).unwrap().unwrap();
        assert!(found.loose.is_empty() && found.receivers.iter().flatten().flatten().all(|&c| c == 0.0));
        assert!(found.transmitters.iter().all(|c| c.is_some_and(|c| c[0][0] > 0.0 && c[1][1] > 0.0)));
    }

    /// The covariance from the full normal equations with the inner constraint as a border, by
    /// dense algebra.
    #[test]
    fn agrees_with_the_bordered_normal_equations() {
        let mut options = SimulateOptions { receivers: 6, transmitters: 5, ..Default::default() };
        options.missing = 0.05;
        let simulation = simulate(&options).unwrap();
        let network = &simulation.network;
        let observations = Observations::new(&simulation.pseudoranges, |_, _| true);
        let (m, n) = (6, 5);
        let size = 2 * m + 3 * n;
        let mut bordered = Mat::<f64>::zeros(size + 3, size + 3);
        for o in observations.all() {
            let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
            let d = network.distance(o.receiver, o.transmitter);
            let u = [(s[0] - r[0]) / d, (s[1] - r[1]) / d];
            let at = 2 * m + 3 * o.transmitter;
            let row = [(2 * o.receiver, -u[0]), (2 * o.receiver + 1, -u[1]), (at, u[0]), (at + 1, u[1]), (at + 2, 1.0)];
            for (a, x) in row {
                for (b, y) in row {
                    bordered[(a, b)] += x * y;
                }
            }
        }
        for (i, r) in network.receivers.iter().enumerate() {
            for (k, g) in [[1.0, 0.0], [0.0, 1.0], [-r[1], r[0]]].iter().enumerate() {
                for axis in 0..2 {
                    bordered[(2 * i + axis, size + k)] = g[axis];
                    bordered[(size + k, 2 * i + axis)] = g[axis];
                }
            }
        }
        use faer::linalg::solvers::DenseSolveCore;
        let expected = bordered.partial_piv_lu().inverse();
        let sigma = 0.02;
        let found = covariance(&observations, network, sigma, &Monitor::default()).unwrap().unwrap();
        assert!(found.loose.is_empty());
        for a in 0..2 {
            for b in 0..2 {
                for i in 0..m {
                    let want = sigma * sigma * expected[(2 * i + a, 2 * i + b)];
                    assert!(
                        (found.receivers[i][a][b] - want).abs() < 1e-8 * want.abs().max(sigma * sigma),
                        "receiver {i}"
                    );
                }
            }
        }
        for j in 0..n {
            let at = 2 * m + 3 * j;
            let found = found.transmitters[j].unwrap();
            for a in 0..3 {
                for b in 0..3 {
                    let want = sigma * sigma * expected[(at + a, at + b)];
                    assert!((found[a][b] - want).abs() < 1e-8 * want.abs().max(sigma * sigma), "transmitter {j}");
                }
            }
        }
    }
}
