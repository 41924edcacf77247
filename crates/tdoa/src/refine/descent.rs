//! Levenberg-Marquardt: steps of damped normal equations down a cost of the residuals.

use super::cancel::Cancelled;
use super::normal::Normal;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Damping of the first step, and least damping.
const FIRST: f64 = 1e-3;
const LEAST: f64 = 1e-9;

/// Damping from which on a step is no more tried, and that with which the next one begins at most.
const HOPELESS: f64 = 1e8;
const MOST: f64 = 1e2;

/// The buffers of a descent, and its damping.
pub(super) struct Descent<'a, const D: usize> {
    pub(super) observations: &'a Observations<D>,
    pub(super) normal: Normal<D>,
    /// Residuals at the network.
    pub(super) residuals: Vec<f64>,
    trial_residuals: Vec<f64>,
    pub(super) trial: Network<D>,
    damping: f64,
}

impl<'a, const D: usize> Descent<'a, D> {
    pub(super) fn new(observations: &'a Observations<D>) -> Self {
        let count = observations.len() + observations.pins().len();
        Descent {
            observations,
            normal: Normal::new(observations),
            residuals: vec![0.0; count],
            trial_residuals: vec![0.0; count],
            trial: Network::default(),
            damping: FIRST,
        }
    }

    /// Begins a descent at a network that is complete and finite. Offsets that are known, or equal, become so.
    pub(super) fn begin(&mut self, network: &mut Network<D>) {
        self.observations.emissions().settle(&mut network.offsets);
        self.observations.clocks().begin(network);
        self.trial.clone_from(network);
        self.damping = FIRST;
        self.look(network);
    }

    /// Computes the residuals at a network.
    pub(super) fn look(&mut self, network: &Network<D>) {
        residuals(self.observations, network, &mut self.residuals);
    }

    /// A step by the normal equations, more and more damped until the cost, `total` of residuals and a network, is below
    /// `cost`; returns what it
    /// is then, `None` where no step lowers it. A cost that is larger by no more than the share `flat` ends the
    /// attempts.
    pub(super) fn step_down(
        &mut self,
        network: &mut Network<D>,
        cost: f64,
        flat: f64,
        total: impl Fn(&[f64], &Network<D>) -> f64,
        monitor: &Monitor,
    ) -> Result<Option<f64>, Cancelled> {
        let mut lower = None;
        while self.damping < HOPELESS {
            if self.normal.solve(self.observations, self.damping, monitor)? {
                self.normal.step(self.observations, network, &mut self.trial);
                residuals(self.observations, &self.trial, &mut self.trial_residuals);
                let next = total(&self.trial_residuals, &self.trial);
                if next < cost {
                    self.damping = (self.damping * 0.2).max(LEAST);
                    std::mem::swap(network, &mut self.trial);
                    std::mem::swap(&mut self.residuals, &mut self.trial_residuals);
                    lower = Some(next);
                    break;
                }
                if next - cost <= flat * cost.abs() {
                    break;
                }
            }
            self.damping = (self.damping * 6.0).max(1e-6);
        }
        self.damping = self.damping.min(MOST);
        Ok(lower)
    }
}

/// Residuals over their deviations, in the order of the observations, then those of coordinates as
/// far as there is room for them.
pub(crate) fn residuals<const D: usize>(observations: &Observations<D>, network: &Network<D>, out: &mut [f64]) {
    let (cells, pins) = out.split_at_mut(observations.len());
    for (o, e) in observations.all().iter().zip(cells) {
        *e = o.residual(network);
    }
    for (pin, e) in observations.pins().iter().zip(pins) {
        *e = pin.residual(network);
    }
}
