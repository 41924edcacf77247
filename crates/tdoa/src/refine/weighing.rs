//! Levenberg-Marquardt steps for any cost of single residuals.

use super::cancel::{Cancelled, check};
use super::normal::Normal;
use super::refiner::residuals;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Damping that makes the determinant of a free network finite.
const GAUGE: f64 = 1e-9;

/// A cost of residuals.
pub(crate) trait Cost {
    /// The cost of the residual of a measurement.
    fn cost(&self, residual: f64) -> f64;
    /// A weight for the normal equations, and the residual that has the derivative of the cost with
    /// that weight.
    fn terms(&self, residual: f64) -> (f64, f64);
    /// Deviation of the residuals, which those of known coordinates have too.
    fn deviation(&self) -> f64;
}

/// Refines networks for one set of measurements; holds the buffers.
pub(crate) struct Weighing<'a, const D: usize = 2> {
    observations: &'a Observations<D>,
    normal: Normal<D>,
    residuals: Vec<f64>,
    trial_residuals: Vec<f64>,
    trial: Network<D>,
    monitor: &'a Monitor,
}

impl<'a, const D: usize> Weighing<'a, D> {
    /// Fails in all it does once the monitor is cancelled.
    pub(crate) fn new(observations: &'a Observations<D>, monitor: &'a Monitor) -> Self {
        let count = observations.len() + observations.pins().len();
        Weighing {
            observations,
            normal: Normal::new(observations),
            residuals: vec![0.0; count],
            trial_residuals: vec![0.0; count],
            trial: Network::default(),
            monitor,
        }
    }

    /// At most so many steps down the sum of the costs, from a network that is complete and finite.
    /// The residuals of the measurements where it ends are left in [`Weighing::residuals`].
    pub(crate) fn descend(
        &mut self,
        mut network: Network<D>,
        steps: usize,
        cost: &impl Cost,
    ) -> Result<Network<D>, Cancelled> {
        let observations = self.observations;
        let precision = 1.0 / (cost.deviation() * cost.deviation());
        let total = |residuals: &[f64]| -> f64 {
            let (cells, pins) = residuals.split_at(observations.len());
            cells.iter().map(|&e| cost.cost(e)).sum::<f64>() + pins.iter().map(|e| 0.5 * precision * e * e).sum::<f64>()
        };
        self.trial.clone_from(&network);
        residuals(observations, &network, &mut self.residuals);
        let mut now = total(&self.residuals);
        let mut damping = 1e-3;
        for _ in 0..steps {
            check(self.monitor)?;
            let terms = |_, e| cost.terms(e);
            self.normal.linearise_by(observations, &network, &self.residuals, terms, |e| (precision, e));
            let before = now;
            while damping < 1e8 {
                if self.normal.solve(observations, damping, self.monitor)? {
                    self.normal.step(&network, &mut self.trial);
                    residuals(observations, &self.trial, &mut self.trial_residuals);
                    let next = total(&self.trial_residuals);
                    if next < now {
                        damping = (damping * 0.2).max(1e-9);
                        std::mem::swap(&mut network, &mut self.trial);
                        std::mem::swap(&mut self.residuals, &mut self.trial_residuals);
                        now = next;
                        break;
                    }
                }
                damping = (damping * 6.0).max(1e-6);
            }
            damping = damping.min(1e2);
            if before - now <= 1e-10 * before.abs() {
                break;
            }
        }
        Ok(network)
    }

    /// One step of least squares with a weight for each measurement and what its residual should be;
    /// `None` where it is not determined.
    pub(crate) fn step(
        &mut self,
        network: &Network<D>,
        weights: &[f64],
        targets: &[f64],
    ) -> Result<Option<Network<D>>, Cancelled> {
        let observations = self.observations;
        residuals(observations, network, &mut self.residuals);
        let terms = |k: usize, e: f64| (weights[k], e - targets[k]);
        self.normal.linearise_by(observations, network, &self.residuals, terms, |e| (1.0, e));
        self.trial.clone_from(network);
        Ok(self.normal.solve(observations, GAUGE, self.monitor)?.then(|| {
            self.normal.step(network, &mut self.trial);
            self.trial.clone()
        }))
    }

    /// Logarithm of the determinant of the normal equations at a network, in units of the deviation;
    /// `None` where they are singular.
    pub(crate) fn log_determinant(&mut self, network: &Network<D>, cost: &impl Cost) -> Result<Option<f64>, Cancelled> {
        let observations = self.observations;
        residuals(observations, network, &mut self.residuals);
        let square = cost.deviation() * cost.deviation();
        let terms = |_, e| {
            let (weight, target) = cost.terms(e);
            (square * weight, target)
        };
        self.normal.linearise_by(observations, network, &self.residuals, terms, |e| (1.0, e));
        self.normal.log_determinant(observations, GAUGE, self.monitor)
    }

    /// Residuals of the measurements where the last descent ended.
    pub(crate) fn residuals(&self) -> &[f64] {
        &self.residuals[..self.observations.len()]
    }
}
