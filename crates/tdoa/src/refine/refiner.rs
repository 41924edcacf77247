//! Levenberg-Marquardt steps with annealing of the scale, in rounds of reseeding.

use super::cancel::Cancelled;
use super::descent::Descent;
use super::normal::Normal;
use super::reseed::reseed;
use crate::clocks::ClockPrior;
use crate::loss::Loss;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Steps, rounds and tolerance of a search start. Chosen on nearly planar field recordings (6 x 46,
/// 6 x 75, 6 x 132), with milder losses (2 and 4 degrees of freedom): many short rounds found the
/// best network more often per time than few long ones.
pub(crate) const SEARCH: RefineOptions = RefineOptions {
    scale: None,
    anneal_from: None,
    anneal_factor: 0.7,
    floor: 0.0,
    steps: 15,
    rounds: 6,
    tolerance: 1e-5,
};

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
    /// Smallest scale: measurements are never trusted beyond it.
    pub(crate) floor: f64,
    /// Most steps of one minimisation.
    pub(crate) steps: usize,
    /// Most rounds of reseeding, each followed by another minimisation.
    pub(crate) rounds: usize,
    /// Relative decrease of the objective that ends a minimisation.
    pub(crate) tolerance: f64,
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
    descent: Descent<'a, D>,
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
            descent: Descent::new(observations),
            monitor: monitor.clone(),
        }
    }

    /// The best network near `start`, which must be complete and finite.
    pub(crate) fn refine(&mut self, start: Network<D>, options: &RefineOptions) -> RefinedNetwork<D> {
        let mut best = self.minimise(start, options);
        let again = RefineOptions { anneal_from: None, ..*options };
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

    fn minimise(&mut self, mut network: Network<D>, options: &RefineOptions) -> RefinedNetwork<D> {
        let NetworkRefiner { observations, share, ref monitor, ref mut descent, .. } = *self;
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
        let total = |loss: &Loss, residuals: &[f64], network: &Network<D>| {
            loss.total(residuals.iter().copied()) + unexpected(observations, network, loss)
        };
        let mut cost = total(&loss, &descent.residuals, &network);
        let mut calm = 0;
        for _ in 0..options.steps {
            if monitor.is_cancelled() {
                break;
            }
            descent.normal.linearise(observations, &network, &descent.residuals, &loss);
            let by = |residuals: &[f64], network: &Network<D>| total(&loss, residuals, network);
            let Ok(lower) = descent.step_down(&mut network, cost, 1e-14, by, monitor) else { break };
            let improved = lower.is_some_and(|next| cost - next > options.tolerance * cost.abs());
            annealed *= options.anneal_factor;
            let before = loss.scale;
            loss.scale = match options.scale {
                Some(scale) => scale.max(annealed),
                None => fit_scale(&descent.residuals, &loss, share, 2).max(annealed).max(options.floor),
            };
            cost = total(&loss, &descent.residuals, &network);
            let settled = (loss.scale - before).abs() <= 1e-4 * loss.scale;
            calm = if improved || !settled { 0 } else { calm + 1 };
            if calm == 2 {
                break;
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
        descent.normal.linearise(self.observations, network, &descent.residuals, loss);
        descent.normal.reduce(self.observations, 0.0, &self.monitor)?;
        Ok(&descent.normal)
    }

    /// Logarithm of the determinant of the normal equations of least squares at `network`. What rigid motions add
    /// hardly depends on the network. `None` if the equations are singular.
    pub(crate) fn log_determinant_at(&mut self, network: &Network<D>) -> Result<Option<f64>, Cancelled> {
        let descent = &mut self.descent;
        descent.look(network);
        let loss = Loss { nu: f64::INFINITY, scale: 1.0 };
        descent.normal.linearise(self.observations, network, &descent.residuals, &loss);
        descent.normal.log_determinant(self.observations, RIGID, &self.monitor)
    }

    /// Those equations again.
    pub(crate) fn normal(&self) -> &Normal<D> {
        &self.descent.normal
    }
}

/// What it costs, by this loss, that clocks are not as expected.
fn unexpected<const D: usize>(observations: &Observations<D>, network: &Network<D>, loss: &Loss) -> f64 {
    let of = |prior: &ClockPrior| loss.prior_weight(prior.deviation()) / loss.scale.powi(2) * prior.misfit(network);
    observations.clocks().prior().map_or(0.0, of)
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
