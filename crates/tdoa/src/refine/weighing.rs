//! Refinement under any cost of single residuals.

use super::cancel::{Cancelled, check};
use super::descent::Descent;
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
    descent: Descent<'a, D>,
    monitor: &'a Monitor,
}

impl<'a, const D: usize> Weighing<'a, D> {
    /// Fails in all it does once the monitor is cancelled.
    pub(crate) fn new(observations: &'a Observations<D>, monitor: &'a Monitor) -> Self {
        Weighing { descent: Descent::new(observations), monitor }
    }

    /// At most so many steps down the sum of the costs, from a network that is complete and finite.
    /// The residuals of the measurements where it ends are left in [`Weighing::residuals`].
    pub(crate) fn descend(
        &mut self,
        mut network: Network<D>,
        steps: usize,
        cost: &impl Cost,
    ) -> Result<Network<D>, Cancelled> {
        let Weighing { descent, monitor } = self;
        let observations = descent.observations;
        let precision = 1.0 / (cost.deviation() * cost.deviation());
        let total = |residuals: &[f64], network: &Network<D>| -> f64 {
            let (cells, pins) = residuals.split_at(observations.len());
            let cells = cells.iter().map(|&e| cost.cost(e)).sum::<f64>();
            cells + pins.iter().map(|e| 0.5 * precision * e * e).sum::<f64>() + observations.misfit(network, false)
        };
        descent.begin(&mut network);
        let mut now = total(&descent.residuals, &network);
        for _ in 0..steps {
            check(monitor)?;
            let terms = |_, e| cost.terms(e);
            descent.normal.linearise_by(observations, &network, &descent.residuals, terms, |e| (precision, e));
            descent.normal.add_known(observations, &network, 1.0, false, 0.0);
            let before = now;
            now = descent.step_down(&mut network, now, f64::NEG_INFINITY, total, monitor)?.unwrap_or(now);
            if before - now <= 1e-10 * before.abs() {
                break;
            }
        }
        Ok(network)
    }

    /// One step of least squares with a weight for each measurement and what its residual should be, where `deviation` is that
    /// of measurements of weight 1; `None` where it is not determined.
    pub(crate) fn step(
        &mut self,
        network: &Network<D>,
        weights: &[f64],
        targets: &[f64],
        deviation: f64,
    ) -> Result<Option<Network<D>>, Cancelled> {
        let descent = &mut self.descent;
        descent.look(network);
        let terms = |k: usize, e: f64| (weights[k], e - targets[k]);
        descent.normal.linearise_by(descent.observations, network, &descent.residuals, terms, |e| (1.0, e));
        descent.normal.add_known(descent.observations, network, deviation * deviation, false, 0.0);
        descent.trial.clone_from(network);
        Ok(descent.normal.solve(descent.observations, GAUGE, self.monitor)?.then(|| {
            descent.normal.step(descent.observations, network, &mut descent.trial);
            descent.trial.clone()
        }))
    }

    /// Logarithm of the determinant of the normal equations at a network, in units of the deviation;
    /// `None` where they are singular.
    pub(crate) fn log_determinant(&mut self, network: &Network<D>, cost: &impl Cost) -> Result<Option<f64>, Cancelled> {
        let descent = &mut self.descent;
        descent.look(network);
        let square = cost.deviation() * cost.deviation();
        let terms = |_, e| {
            let (weight, target) = cost.terms(e);
            (square * weight, target)
        };
        descent.normal.linearise_by(descent.observations, network, &descent.residuals, terms, |e| (1.0, e));
        descent.normal.add_known(descent.observations, network, square, false, 0.0);
        descent.normal.log_determinant(descent.observations, GAUGE, self.monitor)
    }

    /// Residuals of the measurements where the last descent ended.
    pub(crate) fn residuals(&self) -> &[f64] {
        &self.descent.residuals[..self.descent.observations.len()]
    }
}

#[cfg(test)]
mod tests {
    use super::Weighing;
    use crate::distances::ReceiverDistance;
    use crate::network::Network;
    use crate::observations::Observations;
    use crate::{Emissions, SimulateOptions, simulate};
    use hc::Monitor;

    /// Steps end where what measurements of this deviation and a taped distance say together is likeliest.
    #[test]
    fn distances_count_beside_measurements_of_the_given_deviation() {
        const DEVIATION: f64 = 0.1;
        let mut made = SimulateOptions { receivers: 6, transmitters: 10, noise: DEVIATION, ..Default::default() };
        made.emissions = Emissions::Known;
        let made = simulate(&made).unwrap();
        let taped = ReceiverDistance { receivers: [0, 3], value: 0.0, sigma: DEVIATION };
        // A deviation too long.
        let value = taped.ray(&made.network.receivers).1 + DEVIATION;
        let measured = made.pseudoranges.with_emissions(Emissions::Known);
        let measured = measured.with_distances(vec![ReceiverDistance { value, ..taped }]);
        let observations = Observations::<2>::new(&measured, |_, _| true);
        let (weights, targets) = (vec![1.0; observations.len()], vec![0.0; observations.len()]);
        let monitor = Monitor::default();
        let mut weighing = Weighing::new(&observations, &monitor);
        let mut network = made.network.clone();
        for _ in 0..60 {
            network = weighing.step(&network, &weights, &targets, DEVIATION).unwrap().unwrap();
        }
        let cost = |network: &Network| {
            let squares: f64 = observations.all().iter().map(|o| o.residual(network).powi(2)).sum();
            0.5 * squares / DEVIATION.powi(2) + observations.misfit(network, false)
        };
        let least = cost(&network);
        for (i, axis) in (0..6).flat_map(|i| [(i, 0), (i, 1)]) {
            for by in [-1e-4, 1e-4] {
                let mut moved = network.clone();
                moved.receivers[i][axis] += by;
                assert!(cost(&moved) > least, "{i} {axis} {by}");
            }
        }
    }
}
