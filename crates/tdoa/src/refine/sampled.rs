//! The covariance of a network that the measurements determine too weakly for derivatives at one place to say it.
//!
//! The least-squares network of many weakly measured transmitters is drawn to networks that are better determined than
//! the truth, so that the inverse of its normal equations is too small. The profile likelihood of the receivers, with
//! every transmitter where it fits best, has no such error: the rise of the cost at the true receivers has the
//! distribution of chi-squared. Its mean square about the least-squares network is taken over samples, which Hamiltonian Monte
//! Carlo draws (Neal, MCMC using Hamiltonian dynamics, 2011) in coordinates in which derivatives alone would make them
//! standard normal.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
#[cfg(feature = "threads")]
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use smallvec::SmallVec;

use super::cancel::{Cancelled, check};
use super::covariance::{Covariance, Reduced, own_covariance, reduced};
use crate::align::align;
use crate::bordered::{Bordered, Placed};
use crate::distances::ReceiverDistance;
use crate::network::Network;
use crate::observations::{Node, Observation, Observations, Pin};
use crate::points::{distance, dot, minus};
use hc::Monitor;

/// Networks with more coordinates of receivers than this are determined by many measurements.
const LARGE: usize = 96;

/// Standard normal points at which the cost is compared with the one that derivatives give.
const TRIED: u64 = 12;

/// Median deviation of the cost from the one that derivatives give, as a share, from which on samples are drawn.
const CURVED: f64 = 0.15;

/// Independent chains of samples, and trajectories of each: those that forget the start, and those that count.
const CHAINS: u64 = 16;
const FORGOTTEN: usize = 12;
const KEPT: usize = 30;

/// Steps of a trajectory, about a quarter of a period of a standard normal, and the mean length of one.
const LEAPS: usize = 8;
const LEAP: f64 = 0.2;

/// Steps that put a transmitter where it fits best, at most.
const PLACING: usize = 12;

/// Multiple of the network's size beyond which no receiver is sampled.
const FARTHEST: f64 = 3.0;

/// Covariance of least squares over `observations` with deviation `sigma` at the network that minimises it, about that
/// network, by the profile likelihood. `None` where derivatives say it too, and where some receivers are not determined.
pub(crate) fn sampled_covariance<const D: usize>(
    observations: &Observations<D>,
    best: &Network<D>,
    sigma: f64,
    seed: u64,
    monitor: &Monitor,
) -> Result<Option<Covariance<D>>, Cancelled> {
    let size = D * observations.receivers;
    // Samples are of receivers alone.
    if size > LARGE || observations.clocks().count() > 0 {
        return Ok(None);
    }
    let Some(reduced) = reduced(observations, best, sigma, monitor)?.filter(|reduced| reduced.is_whole()) else {
        return Ok(None);
    };
    let sampler = Sampler::new(observations, best, sigma, &reduced);
    let Some(start) = sampler.at(&sampler.start(), vec![0.0; sampler.freedom]) else { return Ok(None) };
    if sampler.deviation(&start, seed) < CURVED {
        return Ok(None);
    }
    let chain = |chain| sampler.chain(&start, seed, chain, monitor);
    #[cfg(feature = "threads")]
    let chains: Vec<Result<Moments<D>, Cancelled>> = (0..CHAINS).into_par_iter().map(chain).collect();
    #[cfg(not(feature = "threads"))]
    let chains: Vec<Result<Moments<D>, Cancelled>> = (0..CHAINS).map(chain).collect();
    let mut all = Moments::new(observations.receivers, observations.transmitters);
    for moments in chains {
        all.add(&moments?);
    }
    let mut found = all.mean_squares(observations.receivers);
    for (j, block) in found.transmitters.iter_mut().enumerate() {
        *block = reduced.normal().inverse_factor(j).and_then(|factor| {
            let mut sum = (*block)?;
            sum.add(&own_covariance(factor, sigma));
            sum.corner = observations.of_offset(sum.corner);
            Some(sum)
        });
    }
    reduced.add_levels(&mut found, observations, sigma);
    Ok(Some(found))
}

/// The profile likelihood of the receivers about a network.
struct Sampler<'a, const D: usize> {
    observations: &'a Observations<D>,
    best: &'a Network<D>,
    sigma: f64,
    /// By rows of the receivers' coordinates: what each sampled coordinate adds.
    modes: Vec<f64>,
    freedom: usize,
    /// What is known of each transmitter's place, and of the receivers'.
    of_transmitters: Vec<SmallVec<[Pin; 3]>>,
    of_receivers: Vec<(usize, Pin)>,
    /// Whether samples are to be moved onto the network.
    is_free: bool,
    /// Largest distance of a sampled receiver from its place.
    farthest: f64,
}

/// A place of the receivers, with all transmitters where they fit best.
#[derive(Clone)]
struct Point<const D: usize> {
    /// In units of standard deviations.
    coordinates: Vec<f64>,
    network: Network<D>,
    /// Half the cost, in units of the variance, and its derivatives by the coordinates.
    energy: f64,
    gradient: Vec<f64>,
}

impl<'a, const D: usize> Sampler<'a, D> {
    fn new(observations: &'a Observations<D>, best: &'a Network<D>, sigma: f64, reduced: &Reduced<'_, D>) -> Self {
        let mut of_transmitters = vec![SmallVec::new(); observations.transmitters];
        let mut of_receivers = Vec::new();
        for pin in observations.pins() {
            match pin.node {
                Node::Receiver(i) => of_receivers.push((i, *pin)),
                Node::Transmitter(j) => of_transmitters[j].push(*pin),
            }
        }
        let (modes, freedom) = reduced.whitened(sigma);
        Sampler {
            observations,
            best,
            sigma,
            modes,
            freedom,
            of_transmitters,
            of_receivers,
            is_free: observations.rigid_motions() == D * (D + 1) / 2,
            farthest: FARTHEST * best.size(),
        }
    }

    fn start(&self) -> Point<D> {
        let (coordinates, gradient) = (vec![0.0; self.freedom], vec![0.0; self.freedom]);
        Point { coordinates, network: self.best.clone(), energy: 0.0, gradient }
    }

    /// The point with these coordinates, from one beside it; `None` if it is out of reach.
    fn at(&self, from: &Point<D>, coordinates: Vec<f64>) -> Option<Point<D>> {
        let mut network = from.network.clone();
        for (i, receiver) in network.receivers.iter_mut().enumerate() {
            for (k, x) in receiver.iter_mut().enumerate() {
                let row = &self.modes[(D * i + k) * self.freedom..][..self.freedom];
                *x = self.best.receivers[i][k] + row.iter().zip(&coordinates).map(|(a, b)| a * b).sum::<f64>();
            }
            let moved = distance(*receiver, self.best.receivers[i]);
            if moved.is_nan() || moved > self.farthest {
                return None;
            }
        }
        let mut by_receivers = vec![[0.0; D]; network.receivers.len()];
        let mut cost = 0.0;
        for j in 0..network.transmitters.len() {
            cost += self.place(j, &mut network);
            for o in self.observations.of_transmitter(j) {
                let (direction, d) = ray(o, &network);
                let e = (o.length(&network) - d) * o.precision;
                for (sum, u) in by_receivers[o.receiver].iter_mut().zip(direction) {
                    *sum += e * u * o.precision;
                }
            }
        }
        for (i, pin) in &self.of_receivers {
            let e = pin.residual(&network);
            cost += e * e;
            by_receivers[*i][pin.axis] -= e * pin.precision;
        }
        let variance = self.sigma * self.sigma;
        for known in self.observations.distances() {
            let (u, e) = (known.ray(&network.receivers).0, known.residual(&network.receivers));
            cost += 2.0 * variance * ReceiverDistance::cost(e, true);
            let pull = variance * ReceiverDistance::weight(e, true) * e / known.sigma;
            let [a, b] = known.receivers;
            for (axis, u) in u.into_iter().enumerate() {
                by_receivers[a][axis] += pull * u;
                by_receivers[b][axis] -= pull * u;
            }
        }
        let mut gradient = vec![0.0; self.freedom];
        for (row, x) in self.modes.chunks_exact(self.freedom).zip(by_receivers.iter().flatten()) {
            gradient.iter_mut().zip(row).for_each(|(sum, a)| *sum += a * x / variance);
        }
        let energy = 0.5 * cost / variance;
        energy.is_finite().then_some(Point { coordinates, network, energy, gradient })
    }

    /// Puts a transmitter where it fits best, from where it is; its cost there.
    fn place(&self, j: usize, network: &mut Network<D>) -> f64 {
        let column = self.observations.of_transmitter(j);
        let pins = &self.of_transmitters[j];
        let cost_at = |network: &Network<D>| -> f64 {
            let cells = column.iter().map(|o| o.residual(network).powi(2));
            cells.chain(pins.iter().map(|pin| pin.residual(network).powi(2))).sum()
        };
        let (mut cost, mut damping) = (cost_at(network), 1e-9);
        for _ in 0..PLACING {
            let mut block = Bordered::<D>::ZERO;
            let mut right: Placed<D> = ([0.0; D], 0.0);
            for o in column {
                let (direction, d) = ray(o, network);
                let e = (o.length(network) - d) * o.precision;
                let row: Placed<D> = (direction.map(|u| u * o.precision), self.observations.of_offset(o.precision));
                block.add_product(1.0, &row, &row);
                right.0.iter_mut().zip(row.0).for_each(|(sum, u)| *sum += e * u);
                right.1 += e * row.1;
            }
            if self.observations.are_ranges() {
                block.corner = 1.0;
            }
            for pin in pins {
                block.rows[pin.axis][pin.axis] += pin.precision * pin.precision;
                right.0[pin.axis] += pin.residual(network) * pin.precision;
            }
            let Some(factor) = block.cholesky(1.0 + damping, 0.0) else { break };
            let (step, of_offset) = factor.solve(right);
            let before = (network.transmitters[j], network.offsets[j]);
            network.transmitters[j].iter_mut().zip(step).for_each(|(x, step)| *x += step);
            network.offsets[j] += of_offset;
            let now = cost_at(network);
            if now.is_nan() || now > cost {
                (network.transmitters[j], network.offsets[j]) = before;
                damping = f64::max(1e-3, 10.0 * damping);
                continue;
            }
            let gain = cost - now;
            (cost, damping) = (now, 0.1 * damping);
            if gain < 1e-4 * self.sigma * self.sigma {
                break;
            }
        }
        cost
    }

    /// Median deviation of the rise of the cost from the one that derivatives give, as a share, at standard normal points.
    fn deviation(&self, start: &Point<D>, seed: u64) -> f64 {
        let mut deviations: Vec<f64> = (0..TRIED)
            .map(|k| {
                let mut rng = rng(seed, CHAINS + k);
                let point: Vec<f64> = (0..self.freedom).map(|_| rng.sample(StandardNormal)).collect();
                let expected = 0.5 * point.iter().map(|x| x * x).sum::<f64>();
                self.at(start, point).map_or(f64::INFINITY, |at| ((at.energy - start.energy) / expected - 1.0).abs())
            })
            .collect();
        deviations.sort_by(f64::total_cmp);
        deviations[deviations.len() / 2]
    }

    /// One chain of samples.
    fn chain(&self, start: &Point<D>, seed: u64, chain: u64, monitor: &Monitor) -> Result<Moments<D>, Cancelled> {
        let mut rng = rng(seed, chain);
        let mut now = start.clone();
        let mut moments = Moments::new(self.best.receivers.len(), self.best.transmitters.len());
        for trajectory in 0..FORGOTTEN + KEPT {
            check(monitor)?;
            let momentum: Vec<f64> = (0..self.freedom).map(|_| rng.sample(StandardNormal)).collect();
            let leap = LEAP * rng.random_range(0.8..1.2);
            let threshold = rng.random::<f64>().ln();
            let total =
                |point: &Point<D>, momentum: &[f64]| point.energy + 0.5 * momentum.iter().map(|p| p * p).sum::<f64>();
            let before = total(&now, &momentum);
            if let Some((then, momentum)) = self.leap(&now, momentum, leap)
                && before - total(&then, &momentum) > threshold
            {
                now = then;
            }
            if trajectory >= FORGOTTEN {
                moments.count(&self.beside(&now.network), self.best);
            }
        }
        Ok(moments)
    }

    /// The end of a trajectory by the leapfrog rule, and the momentum there; `None` if it leaves what is sampled.
    fn leap(&self, from: &Point<D>, mut momentum: Vec<f64>, leap: f64) -> Option<(Point<D>, Vec<f64>)> {
        let push = |momentum: &mut [f64], by: f64, gradient: &[f64]| {
            momentum.iter_mut().zip(gradient).for_each(|(p, g)| *p -= by * g);
        };
        let mut at = from.clone();
        push(&mut momentum, 0.5 * leap, &at.gradient);
        for step in 1..=LEAPS {
            let coordinates = at.coordinates.iter().zip(&momentum).map(|(x, p)| x + leap * p).collect();
            at = self.at(&at, coordinates)?;
            push(&mut momentum, if step == LEAPS { 0.5 * leap } else { leap }, &at.gradient);
        }
        Some((at, momentum))
    }

    /// The network moved onto the best one, where nothing fixes its place.
    fn beside(&self, network: &Network<D>) -> Network<D> {
        match align(&network.receivers, &self.best.receivers, false) {
            Some(alignment) if self.is_free => alignment.transform.apply_network(network),
            _ => network.clone(),
        }
    }
}

/// Direction from the receiver to the transmitter of a measurement, and the distance.
fn ray<const D: usize>(o: &Observation, network: &Network<D>) -> ([f64; D], f64) {
    let between = minus(network.transmitters[o.transmitter], network.receivers[o.receiver]);
    let d = dot(between, between).sqrt();
    (if d > 0.0 { between.map(|x| x / d) } else { [0.0; D] }, d)
}

fn rng(seed: u64, stream: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(stream))
}

/// Sums of products of the shifts of all nodes.
struct Moments<const D: usize> {
    count: usize,
    /// Dm x Dm by rows.
    receivers: Vec<f64>,
    transmitters: Vec<Bordered<D>>,
}

impl<const D: usize> Moments<D> {
    fn new(m: usize, n: usize) -> Self {
        Moments { count: 0, receivers: vec![0.0; D * m * D * m], transmitters: vec![Bordered::ZERO; n] }
    }

    /// Counts the shift of a network from the best one.
    fn count(&mut self, network: &Network<D>, best: &Network<D>) {
        let shifts = network.receivers.iter().zip(&best.receivers).map(|(p, q)| minus(*p, *q));
        let shifts: Vec<f64> = shifts.flatten().collect();
        for (row, x) in self.receivers.chunks_exact_mut(shifts.len()).zip(&shifts) {
            row.iter_mut().zip(&shifts).for_each(|(sum, y)| *sum += x * y);
        }
        for (j, sum) in self.transmitters.iter_mut().enumerate() {
            let shift = (minus(network.transmitters[j], best.transmitters[j]), network.offsets[j] - best.offsets[j]);
            sum.add_product(1.0, &shift, &shift);
        }
        self.count += 1;
    }

    fn add(&mut self, other: &Moments<D>) {
        self.receivers.iter_mut().zip(&other.receivers).for_each(|(sum, x)| *sum += x);
        self.transmitters.iter_mut().zip(&other.transmitters).for_each(|(sum, x)| sum.add(x));
        self.count += other.count;
    }

    fn mean_squares(self, m: usize) -> Covariance<D> {
        let share = 1.0 / self.count.max(1) as f64;
        let joint: Vec<f64> = self.receivers.iter().map(|sum| sum * share).collect();
        let size = D * m;
        let of = |i: usize| std::array::from_fn(|a| std::array::from_fn(|b| joint[(D * i + a) * size + D * i + b]));
        let receivers = (0..m).map(of).collect();
        let transmitters = self.transmitters.into_iter().map(|mut sum| {
            sum.rows.iter_mut().flatten().chain(&mut sum.border).for_each(|x| *x *= share);
            sum.corner *= share;
            Some(sum)
        });
        Covariance { receivers, transmitters: transmitters.collect(), joint, loose: Vec::new(), constant: None }
    }
}

#[cfg(test)]
mod tests;
