//! How far nodes lie above and below their plane, where the measurements hardly tell each of them.
//!
//! In a nearly flat network the height z of a node changes distances by its square, z^2 / 2d, so that small heights
//! are lost in the noise, and least squares in space makes heights of noise. Here heights are normal, those of
//! receivers about the plane z = 0 and those of transmitters about one beside it, each with a standard deviation tau.
//! Receivers may be about two levels instead, as anchors near the floor and near the ceiling are.
//! The maximum of the marginal likelihood is found by expectation maximisation in Laplace's approximation: tau^2 is the
//! mean of (z - plane)^2 and the variance of z at the most likely network (Dempster, Laird and Rubin 1977; MacKay
//! 1992), which in its turn is least squares with the pins z = plane +- tau.
//!
//! Every other round goes as much farther as two rounds before have it.
//!
//! The iteration comes from large heights. Where a plane explains the measurements it ends at the largest heights
//! that they allow: heights below that change nothing that was measured.

use super::cancel::{Cancelled, check};
use super::gross_errors::{Good, GrossErrors};
use super::height_variances::HeightVariances;
use super::refiner::{NetworkRefiner, RefineOptions, SEARCH};
use crate::loss::SEARCH_NU;
use crate::network::Network;
use crate::observations::{Level, Node, Observation, Observations, Pin};
use crate::points::spread;
use hc::Monitor;
use std::array::from_fn;
use std::f64::consts::{LN_2, TAU};

/// Most rounds of fitting network and heights in turn.
const ROUNDS: usize = 60;

/// Steps of a fit.
const MOST_STEPS: usize = 30;

/// Measurements of which a step takes long: then rounds have few, and a decrease of the negative log-likelihood that tells
/// nothing is none.
const MANY: usize = 5000;
const STEPS: usize = 5;
const NEGLIGIBLE: f64 = 0.01;

/// Relative change of the deviations that ends the rounds.
const STILL: f64 = 5e-3;

/// Share of the way to the likeliest deviations that is left after a round, at most, as far as two rounds are believed.
const MOST_LEFT: f64 = 0.8;

/// Deviations of heights are at least this share of the network's size.
const LEAST: f64 = 1e-4;

/// Deviations of heights as a share of the network's size that stand for the plane.
const NONE: f64 = 1e-7;

/// The largest deviation of heights, as a multiple of the smallest, before anything is measured.
const RANGE: f64 = 1000.0;

/// Logarithm of the ratio of marginal likelihoods beyond which a deviation of heights is left out.
const UNLIKELY: f64 = 6.0;

/// Most times that the likeliest deviation of heights is doubled.
const DOUBLINGS: i32 = 20;

/// Most rounds of telling gross errors from good measurements.
const SORTINGS: usize = 12;

/// Standard deviations of the heights of nodes above their plane, and the network that has them.
#[derive(Debug, Clone)]
pub(crate) struct Heights<const D: usize> {
    /// Of receivers about their levels, metres.
    pub(crate) receivers: f64,
    /// On which of two levels each receiver is, 1 or -1; 0 for all where there is one level, z = 0.
    pub(crate) sides: Vec<f64>,
    /// Half of the distance of the two levels, which are as far above z = 0 as below, metres.
    pub(crate) apart: f64,
    /// Of transmitters about their plane, metres.
    pub(crate) transmitters: f64,
    /// Height of the plane of the transmitters, metres.
    pub(crate) between: f64,
    /// How many heights the measurements tell, out of all.
    pub(crate) told: f64,
    /// Largest standard deviation of a receiver's place, metres.
    pub(crate) loosest: f64,
    /// Deviation of the measurements: the given one, or that of the residuals.
    pub(crate) deviation: f64,
    /// The most likely network.
    pub(crate) network: Network<D>,
}

impl<const D: usize> Heights<D> {
    /// Deviations of heights and the most likely network near one with level planes, from the measurements without gross
    /// errors. Receivers are on the levels that `sides` say. `known` is the deviation of the measurements if it is given,
    /// `first` one near it. `None` if the equations are singular.
    pub(crate) fn of(
        observations: &Observations<D>,
        network: &Network<D>,
        sides: Vec<f64>,
        known: Option<f64>,
        first: f64,
        monitor: &Monitor,
    ) -> Result<Option<Heights<D>>, Cancelled> {
        let least = LEAST * network.size();
        let (m, n) = (observations.receivers as f64, observations.transmitters as f64);
        let mut now = Heights {
            receivers: 0.0,
            sides,
            apart: 0.0,
            transmitters: mean_square(&network.transmitters, mean(&network.transmitters)).sqrt().max(least),
            between: mean(&network.transmitters),
            told: m + n,
            loosest: 0.0,
            deviation: known.unwrap_or(first),
            network: network.clone(),
        };
        now.centre();
        now.receivers = now.off_levels().sqrt().max(least);
        let (mut before, mut steps) = (None, if has_many(observations) { STEPS } else { MOST_STEPS });
        for _ in 0..ROUNDS {
            let pinned = observations.clone().pinned(&now.pins());
            now.network = now.fit(&pinned, now.network.clone(), steps, monitor)?;
            now.centre();
            let Some(variances) = HeightVariances::of(&pinned, &now.network, now.deviation, monitor)? else {
                return Ok(None);
            };
            now.loosest = variances.loosest;
            let of_receivers: f64 = variances.receivers.iter().sum();
            let unplaced = now.transmitters.powi(2);
            let of_transmitters: f64 = variances.transmitters.iter().map(|own| own.unwrap_or(unplaced)).sum();
            let told = [(m, of_receivers, now.receivers), (n, of_transmitters, now.transmitters)]
                .map(|(count, variances, tau)| (count - variances / tau.powi(2)).max(0.0));
            let change = |square: f64, variances: f64, count: f64, tau: f64| {
                ((square + variances / count).sqrt().max(least) / tau).ln()
            };
            now.between = mean(&now.network.transmitters);
            let off = mean_square(&now.network.transmitters, now.between);
            let changes = [
                change(now.off_levels(), of_receivers, m, now.receivers),
                change(off, of_transmitters, n, now.transmitters),
            ];
            let whole = before.map_or(changes, |before: [f64; 2]| from_fn(|k| whole_way(before[k], changes[k])));
            before = if before.is_none() { Some(changes) } else { None };
            now.receivers = (now.receivers * whole[0].exp()).max(least);
            now.transmitters = (now.transmitters * whole[1].exp()).max(least);
            now.told = told[0] + told[1];
            if known.is_none() {
                let squares: f64 = observations.all().iter().map(|o| o.residual(&now.network).powi(2)).sum();
                let unknowns = now.in_the_plane(observations) as f64 + now.told;
                let left = (observations.len() as f64 - unknowns).max(1.0);
                now.deviation = (squares / left).sqrt();
            }
            if changes.iter().all(|change| change.abs() < STILL) {
                if steps == MOST_STEPS {
                    break;
                }
                // The network may still be on its way.
                steps = MOST_STEPS;
            }
        }
        Ok(Some(now))
    }

    /// The most likely network near one with these heights, and the sum of the squares of its residuals, heights
    /// included, in the unit of the measurements.
    pub(crate) fn fitted(
        &self,
        observations: &Observations<D>,
        network: Network<D>,
        monitor: &Monitor,
    ) -> Result<(f64, Network<D>), Cancelled> {
        let pinned = observations.clone().pinned(&self.pins());
        let network = self.fit(&pinned, network, MOST_STEPS, monitor)?;
        Ok((squares(&pinned, &network), network))
    }

    /// The network of least squares near one, or nearer to it by so many steps.
    fn fit(
        &self,
        pinned: &Observations<D>,
        network: Network<D>,
        steps: usize,
        monitor: &Monitor,
    ) -> Result<Network<D>, Cancelled> {
        let negligible = if has_many(pinned) { NEGLIGIBLE * self.deviation.powi(2) } else { 0.0 };
        let fit = RefineOptions { scale: Some(1.0), steps, rounds: 0, tolerance: 1e-9, negligible, ..SEARCH };
        let network = NetworkRefiner::new(pinned, f64::INFINITY, monitor).refine(network, &fit).network;
        check(monitor)?;
        Ok(network)
    }

    /// These with the plane of the transmitters as z = 0, from which receivers are as far on either side.
    pub(crate) fn about_transmitters(&self) -> Heights<D> {
        let sides = vec![0.0; self.sides.len()];
        let mut moved = Heights { between: 0.0, sides, apart: 0.0, ..self.clone() };
        moved.lift(-self.between);
        moved.receivers = moved.off_levels().sqrt().max(self.receivers);
        moved
    }

    /// Adds to the heights of all nodes.
    fn lift(&mut self, height: f64) {
        self.network.receivers.iter_mut().chain(&mut self.network.transmitters).for_each(|p| p[D - 1] += height);
    }

    /// The likeliest levels for these heights of receivers, and the likeliest heights of all nodes together.
    fn centre(&mut self) {
        let count = self.sides.len().max(1) as f64;
        let (height, side) = (mean(&self.network.receivers), self.sides.iter().sum::<f64>() / count);
        let heights = self.network.receivers.iter().map(|p| p[D - 1]);
        let covariance: f64 = self.sides.iter().zip(heights).map(|(s, z)| (s - side) * z).sum();
        let variance: f64 = self.sides.iter().map(|s| (s - side).powi(2)).sum();
        self.apart = if variance > 0.0 { covariance / variance } else { 0.0 };
        self.lift(self.apart * side - height);
    }

    /// Mean square of the receivers' heights above their levels.
    fn off_levels(&self) -> f64 {
        let receivers = &self.network.receivers;
        let squares = receivers.iter().zip(&self.sides).map(|(p, side)| (p[D - 1] - side * self.apart).powi(2));
        squares.sum::<f64>() / receivers.len().max(1) as f64
    }

    /// The most likely planar network near this one, where measurements of about this deviation are good.
    pub(crate) fn flat(
        &self,
        observations: &Observations<D>,
        deviation: f64,
        monitor: &Monitor,
    ) -> Result<Heights<D>, Cancelled> {
        let none = NONE * self.network.size();
        let mut flat =
            Heights { receivers: none, transmitters: none, between: 0.0, apart: 0.0, deviation, ..self.clone() };
        let points = flat.network.receivers.iter_mut().chain(&mut flat.network.transmitters);
        points.for_each(|p| p[D - 1] = 0.0);
        let pinned = observations.clone().pinned(&flat.pins());
        let negligible = if has_many(observations) { NEGLIGIBLE } else { 0.0 };
        let fit =
            RefineOptions { scale: Some(deviation), steps: 100, rounds: 0, tolerance: 1e-10, negligible, ..SEARCH };
        flat.network = NetworkRefiner::new(&pinned, SEARCH_NU, monitor).refine(flat.network, &fit).network;
        check(monitor)?;
        Ok(flat)
    }

    /// Logarithm of the marginal likelihood of the measurements in Laplace's approximation, up to a constant. An
    /// unknown deviation of theirs is the likeliest one. Good measurements are normal; gross errors, of which there are
    /// as many as these make likely, are anywhere within `width` metres. `None` if the equations are singular.
    pub(crate) fn evidence(
        &self,
        observations: &Observations<D>,
        known: Option<f64>,
        width: f64,
        monitor: &Monitor,
    ) -> Result<Option<f64>, Cancelled> {
        let unknowns = self.in_the_plane(observations);
        let mut errors = GrossErrors::new(observations.len(), width);
        let mut now = self.clone();
        let (mut before, mut rounds) = (0, 0);
        loop {
            let is_good = |o: &Observation| o.residual(&now.network).abs() <= errors.limit(now.deviation, o.precision);
            let kept = observations.subset(is_good).pinned(&now.pins());
            let left = kept.len().saturating_sub(unknowns);
            if left == 0 {
                return Ok(None);
            }
            now.network = now.fit(&kept, now.network.clone(), MOST_STEPS, monitor)?;
            let squares = squares(&kept, &now.network);
            let deviation = known.unwrap_or_else(|| errors.deviation(squares, left));
            errors.count(kept.len());
            let settled = kept.len() == before && (deviation / now.deviation).ln().abs() < STILL;
            (now.deviation, before, rounds) = (deviation, kept.len(), rounds + 1);
            if !settled && rounds < SORTINGS {
                continue;
            }
            // Nodes that the measurements hardly place are somewhere within the width as well.
            let placed = kept.clone().pinned(&[now.pins(), now.within(width)].concat());
            let mut refiner = NetworkRefiner::new(&placed, f64::INFINITY, monitor);
            let Some(determinant) = refiner.log_determinant_at(&now.network)? else { return Ok(None) };
            // Densities of positions over those of the measurements, as the equations have both in one unit.
            let prior: f64 = placed.pins().iter().map(|pin| pin.precision.ln()).sum();
            let log_precisions = kept.all().iter().map(|o| o.precision.ln()).sum();
            let good = Good { count: kept.len(), squares, log_precisions };
            let density = errors.log_density(&good, placed.unknown_times(), deviation);
            return Ok(Some(density + prior - 0.5 * determinant));
        }
    }

    /// The root mean square of the deviations of the receivers' heights, metres, each weighted by its marginal likelihood,
    /// on a logarithmic scale. Of few receivers it may be much larger than the likeliest deviation.
    pub(crate) fn likely_receivers(
        &self,
        observations: &Observations<D>,
        known: Option<f64>,
        width: f64,
        monitor: &Monitor,
    ) -> Result<f64, Cancelled> {
        let (mut best, mut weights, mut squares) = (f64::NEG_INFINITY, 0.0, 0.0);
        for step in -1..DOUBLINGS {
            let receivers = self.receivers * 2f64.powi(step);
            let tried = Heights { receivers, ..self.clone() };
            let Some(evidence) = tried.evidence(observations, known, width, monitor)? else { break };
            if receivers > width || evidence < best - UNLIKELY {
                break;
            }
            if evidence > best {
                (weights, squares) = (weights * (best - evidence).exp(), squares * (best - evidence).exp());
                best = evidence;
            }
            weights += (evidence - best).exp();
            squares += (evidence - best).exp() * receivers * receivers;
        }
        let likely = if weights > 0.0 { (squares / weights).sqrt() } else { 0.0 };
        Ok(likely.max(self.receivers))
    }

    /// What not knowing the deviations and the place of the transmitters' plane beforehand costs in the logarithm of the
    /// marginal likelihood: each deviation is anywhere from a thousandth of `width` to it, on a logarithmic scale, and
    /// the plane within it on either side; k heights tell the logarithm of their deviation to 1 / sqrt(2k), and their
    /// mean to the deviation over sqrt(k). Of two levels, each receiver is on either, and their distance is as the place
    /// of the plane.
    pub(crate) fn log_prior(&self, width: f64) -> f64 {
        let (m, n) = (self.network.receivers.len() as f64, self.network.transmitters.len() as f64);
        let of_deviation = |count: f64| (0.5 * (TAU / (2.0 * count)).ln() - RANGE.ln().ln()).min(0.0);
        let of_place = |count: f64, tau: f64| (0.5 * (TAU / count).ln() + (tau / (2.0 * width)).ln()).min(0.0);
        let of_levels = if self.apart == 0.0 { 0.0 } else { of_place(m, self.receivers) - (m - 1.0) * LN_2 };
        of_deviation(m) + of_deviation(n) + of_place(n, self.transmitters) + of_levels
    }

    /// Number of unknowns without heights.
    fn in_the_plane(&self, observations: &Observations<D>) -> usize {
        let nodes = self.network.receivers.len() + self.network.transmitters.len();
        (2 * nodes + observations.unknown_times()).saturating_sub(3)
    }

    /// The heights as measurements of the plane's place.
    pub(crate) fn pins(&self) -> Vec<Pin> {
        let pin = |node: Node, value: f64, tau: f64| Pin { node, axis: D - 1, value, precision: self.deviation / tau };
        let levels = self.sides.iter().map(|side| side * self.apart).enumerate();
        let receivers = levels.map(|(i, level)| pin(Node::Receiver(i), level, self.receivers));
        let transmitters = 0..self.network.transmitters.len();
        receivers.chain(transmitters.map(|j| pin(Node::Transmitter(j), self.between, self.transmitters))).collect()
    }

    /// The levels of [`Heights::pins`]. Beforehand each is known to within its own size: the measurements may tell no more.
    pub(crate) fn levels(&self) -> Vec<Level> {
        let (receivers, transmitters) = (self.network.receivers.len(), self.network.transmitters.len());
        let of_plane = vec![0.0; receivers].into_iter().chain(vec![1.0; transmitters]).collect();
        let of_sides = self.sides.iter().copied().chain(vec![0.0; transmitters]).collect();
        let level = |shares, size| Level { shares, precision: self.deviation / size };
        let plane = level(of_plane, self.between.hypot(self.transmitters));
        let apart = (self.apart != 0.0).then(|| level(of_sides, self.apart.abs()));
        [plane].into_iter().chain(apart).collect()
    }

    /// Root mean square distance of the receivers from z = 0, metres.
    pub(crate) fn distance_from_plane(&self) -> f64 {
        self.receivers.hypot(self.apart)
    }

    /// The deviation of the heights of receivers or transmitters, whichever are flatter, as a share of the receivers'
    /// spread.
    pub(crate) fn flatness(&self) -> f64 {
        self.receivers.min(self.transmitters) / spread(self.network.receivers.iter()).max(f64::MIN_POSITIVE)
    }

    /// The places of all nodes along the plane as they are, each with a standard deviation of `width`.
    fn within(&self, width: f64) -> Vec<Pin> {
        let of = |node: Node, point: &[f64; D]| -> Vec<Pin> {
            let pin = |axis: usize| Pin { node, axis, value: point[axis], precision: self.deviation / width };
            (0..D - 1).map(pin).collect()
        };
        let receivers = self.network.receivers.iter().enumerate().flat_map(|(i, p)| of(Node::Receiver(i), p));
        let transmitters = self.network.transmitters.iter().enumerate().flat_map(|(j, p)| of(Node::Transmitter(j), p));
        receivers.chain(transmitters).collect()
    }

    /// By how much the heights change a measured distance, root mean square over all measurements: in metres, and in
    /// deviations of the measurements.
    pub(crate) fn change(&self, observations: &Observations<D>) -> [f64; 2] {
        let square = self.distance_from_plane().powi(2) + self.transmitters.powi(2) + self.between.powi(2);
        let change = |i: usize, j: usize| 0.5 * square / self.network.distance(i, j).max(square.sqrt());
        let mut squares = [0.0; 2];
        for o in observations.all() {
            let change = change(o.receiver, o.transmitter);
            squares[0] += change.powi(2);
            squares[1] += (change * o.precision / self.deviation).powi(2);
        }
        squares.map(|sum| (sum / observations.len().max(1) as f64).sqrt())
    }
}

/// The way to where changes end of which each is the same share of the one before it (Aitken), from two of them.
fn whole_way(before: f64, change: f64) -> f64 {
    let share = change / before;
    if share > 0.0 { change / (1.0 - share.min(MOST_LEFT)) } else { change }
}

/// Whether these are so many measurements that a part of them tells about how high nodes are, and each step takes long.
pub(crate) fn has_many<const D: usize>(observations: &Observations<D>) -> bool {
    observations.len() >= MANY
}

/// Sum of the squares of the residuals, of pins too.
fn squares<const D: usize>(pinned: &Observations<D>, network: &Network<D>) -> f64 {
    let cells = pinned.all().iter().map(|o| o.residual(network).powi(2));
    let all: f64 = cells.chain(pinned.pins().iter().map(|pin| pin.residual(network).powi(2))).sum();
    all + 2.0 * pinned.deviation().powi(2) * pinned.misfit(network, true)
}

/// Mean of the last coordinate.
fn mean<const D: usize>(points: &[[f64; D]]) -> f64 {
    points.iter().map(|p| p[D - 1]).sum::<f64>() / points.len().max(1) as f64
}

/// Mean square of the last coordinate less its middle.
fn mean_square<const D: usize>(points: &[[f64; D]], middle: f64) -> f64 {
    points.iter().map(|p| (p[D - 1] - middle).powi(2)).sum::<f64>() / points.len().max(1) as f64
}

#[cfg(test)]
mod tests;
