//! Covariance of all nodes.
//!
//! Arrival times leave a rigid motion open, so that a covariance needs a gauge. Here
//! the gauge is the inner constraint over the receivers: among all covariances that explain the
//! same data, the one with the smallest trace over the receivers. It is sigma^2 times the
//! pseudo-inverse of the normal equations reduced to the receivers. It says how well the nodes lie
//! relative to the receivers as a whole, after the best rigid alignment of the receivers. Held
//! receivers are the gauge themselves: they have no error, and the normal equations of the other
//! receivers are inverted. The same holds for measured coordinates, with their errors.

use faer::Mat;
use faer::Side;

use super::cancel::{Cancelled, apart, check};
use super::clock_elimination::EliminatedClocks;
use super::levels::motions_of_levels;
use super::motion::Motion;
use super::normal::Normal;
use super::refiner::NetworkRefiner;
use super::rigid::rigid_motion;
use super::way::{Way, ways};
use crate::bordered::Bordered;
use crate::loss::Loss;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::trace;
use hc::Monitor;
use std::array::from_fn;

/// Eigenvalues of the reduced normal equations below this share of the largest count as zero.
pub(super) const RANK_TOLERANCE: f64 = 1e-11;

/// Columns of the covariance that are summed together.
const TILE: usize = 16;

/// Coordinates of receivers from which on the decomposition of their equations takes some time.
const LONG: usize = 200;

/// Covariances of the nodes, metres squared.
#[derive(Debug, Clone, Default)]
pub(crate) struct Covariance<const D: usize = 2> {
    /// Per receiver.
    pub(crate) receivers: Vec<[[f64; D]; D]>,
    /// The covariance of all coordinates of the receivers, and of the unknowns of clocks after them, by rows.
    pub(crate) joint: Vec<f64>,
    /// Per transmitter, position (all rows, above the diagonal too) and offset; `None` where its own
    /// measurements do not determine it.
    pub(crate) transmitters: Vec<Option<Bordered<D>>>,
    /// Receivers that could move without a change of the measurements (to first order) beyond a
    /// rigid motion.
    pub(crate) loose: Vec<usize>,
    /// Place in `joint` of the offset that all transmitters share, if they share one.
    pub(crate) constant: Option<usize>,
}

impl<const D: usize> Covariance<D> {
    /// Adds `factor` times the product of two motions.
    pub(crate) fn add_product(&mut self, factor: f64, p: &Motion<D>, q: &Motion<D>) {
        let size = p.reduced.len();
        for (row, x) in self.joint.chunks_exact_mut(size).zip(&p.reduced) {
            row.iter_mut().zip(&q.reduced).for_each(|(sum, y)| *sum += factor * x * y);
        }
        for (i, rows) in self.receivers.iter_mut().enumerate() {
            *rows = from_fn(|a| from_fn(|b| self.joint[(D * i + a) * size + D * i + b]));
        }
        for (own, (s, t)) in self.transmitters.iter_mut().zip(p.transmitters.iter().zip(&q.transmitters)) {
            if let Some(own) = own {
                own.add_product(factor, s, t);
                own.corner = self.constant.map_or(own.corner, |at| self.joint[at * (size + 1)]);
            }
        }
    }
}

/// The normal equations reduced to the receivers, inverted.
pub(super) struct Reduced<'a, const D: usize> {
    refiner: NetworkRefiner<'a, D>,
    /// The inverse for all coordinates of the receivers and unknowns of clocks.
    inverse: Mat<f64>,
    /// Eigenvectors of the normal equations of the free coordinates, by ascending eigenvalue, and these.
    modes: Mat<f64>,
    values: Vec<f64>,
    /// Indices of the free coordinates.
    free: Vec<usize>,
    /// Eigenvalues that count as zero, and those of them that are rigid motions.
    zero: usize,
    rigid: usize,
}

/// `None` if the decomposition fails.
pub(super) fn reduced<'a, const D: usize>(
    observations: &'a Observations<D>,
    network: &Network<D>,
    sigma: f64,
    monitor: &Monitor,
) -> Result<Option<Reduced<'a, D>>, Cancelled> {
    let mut refiner = NetworkRefiner::new(observations, f64::INFINITY, monitor);
    let normal = refiner.normal_at(network, &Loss { nu: f64::INFINITY, scale: 1.0 })?;
    let (all, size) = (observations.reduced(), D * observations.receivers);
    let lower = normal.schur();
    let entry = |a: usize, b: usize| lower[a.min(b) * all + a.max(b)];
    let free: Vec<usize> = (0..size).filter(|&k| !observations.held()[k / D]).collect();
    let clocks = match all - size {
        0 => None,
        count => match EliminatedClocks::new(count, &free, size, entry) {
            Some(clocks) => Some(clocks),
            None => return Ok(None),
        },
    };
    let schur = Mat::from_fn(free.len(), free.len(), |a, b| {
        entry(free[a], free[b]) - clocks.as_ref().map_or(0.0, |clocks| clocks.taken(a, b))
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
    // Eigenvalues ascend; the smallest, three or in space six, belong to the rigid motions.
    let rigid = observations.rigid_motions();
    let zero = (0..free.len()).filter(|&k| values[k] < RANK_TOLERANCE * largest).count().max(rigid);
    let mut scaled = modes.clone();
    for (k, value) in values.iter().enumerate().skip(zero) {
        scaled.col_as_slice_mut(k).iter_mut().for_each(|x| *x *= sigma * sigma / value);
    }
    let mut inverse = Mat::<f64>::zeros(all, all);
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
    if let Some(clocks) = clocks {
        clocks.extend(&mut inverse, &free, size, sigma);
    }
    Ok(Some(Reduced { refiner, inverse, modes, values, free, zero, rigid }))
}

impl<const D: usize> Reduced<'_, D> {
    /// The covariance of all coordinates of the receivers, and of the unknowns of clocks after them, by rows.
    pub(super) fn joint(&self) -> Vec<f64> {
        let size = self.inverse.nrows();
        (0..size * size).map(|k| self.inverse[(k / size, k % size)]).collect()
    }

    pub(super) fn normal(&self) -> &Normal<D> {
        self.refiner.normal()
    }

    /// The covariance of a receiver.
    pub(super) fn block(&self, i: usize) -> [[f64; D]; D] {
        from_fn(|a| from_fn(|b| self.inverse[(D * i + a, D * i + b)]))
    }

    /// The covariance of what two measurements have of receivers and clocks.
    #[inline]
    pub(super) fn product(&self, a: &Way<'_, D>, b: &Way<'_, D>) -> f64 {
        let row = |p: usize| (0..D).map(|q| self.inverse[(a.at + p, b.at + q)] * b.ray[q]).sum::<f64>();
        let rays = (0..D).map(|p| a.ray[p] * row(p)).sum::<f64>();
        rays + a.of_clocks(b, |x, y| self.inverse[(x, y)])
    }

    /// Receivers that could move without a change of the measurements (to first order) beyond a rigid motion.
    fn loose(&self, network: &Network<D>) -> Vec<usize> {
        let modes = self.modes.as_ref();
        if self.rigid > 0 {
            loose(&modes, self.zero, network)
        } else {
            loose_beside_held::<D>(&modes, self.zero, &self.free)
        }
    }

    /// Largest standard deviation of a receiver's place, metres.
    pub(super) fn loosest(&self, network: &Network<D>) -> f64 {
        if !self.loose(network).is_empty() {
            return f64::INFINITY;
        }
        (0..network.receivers.len()).map(|i| trace(&self.block(i))).fold(0.0, f64::max).sqrt()
    }

    /// Adds what it adds that the values of pins are not known well.
    pub(super) fn add_levels(&self, covariance: &mut Covariance<D>, observations: &Observations<D>, sigma: f64) {
        if !observations.levels().is_empty() {
            let motions = motions_of_levels(observations, self.normal(), &self.joint(), sigma);
            motions.iter().for_each(|(factor, motion)| covariance.add_product(*factor, motion, motion));
        }
    }

    /// Whether the measurements determine all receivers, up to a rigid motion.
    pub(super) fn is_whole(&self) -> bool {
        self.zero == self.rigid && self.zero < self.free.len()
    }

    /// The modes that are determined, each as long as its standard deviation, by rows of the receivers' coordinates, and
    /// how many there are.
    pub(super) fn whitened(&self, sigma: f64) -> (Vec<f64>, usize) {
        let count = self.free.len() - self.zero;
        let mut rows = vec![0.0; self.inverse.nrows() * count];
        for (a, &at) in self.free.iter().enumerate() {
            for k in 0..count {
                let mode = self.zero + k;
                rows[at * count + k] = self.modes[(a, mode)] * sigma / self.values[mode].sqrt();
            }
        }
        (rows, count)
    }
}

/// The covariance at `network` of least squares over `observations` with deviation `sigma` (a
/// factor on the deviations of the measurements where they have their own). `None` if the
/// decomposition fails.
pub(crate) fn covariance<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    sigma: f64,
    monitor: &Monitor,
) -> Result<Option<Covariance<D>>, Cancelled> {
    let m = observations.receivers;
    let Some(reduced) = reduced(observations, network, sigma, monitor)? else { return Ok(None) };
    let (normal, joint) = (reduced.normal(), reduced.joint());
    let receivers = (0..m).map(|i| reduced.block(i)).collect();
    let constant = observations.clocks().constant().map(|at| D * m + at);
    let mut transmitters = Vec::with_capacity(observations.transmitters);
    for j in 0..observations.transmitters {
        check(monitor)?;
        transmitters.push(normal.inverse_factor(j).map(|factor| {
            // dt = C^-1 (own noise + sum_i w g u^T dr_i), so Cov = sigma^2 C^-1 + K Cov_r K^T with
            // K_i = C^-1 g w u^T; unknowns of clocks continue r.
            let gains = normal.gains(observations, j);
            let ways = ways(observations, normal, j);
            let mut sum = Bordered::ZERO;
            for (a, of_a) in gains.iter().zip(&ways) {
                for (b, of_b) in gains.iter().zip(&ways) {
                    sum.add_product(reduced.product(of_a, of_b), a, b);
                }
            }
            sum.add(&own_covariance(factor, sigma));
            sum.corner = constant.map_or_else(|| observations.of_offset(sum.corner), |at| reduced.inverse[(at, at)]);
            sum
        }));
    }
    let loose = reduced.loose(network);
    let mut found = Covariance { receivers, joint, transmitters, loose, constant };
    reduced.add_levels(&mut found, observations, sigma);
    Ok(Some(found))
}

/// The covariance of a transmitter between receivers that are known, from the inverse of the Cholesky factor of its own
/// normal equations.
pub(super) fn own_covariance<const D: usize>(factor: &Bordered<D>, sigma: f64) -> Bordered<D> {
    let mut own = Bordered::ZERO;
    for y in 0..D {
        let mut unit = [0.0; D];
        unit[y] = sigma * sigma;
        let (column, last) = factor.invert((unit, 0.0));
        (0..D).for_each(|x| own.rows[x][y] = column[x]);
        own.border[y] = last;
    }
    own.corner = factor.invert(([0.0; D], sigma * sigma)).1;
    own
}

/// Receivers that take part in the zero modes beyond the rigid motions.
fn loose<const D: usize>(modes: &faer::MatRef<'_, f64>, zero: usize, network: &Network<D>) -> Vec<usize> {
    if zero <= D * (D + 1) / 2 {
        return Vec::new();
    }
    let m = network.receivers.len();
    let rigid = rigid_motion(network);
    let freedom = |i: usize| -> f64 {
        (0..D)
            .map(|axis| {
                let all: f64 = (0..zero).map(|k| modes[(D * i + axis, k)].powi(2)).sum();
                all - rigid(i, axis).iter().map(|x| x * x).sum::<f64>()
            })
            .sum()
    };
    (0..m).filter(|&i| freedom(i) > 0.01).collect()
}

/// Loose nodes where receivers are held, which leaves no rigid motion.
fn loose_beside_held<const D: usize>(modes: &faer::MatRef<'_, f64>, zero: usize, free: &[usize]) -> Vec<usize> {
    let square = |at: usize, k: usize| (0..D).map(|axis| modes[(at + axis, k)].powi(2)).sum::<f64>();
    let freedom = |at: usize| (0..zero).map(|k| square(at, k)).sum::<f64>();
    (0..free.len()).step_by(D).filter(|&at| freedom(at) > 0.01).map(|at| free[at] / D).collect()
}

#[cfg(test)]
mod tests;
