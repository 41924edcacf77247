//! Receiver errors absorbed by the fitted geometry. Each receiver is fitted once with a free
//! error of its own and with all its measurements. So is a receiver that the score test names,
//! because the test may take one kind of error for another.
//!
//! The score test of `score_test` is linear. If the best network has given up some of the
//! measurements that show an error as outliers, the error is too large for it. Here the other nodes
//! are refined without the receiver, the receiver is located from them together with the size of
//! its error, and the whole is refitted. What counts is the decrease of the truncated cost.

use crate::bordered::{Bordered, Placed};
use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::receivers::errors::{Fault, ReceiverErrorKind};
use crate::calibrate::receivers::score_test::{SIDE, tests};
use crate::calibrate::receivers::significance::{doubt, least_gain, least_surprise, surprise};
use crate::calibrate::search::deviation::{inlier_deviation, spread_of_receiver};
use crate::calibrate::search::truncated_cost::{annealed, refit, truncated, truncated_at, truncated_cost};
use crate::loss::{CAUCHY, Loss};
use crate::multilateration::solve;
use crate::network::Network;
use crate::observations::{Observation, Observations};
use crate::points::{distance, minus};
use crate::refine::{NetworkRefiner, Projection, RefineOptions, SEARCH, dot};
use hc::Monitor;
use std::array::from_fn;

/// The share of what an error gains at least that it gains against all others where they are, of more than [`TRIED`]
/// receivers: one bends the others little.
const SHOWN: f64 = 0.75;

/// Jumps of one receiver that are tried.
const JUMPS: usize = 24;

/// Receivers that are tried; in larger networks those with most measurements given up.
const TRIED: usize = 24;

/// Steps of locating a receiver with its error, the first of which anneal.
const STEPS: usize = 24;
const ANNEAL: f64 = 0.7;

/// Rounds of fitting network and error together.
const ROUNDS: usize = 10;

/// Deviations, in those of the measurements, at which network and error are fitted once more at first where
/// measurements were given up.
const WIDEST: f64 = 10.0;

/// An error of a receiver and the network that goes with it.
pub(crate) struct Refit<const D: usize> {
    pub(crate) fault: Fault<D>,
    pub(crate) network: Network<D>,
    /// Measurements left over.
    pub(crate) freedom: f64,
    /// How much more it explains than chance would; of a doubt not positive.
    pub(crate) lead: f64,
}

impl<const D: usize> Refit<D> {
    fn leading(self, observations: &Observations<D>, kept: usize) -> Refit<D> {
        let is_move = self.fault.kind == ReceiverErrorKind::Move;
        let told = surprise(self.fault.gain, self.freedom, if is_move { D } else { 1 });
        let tested = told - least_surprise(tests(self.fault.kind, observations.receivers, kept));
        // A move has more unknowns than other errors (Schwarz 1978).
        let more = if is_move { (D - 1) as f64 } else { 0.0 };
        Refit { lead: tested - 0.5 * more * (kept as f64).ln(), ..self }
    }
}

/// The error of each receiver that explains most, if more than chance would, most telling first; then
/// those that are worth a doubt.
/// Receivers are those whose measurements were given up, and `suspects`: where nothing was given up,
/// the score test has seen all other errors. Those of `suspects` are fitted from the best network too.
pub(crate) fn refits<const D: usize>(
    observations: &Observations<D>,
    best: &Network<D>,
    deviation: f64,
    limit: f64,
    suspects: &[Fault<D>],
    monitor: &Monitor,
) -> Result<Vec<Refit<D>>, CalibrateError<D>> {
    let mut given_up = vec![0usize; observations.receivers];
    for o in observations.all().iter().filter(|o| o.residual(best).abs() > limit * deviation) {
        given_up[o.receiver] += 1;
    }
    let kept = observations.len() - given_up.iter().sum::<usize>();
    let tried = if kept == observations.len() { suspects.len() } else { TRIED };
    if tried == 0 || kept < observations.unknowns() + 5 {
        return Ok(Vec::new());
    }
    let (base, cost) = refit(observations, best, deviation, monitor)?;
    let mut order: Vec<usize> = (0..observations.receivers).collect();
    let of = |i: usize| suspects.iter().filter(move |suspect| suspect.receiver == i);
    order.sort_by_key(|&i| (of(i).count() == 0, std::cmp::Reverse(given_up[i])));
    order.truncate(tried);
    let mut found: Vec<Refit<D>> = Vec::new();
    let fitting = Fitting { observations, base: &base, cost, deviation, limit, monitor };
    for receiver in order {
        check(monitor)?;
        // One gross error alone is no move.
        let may_have_moved = given_up[receiver] > 1 || of(receiver).count() > 0;
        if fitting.are_many() && of(receiver).count() == 0 && !fitting.shows_error(receiver, may_have_moved)? {
            continue;
        }
        let mut fits = fitting.receiver(receiver, may_have_moved)?;
        for suspect in of(receiver).filter(|suspect| suspect.kind != ReceiverErrorKind::Move) {
            fits.extend(fitting.joint(base.clone(), Fault { size: [0.0; D], ..*suspect })?);
        }
        let fits = fits.into_iter().map(|next| next.leading(observations, kept));
        found.extend(fits.filter(|next| next.lead > -doubt()).max_by(|a, b| a.lead.total_cmp(&b.lead)));
    }
    found.sort_by(|a, b| b.lead.total_cmp(&a.lead));
    Ok(found)
}

/// What errors are fitted to.
pub(crate) struct Fitting<'a, const D: usize> {
    pub(crate) observations: &'a Observations<D>,
    /// The network of least squares without the error, and its truncated cost.
    base: &'a Network<D>,
    cost: f64,
    pub(crate) deviation: f64,
    /// Measurements farther off than this many deviations are outliers.
    pub(crate) limit: f64,
    pub(crate) monitor: &'a Monitor,
}

/// A network and an error on the way to their best fit.
#[derive(Clone)]
struct Joint<const D: usize> {
    /// The measurements without the error.
    observations: Observations<D>,
    network: Network<D>,
    fault: Fault<D>,
    /// The square of what one metre of the error adds to the residuals, motions taken off.
    square: f64,
    cost: f64,
}

impl<const D: usize> Fitting<'_, D> {
    /// Whether one receiver bends the others little.
    fn are_many(&self) -> bool {
        self.observations.receivers > TRIED
    }

    /// Whether a receiver shows an error against all others where they are.
    fn shows_error(&self, receiver: usize, may_have_moved: bool) -> Result<bool, CalibrateError<D>> {
        let local = Local::new(self.observations, self.base, receiver, self.deviation);
        if local.all().iter().flatten().any(|located| self.shows(&local, located)) {
            return Ok(true);
        }
        Ok(may_have_moved && self.shows_move(receiver, self.base, SHOWN)?)
    }

    /// Whether a receiver shows this error against the others.
    fn shows(&self, local: &Local<D>, located: &LocatedFault<D>) -> bool {
        let tests = tests(located.fault.kind, self.observations.receivers, self.observations.len());
        local.cost() - located.cost >= SHOWN * (least_gain(tests) - doubt())
    }

    /// Fits of one receiver with an error of each kind, as far as they are worth a look.
    fn receiver(&self, receiver: usize, may_have_moved: bool) -> Result<Vec<Refit<D>>, CalibrateError<D>> {
        let others = self.observations.subset(|o| o.receiver != receiver);
        let options = RefineOptions { scale: Some(CAUCHY * self.deviation), rounds: 0, steps: 30, ..SEARCH };
        let bent = NetworkRefiner::new(&others, 1.0, self.monitor).refine(self.base.clone(), &options).network;
        let (alone, cost) = refit(&others, &bent, self.deviation, self.monitor)?;
        // No error can bring the cost below that of the others.
        let least = least_gain(tests(ReceiverErrorKind::Delay, others.receivers, 1)) - doubt();
        if !alone.is_finite() || self.cost - cost < least {
            return Ok(Vec::new());
        }
        let moved = if may_have_moved { self.moved(receiver, &alone)? } else { None };
        let local = Local::new(self.observations, &alone, receiver, self.deviation);
        let starts = local.all();
        check(self.monitor)?;
        let fitted = starts
            .into_iter()
            .flatten()
            // The fit of all nodes may halve what locating one has left.
            .filter(|located| self.cost - cost - 0.5 * located.cost > 0.0)
            .filter(|located| !self.are_many() || self.shows(&local, located))
            .map(|located| {
                let mut network = alone.clone();
                network.receivers[receiver] = located.position;
                self.joint(network, located.fault)
            });
        let fitted: Vec<Option<Refit<D>>> = fitted.collect::<Result<_, CalibrateError<D>>>()?;
        Ok(fitted.into_iter().flatten().chain(moved).collect())
    }

    /// Least squares of all nodes and the error over the inliers, from here; `None` where the error
    /// cannot be told from a motion of the nodes.
    fn joint(&self, network: Network<D>, fault: Fault<D>) -> Result<Option<Refit<D>>, CalibrateError<D>> {
        let start = Joint { observations: self.corrected(&fault), network, fault, square: 0.0, cost: f64::INFINITY };
        let Some(mut fitted) = self.descend(start, 1.0)? else { return Ok(None) };
        // A network that is still bent gives up measurements that the error would explain.
        let (least, most) = (self.reach(), WIDEST * self.reach());
        let is_near = |o: &Observation| (least..most).contains(&o.residual(&fitted.network).abs());
        if fitted.observations.all().iter().any(is_near) {
            let mut relaxed = Some(fitted.clone());
            for &factor in annealed(WIDEST) {
                relaxed = match relaxed {
                    Some(now) => self.descend(now, factor)?,
                    None => None,
                };
            }
            fitted = relaxed.filter(|relaxed| self.is_better(relaxed, &fitted)).unwrap_or(fitted);
        }
        let Joint { observations, network, fault, square, .. } = fitted;
        let with_error = observations.with_other_unknowns(self.observations.other_unknowns() + 1);
        let size = fault.size[0];
        let gain = self.gain(&with_error, &network, &[fault.receiver], Some(size * size * square))?;
        Ok(gain.map(|(gain, freedom)| Refit { fault: Fault { gain, ..fault }, network, freedom, lead: 0.0 }))
    }

    /// Whether a fit costs less than another, with the smaller of the deviations that they leave: with
    /// that of a bent network, measurements given up look cheap.
    fn is_better(&self, fit: &Joint<D>, other: &Joint<D>) -> bool {
        let left = |fit: &Joint<D>| inlier_deviation(&fit.observations, &fit.network, self.deviation, self.limit);
        let deviation = left(fit).min(left(other)).min(self.deviation);
        let cost = |fit: &Joint<D>| truncated_cost(&fit.observations, &fit.network, deviation);
        cost(fit) < cost(other)
    }

    /// The measurements without an error.
    fn corrected(&self, fault: &Fault<D>) -> Observations<D> {
        let n = self.observations.transmitters;
        let of = |o: &Observation| {
            if o.receiver == fault.receiver { fault.size[0] * fault.shape(o.transmitter, n) } else { 0.0 }
        };
        self.observations.reduced_by(of)
    }

    /// Measurements farther off cost as much as outliers.
    fn reach(&self) -> f64 {
        truncated_at() * self.deviation
    }

    /// Lowers the truncated cost with so many times the deviation.
    fn descend(&self, from: Joint<D>, factor: f64) -> Result<Option<Joint<D>>, CalibrateError<D>> {
        let n = self.observations.transmitters;
        let (reach, deviation) = (factor * self.reach(), factor * self.deviation);
        let mut now = from;
        now.cost = truncated_cost(&now.observations, &now.network, deviation);
        for _ in 0..ROUNDS {
            let fault = now.fault;
            let inliers = now.observations.subset(|o| o.residual(&now.network).abs() <= reach);
            let Some(projection) = Projection::new(&inliers, &now.network, self.monitor)? else { return Ok(None) };
            let residuals: Vec<f64> = inliers.all().iter().map(|o| o.residual(&now.network)).collect();
            let part = |o: &Observation| {
                if o.receiver == fault.receiver { o.precision * fault.shape(o.transmitter, n) } else { 0.0 }
            };
            let column: Vec<f64> = inliers.all().iter().map(part).collect();
            let (rest, _) = projection.off(&column);
            now.square = dot(&rest, &rest);
            if now.square < 1e-6 * dot(&column, &column) || now.square.is_nan() {
                return Ok(None);
            }
            let step = dot(&rest, &residuals) / now.square;
            let left: Vec<f64> = residuals.iter().zip(&column).map(|(e, c)| e - step * c).collect();
            let motion = projection.off(&left).1;
            let mut share = 1.0;
            let better = loop {
                let network = motion.applied(&inliers, &now.network, -share);
                let mut fault = fault;
                fault.size[0] += share * step;
                let observations = self.corrected(&fault);
                let cost = truncated_cost(&observations, &network, deviation);
                if cost < now.cost {
                    break Some(Joint { observations, network, fault, cost, ..now });
                }
                share *= 0.4;
                if share < 0.05 {
                    break None;
                }
            };
            let Some(better) = better else { break };
            let gain = now.cost - better.cost;
            now = better;
            if gain < 1e-3 {
                break;
            }
        }
        Ok(Some(now))
    }

    /// By how much the measurements are more likely with an error: both costs with the deviation that
    /// is left with the error in the model. `rows` are those of the receiver. As in the score test:
    /// the tail of the distribution of Beta, and with the spread of the receiver's own residuals,
    /// `None` where few measurements are left over, otherwise with their number.
    pub(crate) fn gain(
        &self,
        with_error: &Observations<D>,
        network: &Network<D>,
        rows: &[usize],
        explained: Option<f64>,
    ) -> Result<Option<(f64, f64)>, CalibrateError<D>> {
        let deviation = inlier_deviation(with_error, network, self.deviation, self.limit).min(self.deviation);
        let before = refit(self.observations, self.base, deviation, self.monitor)?.1;
        let fall = before - truncated_cost(with_error, network, deviation);
        let kept = with_error.all().iter().filter(|o| o.residual(network).abs() <= self.limit * deviation).count();
        let redundancy = kept.saturating_sub(with_error.unknowns());
        if redundancy < 4 {
            return Ok(None);
        }
        let tail = |fall: f64| 0.5 * redundancy as f64 * (2.0 * fall.max(0.0) / redundancy as f64).ln_1p();
        let own = rows.iter().map(|&i| spread_of_receiver(with_error, network, i)).fold(deviation, f64::max);
        let explained = explained.unwrap_or(2.0 * fall * deviation * deviation);
        Ok(Some((tail(fall).min(tail(0.5 * explained / (own * own))), redundancy as f64)))
    }
}

/// One receiver against all transmitters.
struct Local<const D: usize> {
    /// Transmitter, its position, the distance measured, one over its deviation.
    sights: Vec<(usize, [f64; D], f64, f64)>,
    receiver: usize,
    start: [f64; D],
    transmitters: usize,
    deviation: f64,
}

/// A receiver located with its error.
struct LocatedFault<const D: usize> {
    position: [f64; D],
    fault: Fault<D>,
    /// Truncated cost of its measurements.
    cost: f64,
}

impl<const D: usize> Local<D> {
    fn new(observations: &Observations<D>, network: &Network<D>, receiver: usize, deviation: f64) -> Local<D> {
        let sight = |o: &Observation| {
            let j = o.transmitter;
            (j, network.transmitters[j], o.length(network), o.precision)
        };
        Local {
            sights: observations.of_receiver(receiver).map(sight).collect(),
            receiver,
            start: network.receivers[receiver],
            transmitters: observations.transmitters,
            deviation,
        }
    }

    /// Truncated cost of its measurements where it is, without an error.
    fn cost(&self) -> f64 {
        let residual =
            |(_, s, length, precision): &(usize, [f64; D], f64, f64)| (length - distance(self.start, *s)) * precision;
        self.sights.iter().map(|sight| truncated(residual(sight) / self.deviation)).sum()
    }

    /// Located with an error of each kind, but for a move.
    fn all(&self) -> [Option<LocatedFault<D>>; 3] {
        [
            self.locate(Fault::new(self.receiver, ReceiverErrorKind::Delay, 0)),
            self.locate(Fault::new(self.receiver, ReceiverErrorKind::Drift, 0)),
            self.jump(),
        ]
    }

    /// The jump that fits best.
    fn jump(&self) -> Option<LocatedFault<D>> {
        let last = self.sights.len().checked_sub(SIDE).filter(|&last| last > SIDE)?;
        let tried = (last - SIDE + 1).min(JUMPS);
        let at = |k: usize| SIDE + k * (last - SIDE) / tried.max(2).saturating_sub(1);
        let located = (0..tried).filter_map(|k| self.locate(self.fault_at(at(k))));
        let coarse = located.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        if tried == last - SIDE + 1 {
            return Some(coarse);
        }
        let place = self.sights.iter().position(|(j, ..)| *j == coarse.fault.from)?;
        let around = (last - SIDE) / tried + 1;
        let near = (place.saturating_sub(around).max(SIDE)..=(place + around).min(last))
            .filter_map(|k| self.locate(self.fault_at(k)));
        near.chain([coarse]).min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn fault_at(&self, k: usize) -> Fault<D> {
        Fault::new(self.receiver, ReceiverErrorKind::Jump, self.sights[k].0)
    }

    /// Position and size of the error together: reweighted least squares whose loss starts as wide as
    /// the residuals.
    fn locate(&self, mut fault: Fault<D>) -> Option<LocatedFault<D>> {
        let shapes: Vec<f64> = self.sights.iter().map(|s| fault.shape(s.0, self.transmitters)).collect();
        let residual = |k: usize, at: [f64; D], size: f64| {
            let (_, s, length, precision) = self.sights[k];
            (length - size * shapes[k] - distance(at, s)) * precision
        };
        let (mut at, mut size) = (self.start, 0.0);
        let mut sizes: Vec<f64> = (0..shapes.len()).map(|k| residual(k, at, size).abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let least = CAUCHY * self.deviation;
        let mut scale = sizes.get(sizes.len() * 7 / 10)?.max(least);
        for _ in 0..STEPS {
            let loss = Loss { nu: 1.0, scale };
            let (mut h, mut g) = (Bordered::ZERO, ([0.0; D], 0.0));
            for (k, &shape) in shapes.iter().enumerate() {
                let (_, s, _, precision) = self.sights[k];
                let d = distance(at, s).max(1e-300);
                let e = residual(k, at, size);
                let w = loss.weight(e);
                // Derivatives of the residual's opposite.
                let (c, last): Placed<D> = (minus(at, s).map(|x| x / d * precision), shape * precision);
                for a in 0..D {
                    g.0[a] += w * e * c[a];
                    for b in 0..D {
                        h.rows[a][b] += w * c[a] * c[b];
                    }
                    h.border[a] += w * c[a] * last;
                }
                g.1 += w * e * last;
                h.corner += w * last * last;
            }
            for (a, row) in h.rows.iter_mut().enumerate() {
                row[a] *= 1.0 + 1e-6;
            }
            h.corner *= 1.0 + 1e-6;
            let step = solve(&h, g)?;
            at = from_fn(|k| at[k] + step.0[k]);
            size += step.1;
            let moved = step.0.iter().fold(step.1.abs(), |a, b| a.max(b.abs()));
            if scale == least && moved < 1e-3 * self.deviation {
                break;
            }
            scale = (scale * ANNEAL).max(least);
        }
        let cost = (0..shapes.len()).map(|k| truncated(residual(k, at, size) / self.deviation)).sum();
        fault.size[0] = size;
        (at.iter().all(|x| x.is_finite()) && size.is_finite()).then_some(LocatedFault { position: at, fault, cost })
    }
}
