//! Levenberg-Marquardt steps with annealing of the scale, in rounds of reseeding.

use super::cancel::Cancelled;
use super::descent::Descent;
use super::leverage::Leverages;
use super::normal::Normal;
use super::reseed::reseed;
use crate::loss::{CAUCHY, Loss};
use crate::network::Network;
use crate::observations::Observations;
use crate::points::{centroid, dot, minus};
use hc::Monitor;

/// Steps, rounds and tolerance of a search start. Chosen on nearly planar field recordings (6 x 46,
/// 6 x 75, 6 x 132), with milder losses (2 and 4 degrees of freedom): many short rounds found the
/// best network more often per time than few long ones.
pub(crate) const SEARCH: RefineOptions = RefineOptions {
    scale: None,
    anneal_from: None,
    anneal_factor: 0.7,
    by_leverage: false,
    floor: 0.0,
    steps: 15,
    rounds: 6,
    tolerance: 1e-5,
    negligible: 0.0,
};

/// Steps that are worth it together, or are the last ones.
const STRIDE: usize = 5;

/// Steps with residuals of one variance, and the factor on the annealed scale from one to the next.
const STEPS_BY_LEVERAGE: usize = 40;
const FACTOR_BY_LEVERAGE: f64 = 0.91;

/// What the distance of a node from the middle counts beside a residual of the same length, times the scale at which
/// annealing begins.
const PULL: f64 = 0.01;

/// Share of the diagonal that stands for equations of rigid motions in determinants.
const RIGID: f64 = 1e-9;

/// How to refine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct RefineOptions {
    /// Scale of the residuals if it is known (1 when every measurement carries its deviation).
    pub(crate) scale: Option<f64>,
    /// Scale at which annealing begins; `None` to start at the scale of the residuals.
    pub(crate) anneal_from: Option<f64>,
    /// Factor on the annealed scale a step.
    pub(crate) anneal_factor: f64,
    /// Whether residuals are compared by what leverage leaves of them while the scale is annealed.
    pub(crate) by_leverage: bool,
    /// Smallest scale: measurements are never trusted beyond it.
    pub(crate) floor: f64,
    /// Most steps of one minimisation.
    pub(crate) steps: usize,
    /// Most rounds of reseeding, each followed by another minimisation.
    pub(crate) rounds: usize,
    /// Relative decrease of the objective that ends a minimisation.
    pub(crate) tolerance: f64,
    /// Decrease of the objective over [`STRIDE`] steps that ends one as well: along the floor of a valley steps go on and on,
    /// and gain nothing that tells networks apart.
    pub(crate) negligible: f64,
}

/// A refined network.
#[derive(Debug, Clone)]
pub(crate) struct RefinedNetwork<const D: usize = 2> {
    pub(crate) network: Network<D>,
    /// Scale of the residuals.
    pub(crate) scale: f64,
    /// The negative log-likelihood, up to a constant: comparable between networks for the same
    /// measurements.
    pub(crate) objective: f64,
    /// Starts of the search that ended here.
    pub(crate) starts: usize,
}

/// Refines networks for one set of measurements; holds the buffers.
pub(crate) struct NetworkRefiner<'a, const D: usize = 2> {
    observations: &'a Observations<D>,
    nu: f64,
    /// Redundancy: share of the measurements that is left over when the unknowns are determined.
    share: f64,
    /// Standard deviation of distances at an annealed scale of one: that of a typical measurement, metres.
    soft: f64,
    descent: Descent<'a, D>,
    leverages: Leverages<D>,
    monitor: Monitor,
}

impl<'a, const D: usize> NetworkRefiner<'a, D> {
    /// With these degrees of freedom of the loss; infinite for least squares, which needs the scale
    /// to be given.
    ///
    /// A refiner stops within its next step once the monitor is cancelled; what it then returns is not
    /// converged.
    pub(crate) fn new(observations: &'a Observations<D>, nu: f64, monitor: &Monitor) -> Self {
        NetworkRefiner {
            observations,
            nu,
            share: (1.0 - observations.unknowns() as f64 / observations.len().max(1) as f64).max(0.02),
            soft: 1.0 / (CAUCHY * mean_square_precision(observations).sqrt()),
            descent: Descent::new(observations),
            leverages: Leverages::default(),
            monitor: monitor.clone(),
        }
    }

    /// The best network near `start`, which must be complete and finite.
    pub(crate) fn refine(&mut self, start: Network<D>, options: &RefineOptions) -> RefinedNetwork<D> {
        let again = RefineOptions { anneal_from: None, ..*options };
        let mut best = match options.anneal_from {
            Some(from) if options.by_leverage => {
                let network = self.descend(start, from, options);
                self.minimise(network, &again)
            }
            _ => self.minimise(start, options),
        };
        for _ in 0..options.rounds {
            if self.monitor.is_cancelled() {
                break;
            }
            let mut network = best.network.clone();
            let loss = Loss { nu: self.nu, scale: best.scale };
            if reseed(self.observations, &mut network, &loss, &self.monitor).unwrap_or(0) == 0 {
                break;
            }
            let next = self.minimise(network, &again);
            let gain = best.objective - next.objective;
            if gain > 0.0 {
                best = next;
            }
            if gain < 1e-6 * best.objective.abs() {
                break;
            }
        }
        best
    }

    /// Goes down from a network that may be far from the best one while the scale shrinks from this one on, by residuals of
    /// one variance. That all nodes are pulled a little to the middle of the receivers, where these are at first, keeps
    /// networks with wrong clocks from growing beyond all bounds.
    fn descend(&mut self, mut network: Network<D>, from: f64, options: &RefineOptions) -> Network<D> {
        let NetworkRefiner { observations, soft, ref monitor, ref mut descent, ref mut leverages, .. } = *self;
        descent.begin(&mut network);
        leverages.begin(observations);
        let weight = Loss { nu: self.nu, scale: 1.0 }.weight(0.0);
        let pull = weight * (PULL * mean_square_precision(observations) / from).powi(2);
        let centre = centroid(network.receivers.iter());
        let mut annealed = from;
        for _ in 0..STEPS_BY_LEVERAGE {
            let loss = Loss { nu: self.nu, scale: options.scale.unwrap_or(0.0).max(annealed).max(options.floor) };
            let total = |residuals: &[f64], network: &Network<D>| {
                let (cells, pins) = residuals.split_at(observations.len());
                leverages.total(&loss, cells)
                    + loss.total(pins.iter().copied())
                    + 0.5 * pull * squares(network, centre) / loss.scale.powi(2)
                    + observations.unexpected(network, &loss, soft * annealed)
            };
            let cost = total(&descent.residuals, &network);
            let (terms, pin_terms) = (|k, e| (leverages.weight(&loss, k, e), e), |e| (loss.weight(e), e));
            descent.normal.linearise_by(observations, &network, &descent.residuals, terms, pin_terms);
            descent.normal.expect(observations, &network, &loss, soft * annealed);
            descent.normal.pull_together(&network, centre, pull);
            match descent.step_down(&mut network, cost, 1e-14, total, monitor) {
                Err(_) => break,
                Ok(None) => {}
                Ok(Some(_)) => leverages.look(observations, &descent.normal),
            }
            annealed *= FACTOR_BY_LEVERAGE;
        }
        network
    }

    fn minimise(&mut self, mut network: Network<D>, options: &RefineOptions) -> RefinedNetwork<D> {
        let NetworkRefiner { observations, share, soft, ref monitor, ref mut descent, .. } = *self;
        descent.begin(&mut network);
        let mut annealed = options.anneal_from.unwrap_or(0.0);
        let mut loss = Loss { nu: self.nu, scale: 1.0 };
        loss.scale = match options.scale {
            Some(scale) => scale.max(annealed),
            None => {
                loss.scale = mean_size(&descent.residuals).max(options.floor);
                fit_scale(&descent.residuals, &loss, share, 20).max(annealed).max(options.floor)
            }
        };
        let total = |loss: &Loss, annealed: f64, residuals: &[f64], network: &Network<D>| {
            loss.total(residuals.iter().copied()) + observations.unexpected(network, loss, soft * annealed)
        };
        let mut cost = total(&loss, annealed, &descent.residuals, &network);
        let (mut calm, mut gained) = (0, 0.0);
        for step in 1..=options.steps {
            if monitor.is_cancelled() {
                break;
            }
            descent.normal.linearise(observations, &network, &descent.residuals, &loss, soft * annealed);
            let by = |residuals: &[f64], network: &Network<D>| total(&loss, annealed, residuals, network);
            let Ok(lower) = descent.step_down(&mut network, cost, 1e-14, by, monitor) else { break };
            let gain = lower.map_or(0.0, |next| cost - next);
            let improved = gain > options.tolerance * cost.abs();
            gained += gain;
            annealed *= options.anneal_factor;
            let before = loss.scale;
            loss.scale = match options.scale {
                Some(scale) => scale.max(annealed),
                None => fit_scale(&descent.residuals, &loss, share, 2).max(annealed).max(options.floor),
            };
            cost = total(&loss, annealed, &descent.residuals, &network);
            let settled = (loss.scale - before).abs() <= 1e-4 * loss.scale;
            calm = if improved || !settled { 0 } else { calm + 1 };
            if calm == 2 || (step % STRIDE == 0 && gained < options.negligible) {
                break;
            }
            if step % STRIDE == 0 {
                gained = 0.0;
            }
        }
        let objective = cost + self.constant(loss.scale);
        RefinedNetwork { network, scale: loss.scale, objective, starts: 1 }
    }

    /// The part of the objective that depends on the scale alone.
    pub(crate) fn constant(&self, scale: f64) -> f64 {
        self.observations.len() as f64 * self.share * scale.ln()
    }

    /// The normal equations at `network`, undamped, with the weights of `loss`.
    pub(crate) fn normal_at(&mut self, network: &Network<D>, loss: &Loss) -> Result<&Normal<D>, Cancelled> {
        let descent = &mut self.descent;
        descent.look(network);
        descent.normal.linearise(self.observations, network, &descent.residuals, loss, 0.0);
        descent.normal.reduce(self.observations, 0.0, &self.monitor)?;
        Ok(&descent.normal)
    }

    /// Logarithm of the determinant of the normal equations of least squares at `network`. What rigid motions add
    /// hardly depends on the network. `None` if the equations are singular.
    pub(crate) fn log_determinant_at(&mut self, network: &Network<D>) -> Result<Option<f64>, Cancelled> {
        let descent = &mut self.descent;
        descent.look(network);
        let loss = Loss { nu: f64::INFINITY, scale: 1.0 };
        descent.normal.linearise(self.observations, network, &descent.residuals, &loss, 0.0);
        descent.normal.log_determinant(self.observations, RIGID, &self.monitor)
    }

    /// Those equations again.
    pub(crate) fn normal(&self) -> &Normal<D> {
        &self.descent.normal
    }
}

fn mean_square_precision<const D: usize>(observations: &Observations<D>) -> f64 {
    let squares: f64 = observations.all().iter().map(|o| o.precision * o.precision).sum();
    squares / observations.len().max(1) as f64
}

/// Sum of the squares of the distances of all nodes from a point.
fn squares<const D: usize>(network: &Network<D>, from: [f64; D]) -> f64 {
    network.receivers.iter().chain(&network.transmitters).map(|p| dot(minus(*p, from), minus(*p, from))).sum()
}

/// Maximum likelihood of the scale at fixed residuals, by a few fixed-point steps s^2 = sum w e^2 /
/// sum w.
fn fit_scale(residuals: &[f64], loss: &Loss, share: f64, steps: usize) -> f64 {
    let mut loss = *loss;
    for _ in 0..steps {
        let (mut top, mut bottom) = (0.0, 0.0);
        for &e in residuals {
            let w = loss.weight(e);
            top += w * e * e;
            bottom += w;
        }
        let scale = (top / (bottom * share)).sqrt();
        if !(scale > 0.0 && scale.is_finite()) {
            break;
        }
        loss.scale = scale;
    }
    loss.scale
}

fn mean_size(residuals: &[f64]) -> f64 {
    residuals.iter().map(|e| e.abs()).sum::<f64>() / residuals.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::align::align;
    use crate::loss::SEARCH_NU;
    use crate::network::tests::random;
    use crate::pseudoranges::Pseudoranges;
    use crate::simulate::{SimulateOptions, simulate};

    /// Exact data, from places a tenth of the network's size away: the truth is the only network whose
    /// residuals are all zero near it.
    fn the_truth_is_found_from_near_it<const D: usize>(receivers: usize, transmitters: usize) {
        for seed in 0..20 {
            let truth: Network<D> = random(receivers, transmitters, seed);
            let measured = Pseudoranges::new(receivers, transmitters, truth.pseudoranges()).unwrap();
            let observations = Observations::<D>::new(&measured, |_, _| true);
            let by: Network<D> = random(receivers, transmitters, 1000 + seed);
            let mut start = truth.clone();
            let points = start.receivers.iter_mut().chain(&mut start.transmitters);
            for (p, by) in points.zip(by.receivers.iter().chain(&by.transmitters)) {
                p.iter_mut().zip(by).for_each(|(x, by)| *x += 0.1 * by);
            }
            let options =
                RefineOptions { scale: Some(1e-3), anneal_from: Some(0.3), steps: 60, tolerance: 1e-12, ..SEARCH };
            let found = NetworkRefiner::new(&observations, SEARCH_NU, &Monitor::default()).refine(start, &options);
            let error = align(&found.network.receivers, &truth.receivers, false).unwrap().rms;
            assert!(found.network.rms(&measured) < 1e-7 && error < 1e-5, "seed {seed}: {error}");
        }
    }

    #[test]
    fn the_truth_is_found_from_near_it_in_plane_and_space() {
        the_truth_is_found_from_near_it::<2>(8, 10);
        the_truth_is_found_from_near_it::<3>(10, 12);
    }

    #[test]
    fn a_cancelled_refinement_goes_no_further() {
        let simulation = simulate(&SimulateOptions { noise: 0.1, ..Default::default() }).unwrap();
        let observations = Observations::new(&simulation.pseudoranges, |_, _| true);
        let monitor = Monitor::watched();
        let refined =
            || NetworkRefiner::new(&observations, SEARCH_NU, &monitor).refine(simulation.network.clone(), &SEARCH);
        assert_ne!(refined().network, simulation.network);
        monitor.cancel();
        assert_eq!(refined().network, simulation.network);
    }
}
