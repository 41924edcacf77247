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
use super::levels::motions_of_levels;
use super::motion::Motion;
use super::normal::Normal;
use super::refiner::NetworkRefiner;
use super::rigid::rigid_motion;
use crate::bordered::{Bordered, Placed};
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
    /// The covariance of all coordinates of the receivers, Dm x Dm by rows.
    pub(crate) joint: Vec<f64>,
    /// Per transmitter, position (all rows, above the diagonal too) and offset; `None` where its own
    /// measurements do not determine it.
    pub(crate) transmitters: Vec<Option<Bordered<D>>>,
    /// Receivers that could move without a change of the measurements (to first order) beyond a
    /// rigid motion.
    pub(crate) loose: Vec<usize>,
}

impl<const D: usize> Covariance<D> {
    /// Adds `factor` times the product of two motions.
    pub(crate) fn add_product(&mut self, factor: f64, p: &Motion<D>, q: &Motion<D>) {
        let size = p.receivers.len();
        for (row, x) in self.joint.chunks_exact_mut(size).zip(&p.receivers) {
            row.iter_mut().zip(&q.receivers).for_each(|(sum, y)| *sum += factor * x * y);
        }
        for (i, rows) in self.receivers.iter_mut().enumerate() {
            *rows = from_fn(|a| from_fn(|b| self.joint[(D * i + a) * size + D * i + b]));
        }
        for (own, (s, t)) in self.transmitters.iter_mut().zip(p.transmitters.iter().zip(&q.transmitters)) {
            if let Some(own) = own {
                own.add_product(factor, s, t);
            }
        }
    }

    /// Largest standard deviation of a receiver's place, metres.
    pub(crate) fn loosest(&self) -> f64 {
        if self.loose.is_empty() { self.receivers.iter().map(trace).fold(0.0, f64::max).sqrt() } else { f64::INFINITY }
    }
}

/// The normal equations reduced to the receivers, inverted.
pub(super) struct Reduced<'a, const D: usize> {
    refiner: NetworkRefiner<'a, D>,
    /// The inverse for all coordinates of the receivers, Dm x Dm.
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
    let size = D * observations.receivers;
    let lower = normal.schur();
    let free: Vec<usize> = (0..size).filter(|&k| !observations.held()[k / D]).collect();
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
    // Eigenvalues ascend; the smallest, three or in space six, belong to the rigid motions.
    let rigid = observations.rigid_motions();
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
    Ok(Some(Reduced { refiner, inverse, modes, values, free, zero, rigid }))
}

impl<const D: usize> Reduced<'_, D> {
    /// The covariance of all coordinates of the receivers, Dm x Dm by rows.
    pub(super) fn joint(&self) -> Vec<f64> {
        let size = self.inverse.nrows();
        (0..size * size).map(|k| self.inverse[(k / size, k % size)]).collect()
    }

    pub(super) fn normal(&self) -> &Normal<D> {
        self.refiner.normal()
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
    let Reduced { inverse, modes, free, zero, rigid, .. } = &reduced;
    let zero = *zero;
    let receivers = (0..m).map(|i| from_fn(|a| from_fn(|b| inverse[(D * i + a, D * i + b)]))).collect();
    let mut transmitters = Vec::with_capacity(observations.transmitters);
    for j in 0..observations.transmitters {
        check(monitor)?;
        transmitters.push(normal.inverse_factor(j).map(|factor| {
            // dt = C^-1 (own noise + sum_i w g u^T dr_i), so Cov = sigma^2 C^-1 + K Cov_r K^T with
            // K_i = C^-1 g w u^T.
            let gains = normal.gains(observations, j);
            let rays = normal.rays()[observations.places(j)].iter().zip(observations.of_transmitter(j));
            let gains: Vec<(Placed<D>, [f64; D], usize)> =
                gains.into_iter().zip(rays).map(|(gain, ((u, _), o))| (gain, *u, D * o.receiver)).collect();
            let mut sum = Bordered::ZERO;
            for (a, u, i) in &gains {
                for (b, v, k) in &gains {
                    let row = |p: usize| (0..D).map(|q| inverse[(i + p, k + q)] * v[q]).sum::<f64>();
                    let between = (0..D).map(|p| u[p] * row(p)).sum::<f64>();
                    sum.add_product(between, a, b);
                }
            }
            sum.add(&own_covariance(factor, sigma));
            sum.corner = observations.of_offset(sum.corner);
            sum
        }));
    }
    let loose = if *rigid > 0 {
        loose(&modes.as_ref(), zero, network)
    } else {
        loose_beside_held::<D>(&modes.as_ref(), zero, free)
    };
    let mut found = Covariance { receivers, joint, transmitters, loose };
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
mod tests {
    use super::*;
    use crate::network::tests::random;
    use crate::observations::{Level, Node, Pin};
    use crate::pseudoranges::Pseudoranges;
    use crate::simulate::{SimulateOptions, simulate};
    use faer::linalg::solvers::DenseSolveCore;

    #[test]
    fn receivers_that_are_all_held_have_no_error() {
        let simulation = simulate(&SimulateOptions::default()).unwrap();
        let held = vec![true; simulation.pseudoranges.receivers()];
        let observations = Observations::<2>::new(&simulation.pseudoranges, |_, _| true).holding(&held);
        let found = covariance(&observations, &simulation.network, 0.1, &Monitor::default()).unwrap().unwrap();
        assert!(found.loose.is_empty() && found.receivers.iter().flatten().flatten().all(|&c| c == 0.0));
        assert!(found.transmitters.iter().all(|c| c.is_some_and(|c| c.rows[0][0] > 0.0 && c.rows[1][1] > 0.0)));
    }

    /// The covariance from the full normal equations with the inner constraint as a border, by dense
    /// algebra.
    fn agrees_with_bordered_equations<const D: usize>(m: usize, n: usize) {
        let network: Network<D> = random(m, n, 5);
        let mut values = network.pseudoranges();
        values[3] = f64::NAN;
        let observations = Observations::new(&Pseudoranges::new(m, n, values).unwrap(), |_, _| true);
        let (size, motions) = (D * m + (D + 1) * n, D * (D + 1) / 2);
        let mut jacobian = Mat::<f64>::zeros(observations.len(), size);
        for (k, o) in observations.all().iter().enumerate() {
            let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
            let at = D * m + (D + 1) * o.transmitter;
            for axis in 0..D {
                let u = (s[axis] - r[axis]) / network.distance(o.receiver, o.transmitter);
                (jacobian[(k, D * o.receiver + axis)], jacobian[(k, at + axis)]) = (-u, u);
            }
            jacobian[(k, at + D)] = 1.0;
        }
        let mut bordered = Mat::<f64>::zeros(size + motions, size + motions);
        bordered.submatrix_mut(0, 0, size, size).copy_from(jacobian.transpose() * &jacobian);
        for (i, r) in network.receivers.iter().enumerate() {
            let mut next = size;
            for k in 0..D {
                (bordered[(D * i + k, next)], bordered[(next, D * i + k)]) = (1.0, 1.0);
                next += 1;
                for l in 0..k {
                    (bordered[(D * i + k, next)], bordered[(next, D * i + k)]) = (r[l], r[l]);
                    (bordered[(D * i + l, next)], bordered[(next, D * i + l)]) = (-r[k], -r[k]);
                    next += 1;
                }
            }
        }
        let expected = bordered.partial_piv_lu().inverse();
        let sigma = 0.02;
        let found = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
        assert!(found.loose.is_empty());
        let close = |found: f64, a: usize, b: usize| {
            let want = sigma * sigma * expected[(a, b)];
            assert!((found - want).abs() < 1e-8 * want.abs().max(sigma * sigma), "{a} {b}: {found} {want}");
        };
        for a in 0..D * m {
            for b in 0..D * m {
                close(found.joint[a * D * m + b], a, b);
                if a / D == b / D {
                    close(found.receivers[a / D][a % D][b % D], a, b);
                }
            }
        }
        for (j, found) in found.transmitters.iter().enumerate() {
            let (at, found) = (D * m + (D + 1) * j, found.unwrap());
            for a in 0..D {
                for b in 0..D {
                    close(found.rows[a][b], at + a, at + b);
                }
                close(found.border[a], at + D, at + a);
            }
            close(found.corner, at + D, at + D);
        }
    }

    #[test]
    fn agrees_with_the_bordered_normal_equations() {
        agrees_with_bordered_equations::<2>(6, 5);
        agrees_with_bordered_equations::<3>(8, 9);
    }

    #[test]
    fn a_receiver_that_may_move_in_space_is_loose() {
        let network: Network<3> = random(24, 9, 6);
        let mut values = network.pseudoranges();
        // Two measurements of the third receiver are left.
        values[2 * 9 + 2..3 * 9].fill(f64::NAN);
        let measured = Pseudoranges::new(24, 9, values).unwrap();
        let loose = |held: &[usize]| {
            let held: Vec<bool> = (0..24).map(|i| held.contains(&i)).collect();
            let observations = Observations::new(&measured, |_, _| true).holding(&held);
            covariance(&observations, &network, 0.1, &Monitor::default()).unwrap().unwrap().loose
        };
        // Where nothing is held, others move a little against it.
        assert!(loose(&[]).contains(&2));
        assert_eq!(loose(&[0, 1, 3]), [2]);
        assert!(loose(&[0, 1, 2, 3]).is_empty());
    }

    /// Against the inverse of the equations of nodes and levels, by dense algebra.
    #[test]
    fn levels_are_unknowns() {
        let (m, n, sigma) = (7, 9, 0.02);
        let network: Network<3> = random(m, n, 5);
        let measured = Pseudoranges::new(m, n, network.pseudoranges()).unwrap();
        let nodes = (0..m).map(Node::Receiver).chain((0..n).map(Node::Transmitter));
        // All three axes, so that no rigid motion is left.
        let pin = |node, axis| Pin { node, axis, value: 0.0, precision: [0.7, 0.9, 2.0][axis] };
        let pins: Vec<Pin> = nodes.flat_map(|node| (0..3).map(move |axis| pin(node, axis))).collect();
        let share = |of: fn(Node) -> f64| -> Vec<f64> {
            pins.iter().map(|pin| if pin.axis == 2 { of(pin.node) } else { 0.0 }).collect()
        };
        let levels = [
            (share(|node| f64::from(u8::from(matches!(node, Node::Transmitter(_))))), 0.3),
            (share(|node| if let Node::Receiver(i) = node { [1.0, -1.0][i % 2] } else { 0.0 }), 0.5),
        ]
        .map(|(shares, precision)| Level { shares, precision });
        let observations = Observations::<3>::new(&measured, |_, _| true).pinned(&pins).levelled(levels.to_vec());

        let at = |node: Node| match node {
            Node::Receiver(i) => 3 * i,
            Node::Transmitter(j) => 3 * m + 4 * j,
        };
        let nodes = 3 * m + 4 * n;
        let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
        for o in observations.all() {
            let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
            let (i, j) = (at(Node::Receiver(o.receiver)), at(Node::Transmitter(o.transmitter)));
            let u = |axis: usize| (s[axis] - r[axis]) / network.distance(o.receiver, o.transmitter);
            let ray = (0..3).flat_map(|axis| [(i + axis, -u(axis)), (j + axis, u(axis))]);
            rows.push(ray.chain([(j + 3, 1.0)]).collect());
        }
        for (k, pin) in pins.iter().enumerate() {
            let own = (at(pin.node) + pin.axis, pin.precision);
            let of_levels = levels.iter().enumerate().map(|(l, level)| (nodes + l, -pin.precision * level.shares[k]));
            rows.push([own].into_iter().chain(of_levels).collect());
        }
        rows.extend(levels.iter().enumerate().map(|(l, level)| vec![(nodes + l, level.precision)]));
        let mut jacobian = Mat::<f64>::zeros(rows.len(), nodes + levels.len());
        for (k, row) in rows.iter().enumerate() {
            row.iter().for_each(|(column, value)| jacobian[(k, *column)] += value);
        }
        let wanted = (jacobian.transpose() * &jacobian).partial_piv_lu().inverse();
        let found = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
        let close = |found: f64, a: usize, b: usize| {
            let wanted = sigma * sigma * wanted[(a, b)];
            assert!((found - wanted).abs() < 1e-9 * sigma * sigma, "{a} {b}: {found} {wanted}");
        };
        for a in 0..3 * m {
            (0..3 * m).for_each(|b| close(found.joint[a * 3 * m + b], a, b));
            close(found.receivers[a / 3][a % 3][a % 3], a, a);
        }
        for (j, of) in found.transmitters.iter().enumerate() {
            let (at, of) = (at(Node::Transmitter(j)), of.unwrap());
            (0..3).for_each(|a| (0..3).for_each(|b| close(of.rows[a][b], at + a, at + b)));
            (0..3).for_each(|a| close(of.border[a], at + 3, at + a));
            close(of.corner, at + 3, at + 3);
        }
    }
}
