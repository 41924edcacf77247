//! The last refinement of the networks that the search found, and their order.

use crate::calibrate::options::{CalibrateError, Errors, check};
use crate::calibrate::search::deviation::inlier_deviation;
use crate::calibrate::search::one_sided::finish_one_sided;
use crate::calibrate::search::same_network::distinct;
use crate::calibrate::search::truncated_cost::rank;
use crate::calibrate::state::State;
use crate::loss::CAUCHY;
use crate::observations::Observations;
use crate::refine::{NetworkRefiner, RefineOptions, RefinedNetwork, SEARCH};

/// Decrease of the negative log-likelihood that is none for rough networks.
const NEGLIGIBLE: f64 = 0.05;

impl<const D: usize> State<'_, D> {
    /// Compares what is known of clocks and distances with measurements of this deviation.
    fn take_deviation(&mut self, deviation: f64) {
        if !self.measured.distances().is_empty() || self.measured.unknown_clocks().is_some() {
            self.measured = self.measured.clone().at_deviation(deviation);
            self.observations = self.observations.clone().at_deviation(deviation);
        }
    }

    /// Refines and ranks the networks, from a deviation near that of the measurements.
    pub(crate) fn finish(&mut self, first: f64) -> Result<(), CalibrateError<D>> {
        let networks = std::mem::take(&mut self.ranked);
        (self.ranked, self.deviation) = self.finished(&self.observations, networks, first)?;
        self.take_deviation(self.deviation);
        Ok(())
    }

    /// Networks refined with one fixed loss, which makes their objectives differences of
    /// log-likelihood, best first, and the deviation of the measurements; where that is known, the
    /// network of least truncated cost is the first. The deviation behind the loss is the given one or
    /// that of the inliers of the best network, in turns with the refinement: the search's own scale is
    /// too small where few measurements are left over and too large where many are outliers.
    pub(crate) fn finished(
        &self,
        observations: &Observations<D>,
        mut networks: Vec<RefinedNetwork<D>>,
        first: f64,
    ) -> Result<(Vec<RefinedNetwork<D>>, f64), CalibrateError<D>> {
        let State { options, monitor, floor, .. } = *self;
        let known = self.known.is_some();
        if options.errors == Errors::OneSided {
            return finish_one_sided(self, observations, networks, first);
        }
        let mut refiner = NetworkRefiner::new(observations, 1.0, monitor);
        let mut deviation = first;
        let turns = match (known, self.is_rough) {
            (true, _) => 1,
            (false, true) => 2,
            (false, false) => 4,
        };
        for turn in 0..turns {
            let refine = RefineOptions {
                scale: Some(CAUCHY * deviation),
                anneal_from: None,
                floor,
                steps: if turn + 1 == turns { 100 } else { 15 },
                tolerance: if turn + 1 == turns { 1e-12 } else { 1e-6 },
                negligible: if self.is_rough { NEGLIGIBLE * 2.0 / (CAUCHY * CAUCHY) } else { 0.0 },
                rounds: if self.is_rough && turn > 0 { 0 } else { SEARCH.rounds },
                ..SEARCH
            };
            // The loss is c^2/2 ln(1 + (e/c)^2) in deviations e; the objective lacks the factor and has
            // a constant.
            let constant = refiner.constant(CAUCHY * deviation);
            for network in &mut networks {
                let starts = network.starts;
                *network = refiner.refine(std::mem::take(&mut network.network), &refine);
                network.objective = (network.objective - constant) * CAUCHY * CAUCHY / 2.0;
                network.starts = starts;
            }
            check(monitor)?;
            networks.sort_by(|a, b| a.objective.total_cmp(&b.objective));
            if known {
                networks = rank(observations, networks, deviation, options.alternative_margin, monitor)?;
            }
            if !known && turn + 1 < turns {
                deviation = inlier_deviation(observations, &networks[0].network, deviation, options.inlier_threshold);
                deviation = deviation.max(floor);
            }
        }
        Ok((distinct(networks, 12), deviation))
    }
}
