//! Calibration where errors only lengthen: detours of sound and radio, late detections.
//!
//! The loss is the negative log-likelihood of a mixture of on-time and late measurements. Its
//! shares, lengths and deviation are estimated from the residuals, in turns with the network.

use crate::calibrate::options::{CalibrateError, CalibrateOptions, Errors, check};
use crate::calibrate::search::deviation::{inlier_deviation, spread_of_residuals};
use crate::calibrate::search::mixture::Mixture;
use crate::calibrate::search::propagation::{Propagated, propagated};
use crate::calibrate::search::same_network::merged;
use crate::calibrate::state::State;
use crate::network::Network;
use crate::observations::Observations;
use crate::refine::{Cost, RefinedNetwork, Weighing};
use hc::Monitor;

/// Turns of estimating the mixture and refining the network, fewest turns, steps of the network in
/// each, and in the end.
const TURNS: usize = 60;
const LEAST_TURNS: usize = 10;
const STEPS: usize = 2;
const LAST: usize = 40;

/// Narrowest deviation that is tried, as a share of the widest one, factor from one to the next, and
/// turns of each.
const NARROWEST: f64 = 1e-3;
const NARROWING: f64 = 0.8;
const NARROW_TURNS: usize = 8;

/// Share of the measurements on time that must be left over.
const LEFT_OVER: f64 = 0.15;

/// Share of the deviation of the likeliest network that its mean may leave.
const LEAST_LEFT: f64 = 0.1;

/// Share of measurements that are late or gross, above which they do not fit; and how many of those on
/// time must be left over to tell a network with wide noise from one with late measurements (of thirty
/// of 8r/12s with 30 % late one is wrong, with 32 left over).
const MOST_WRONG: f64 = 0.6;
pub(crate) const LEAST_REDUNDANCY: usize = 40;

/// Networks that are kept.
const MOST: usize = 12;

impl Cost for Mixture {
    fn cost(&self, residual: f64) -> f64 {
        Mixture::cost(self, residual)
    }

    fn terms(&self, residual: f64) -> (f64, f64) {
        Mixture::terms(self, residual)
    }

    fn deviation(&self) -> f64 {
        self.deviation
    }
}

fn residuals<const D: usize>(observations: &Observations<D>, network: &Network<D>) -> Vec<f64> {
    observations.all().iter().map(|o| o.residual(network)).collect()
}

/// The mixture that the residuals of a network have; `first` is near its deviation.
pub(crate) fn mixture_of<const D: usize>(observations: &Observations<D>, network: &Network<D>, first: f64) -> Mixture {
    Mixture::first(first).fitted(&residuals(observations, network), observations.unknowns(), 0.1 * first)
}

/// Deviation of the measurements at a network, beside what is wrong with them; `first` is near it.
pub(crate) fn noise<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    first: f64,
    options: &CalibrateOptions<D>,
) -> f64 {
    match options.errors {
        Errors::Auto | Errors::Symmetric => inlier_deviation(observations, network, first, options.inlier_threshold),
        Errors::OneSided => mixture_of(observations, network, first).deviation,
    }
}

/// Refines networks with the loss of one-sided errors, and puts the most likely first; and the
/// deviation of the noise. Objectives are differences of log-likelihood.
pub(crate) fn finish_one_sided<const D: usize>(
    state: &State<'_, D>,
    observations: &Observations<D>,
    networks: Vec<RefinedNetwork<D>>,
    first: f64,
) -> Result<(Vec<RefinedNetwork<D>>, f64), CalibrateError<D>> {
    let (monitor, floor) = (state.monitor, state.floor);
    let known = state.known.map(|_| first);
    let least = known.unwrap_or(floor).max(floor);
    let mut fitting = Fitting { observations, weighing: Weighing::new(observations, monitor), least, known, monitor };
    let mut ranked: Vec<RefinedNetwork<D>> = Vec::new();
    // The widest is the same for all, so that gross errors have one density.
    let wide = networks.iter().map(|refined| spread_of_residuals(observations, &refined.network));
    let wide = wide.fold(f64::INFINITY, f64::min).max(first).max(least);
    for refined in networks {
        let fits = fitting.narrowed((refined.network.clone(), Mixture::first(wide)))?;
        let before = ranked.len();
        for (k, (network, mixture)) in fits.into_iter().enumerate() {
            // The first is there where no other is.
            if network.is_finite() && (k == 0 || fitting.determined(&mixture)) {
                let objective = fitting.objective(&network, &mixture)?;
                ranked.push(RefinedNetwork { network, scale: mixture.deviation, objective, starts: 0 });
            }
        }
        // Its starts ended in the likelier fit.
        let likelier = ranked[before..].iter_mut().min_by(|a, b| a.objective.total_cmp(&b.objective));
        likelier.into_iter().for_each(|fit| fit.starts = refined.starts);
    }
    ranked.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    // They were apart only for as long as late measurements counted as noise.
    let mut ranked = merged(ranked, |refined| refined);
    ranked.truncate(MOST);
    let Some(best) = ranked.first() else { return Err(CalibrateError::NotFound(0)) };
    let mut deviation = best.scale;
    for (k, refined) in ranked.iter_mut().enumerate() {
        let mixture = Mixture { deviation: refined.scale, ..Mixture::first(wide) };
        let mixture = mixture.fitted(&residuals(observations, &refined.network), observations.unknowns(), least);
        if let Some(found) = fitting.mean(&refined.network, mixture)? {
            refined.network = found.network;
            refined.scale = found.mixture.deviation;
            if k == 0 {
                deviation = found.mixture.deviation;
            }
        }
    }
    Ok((ranked, deviation))
}

/// A network with the mixture that its residuals have.
type Fit<const D: usize> = (Network<D>, Mixture);

/// Refines networks and mixtures in turns; holds the buffers.
struct Fitting<'a, const D: usize> {
    observations: &'a Observations<D>,
    weighing: Weighing<'a, D>,
    /// Smallest deviation.
    least: f64,
    known: Option<f64>,
    monitor: &'a Monitor,
}

impl<const D: usize> Fitting<'_, D> {
    /// The fits from a wide deviation and from the best of narrower ones: late measurements have bent
    /// a network, and count as noise for as long as the deviation is as wide as they are late.
    fn narrowed(&mut self, wide: Fit<D>) -> Result<Vec<Fit<D>>, CalibrateError<D>> {
        let mut found = vec![self.settled(wide.clone())?];
        let (mut network, mut mixture) = wide;
        let end = (NARROWEST * mixture.deviation).max(self.least);
        let mut narrow: Option<(Fit<D>, f64)> = None;
        while mixture.deviation > end {
            mixture.deviation = (NARROWING * mixture.deviation).max(end);
            for _ in 0..NARROW_TURNS {
                check(self.monitor)?;
                network = self.weighing.descend(network, STEPS, &mixture)?;
                let next = mixture.updated(self.weighing.residuals(), self.observations.unknowns(), self.least);
                mixture = Mixture { deviation: mixture.deviation, ..next };
            }
            if !self.determined(&mixture) {
                break;
            }
            let objective = self.objective(&network, &mixture)?;
            if narrow.as_ref().is_none_or(|(_, least)| objective < *least) {
                narrow = Some(((network.clone(), mixture), objective));
            }
        }
        if let Some((narrow, _)) = narrow {
            found.push(self.settled(narrow)?);
        }
        Ok(found)
    }

    /// The fit near this one in which both are stationary.
    fn settled(&mut self, (mut network, mut mixture): Fit<D>) -> Result<Fit<D>, CalibrateError<D>> {
        for turn in 0..TURNS {
            check(self.monitor)?;
            network = self.weighing.descend(network, STEPS, &mixture)?;
            let next = mixture.updated(self.weighing.residuals(), self.observations.unknowns(), self.least);
            let calm = (next.deviation - mixture.deviation).abs() < 1e-4 * mixture.deviation;
            mixture = next;
            if calm && turn >= LEAST_TURNS {
                break;
            }
        }
        Ok((self.weighing.descend(network, LAST, &mixture)?, mixture))
    }

    /// Whether enough measurements are on time to determine a network and its deviation: any network
    /// fits as many as it has unknowns.
    fn determined(&self, mixture: &Mixture) -> bool {
        let on_time = mixture.punctual() * self.observations.len() as f64;
        on_time - self.observations.unknowns() as f64 >= LEFT_OVER * on_time
    }

    /// The mean of the networks about a likely one, and the deviation. `None` where it is not near.
    fn mean(&mut self, network: &Network<D>, mixture: Mixture) -> Result<Option<Propagated<D>>, CalibrateError<D>> {
        let least = self.least.max(LEAST_LEFT * mixture.deviation);
        let mut found = propagated(self.observations, network, mixture, None, least, true, self.monitor)?;
        // A given deviation is for networks that are near.
        if let (Some(free), Some(_)) = (&found, self.known) {
            let known =
                propagated(self.observations, &free.network, free.mixture, self.known, least, true, self.monitor)?;
            found = known.or(found);
        }
        let Some(found) = found else { return Ok(None) };
        let farther = self.objective(&found.network, &found.mixture)? - self.objective(network, &found.mixture)?;
        let is_near = farther <= self.observations.unknowns() as f64 && self.determined(&found.mixture);
        Ok(is_near.then_some(found))
    }

    /// Negative log-likelihood of the measurements with the unknowns integrated out (Laplace's
    /// approximation), but for what all fits have in common.
    fn objective(&mut self, network: &Network<D>, mixture: &Mixture) -> Result<f64, CalibrateError<D>> {
        let observations = self.observations;
        let pins = observations.pins().iter().map(|pin| 0.5 * (pin.residual(network) / mixture.deviation).powi(2));
        let cells = observations.all().iter().map(|o| mixture.cost(o.residual(network)));
        let left = observations.len().saturating_sub(observations.unknowns()) as f64;
        let volume = self.weighing.log_determinant(network, mixture)?.unwrap_or(f64::INFINITY);
        let known = pins.sum::<f64>() + observations.misfit(network, false);
        Ok(cells.sum::<f64>() + known + left * mixture.deviation.ln() + 0.5 * volume)
    }
}

/// What the measurements say of a network while it is not known which of them are late.
pub(crate) struct Information<const D: usize> {
    /// The measurements with the share of their information that is left.
    pub(crate) trusted: Observations<D>,
    /// The mixture that they are, its deviation estimated.
    pub(crate) mixture: Mixture,
}

impl<const D: usize> Information<D> {
    /// At a network with measurements of about this deviation, which may be known.
    pub(crate) fn new(
        observations: &Observations<D>,
        network: &Network<D>,
        first: f64,
        known: Option<f64>,
        monitor: &Monitor,
    ) -> Result<Information<D>, CalibrateError<D>> {
        let mixture = mixture_of(observations, network, first);
        let shares = match propagated(observations, network, mixture, known, LEAST_LEFT * first, false, monitor)? {
            Some(found) => found.weights,
            None => observations.all().iter().map(|o| mixture.on_time(o.residual(network))).collect(),
        };
        Ok(Information { trusted: observations.trusted(&shares), mixture })
    }

    /// Whether most measurements are on time, and enough of them to say so.
    pub(crate) fn fits(&self, redundancy: usize) -> bool {
        let wrong = self.mixture.share + self.mixture.gross;
        wrong <= MOST_WRONG && redundancy >= LEAST_REDUNDANCY
    }
}

#[cfg(test)]
mod tests {
    use crate::accuracy::cramer_rao;
    use crate::align::align;
    use crate::calibrate::SAME_NETWORK;
    use crate::{CalibrateError, CalibrateOptions, Calibration, Errors, ReceiverClocks, ReceiverDelays};
    use crate::{Layout, SimulateOptions, Simulation, calibrate, simulate};

    const SIGMA: f64 = 0.01;

    fn simulated(receivers: usize, transmitters: usize, detours: f64, seed: u64) -> Simulation {
        let mut options = SimulateOptions { receivers, transmitters, noise: SIGMA, seed, ..Default::default() };
        (options.detours, options.detour_size) = (detours, 0.5);
        simulate(&options).unwrap()
    }

    fn calibrated(simulation: &Simulation, sigma: Option<f64>) -> Calibration {
        let options = CalibrateOptions { errors: Errors::OneSided, sigma, ..Default::default() };
        calibrate(&simulation.pseudoranges, &options).unwrap()
    }

    /// How far the receivers are from the truth, over the Cramer-Rao bound of the measurements on time
    /// (which nobody knows), and half of the mean square in terms of their covariances.
    fn error(found: &Calibration, simulation: &Simulation) -> (f64, f64) {
        let truth = &simulation.network;
        let bound = cramer_rao(&simulation.pseudoranges, &simulation.outliers, truth, SIGMA);
        let receivers: Vec<[f64; 2]> = found.receivers.iter().map(|p| p.unwrap()).collect();
        let alignment = align(&truth.receivers, &receivers, false).unwrap();
        let mut sum = 0.0;
        for ((p, q), c) in receivers.iter().zip(&truth.receivers).zip(&found.receiver_covariance) {
            let (q, c) = (alignment.transform.apply(*q), c.unwrap());
            let (x, y) = (p[0] - q[0], p[1] - q[1]);
            let square = c[1][1] * x * x - 2.0 * c[0][1] * x * y + c[0][0] * y * y;
            sum += square / (c[0][0] * c[1][1] - c[0][1] * c[1][0]);
        }
        (alignment.rms / bound, sum / (2.0 * receivers.len() as f64))
    }

    #[test]
    fn a_third_of_late_measurements_costs_little() {
        let mut sum = 0.0;
        for seed in 0..8 {
            let simulation = simulated(12, 40, 0.3, seed);
            let found = calibrated(&simulation, None);
            let (ratio, square) = error(&found, &simulation);
            assert!(ratio < 3.0 && found.unique, "seed {seed}: {ratio} {:?}", found.warnings);
            assert!(found.receiver_errors.is_empty(), "seed {seed}: {:?}", found.receiver_errors);
            sum += square / 8.0;
        }
        // One in the mean, if the covariances are right: three deviations of the mean of eight
        // networks, of one each at most, are 1.06.
        assert!(sum < 2.06, "{sum}");
    }

    #[test]
    fn half_of_the_measurements_may_be_late() {
        for seed in 0..6 {
            let simulation = simulated(12, 40, 0.5, seed);
            let [free, given] = [None, Some(SIGMA)].map(|sigma| error(&calibrated(&simulation, sigma), &simulation).0);
            assert!(free < 5.0 && given < 5.0, "seed {seed}: {free} {given}");
            // Without the deviation, the symmetric loss takes late measurements for noise.
            let options = CalibrateOptions { errors: Errors::Symmetric, ..Default::default() };
            let symmetric = calibrate(&simulation.pseudoranges, &options).unwrap();
            let other = error(&symmetric, &simulation).0;
            assert!(free < 0.5 * other, "seed {seed}: {free} {other}");
        }
    }

    /// In the search a given deviation would leave few measurements of a bent network.
    #[test]
    fn a_given_deviation_does_not_keep_the_search_from_rooms() {
        let mut right = 0;
        for seed in 0..4 {
            let mut made = SimulateOptions::<3>::new();
            (made.receivers, made.transmitters, made.noise, made.seed) = (10, 30, SIGMA, seed);
            (made.detours, made.detour_size) = (0.3, 1.5);
            made.layout = Layout::Room { extent: [10.0, 8.0, 3.0] };
            let made = simulate(&made).unwrap();
            let options =
                CalibrateOptions { errors: Errors::OneSided, sigma: Some(SIGMA), ..CalibrateOptions::<3>::new() };
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let pairs = found.receivers.iter().zip(&made.network.receivers).filter_map(|(p, q)| Some(((*p)?, *q)));
            let (found_at, known): (Vec<_>, Vec<_>) = pairs.unzip();
            let error = align(&found_at, &known, false).map_or(f64::INFINITY, |a| a.rms);
            let is_right = found_at.len() == 10 && error < 5.0 * SIGMA;
            assert!(is_right || found.distrust().is_some(), "seed {seed}: {error}");
            right += usize::from(is_right);
        }
        assert!(right >= 3, "{right} of 4");
    }

    #[test]
    fn where_nothing_is_late_nothing_is_lost() {
        for seed in 0..6 {
            let simulation = simulated(8, 20, 0.0, seed);
            let found = calibrated(&simulation, None);
            let (ratio, square) = error(&found, &simulation);
            assert!(ratio < 3.0 && square < 4.0 && found.unique, "seed {seed}: {ratio} {square} {:?}", found.warnings);
        }
    }

    #[test]
    fn what_cannot_be_told_is_not_unique() {
        // Eight of ten measurements are late, of networks with fewer on time than unknowns.
        for seed in 0..3 {
            let simulation = simulated(8, 14, 0.8, seed);
            let found = calibrated(&simulation, None);
            let truth = &simulation.network;
            let pairs = found.receivers.iter().zip(&truth.receivers).filter_map(|(p, q)| Some(((*p)?, *q)));
            let (found_at, known): (Vec<_>, Vec<_>) = pairs.unzip();
            let near = align(&found_at, &known, false).is_some_and(|a| a.rms <= SAME_NETWORK * truth.size());
            assert!(near || !found.unique, "seed {seed}: {:?}", found.warnings);
        }
    }

    #[test]
    fn delays_of_receivers_are_refused_beside() {
        let simulation = simulated(8, 20, 0.3, 1);
        let mut delays = CalibrateOptions { errors: Errors::OneSided, ..Default::default() };
        let mut clocks = delays.clone();
        delays.receiver_delays = ReceiverDelays::Auto;
        clocks.clocks.receivers = ReceiverClocks::Offset;
        for options in [delays, clocks] {
            assert_eq!(calibrate(&simulation.pseudoranges, &options), Err(CalibrateError::OneSidedDelays));
        }
    }
}
