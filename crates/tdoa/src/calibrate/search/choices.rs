//! Choices among candidates: those that starts draw, and that of a network.

use crate::calibrate::search::hypotheses::{Hypotheses, generator};
use crate::candidates::Candidates;
use crate::loss::SEARCH_NU;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, PartialNetwork, RefineOptions, SEARCH};
use crate::restart::Restarts;
use hc::Monitor;
use rand::RngExt;

/// Of each cell the candidate that is nearest to a network, the first of these.
pub(crate) fn nearest<const D: usize>(measured: &Pseudoranges, network: &Network<D>) -> Pseudoranges {
    measured.choosing(|i, j, candidates| {
        let predicted = network.pseudorange(i, j);
        least_by(candidates, |value| (value - predicted).abs())
    })
}

/// The place of the first candidate of which this is least.
fn least_by(candidates: &Candidates, of: impl Fn(f64) -> f64) -> usize {
    let all = candidates.all();
    (0..all.len()).min_by(|a, b| of(all[*a]).total_cmp(&of(all[*b]))).unwrap_or(0)
}

/// Random networks, each from one choice among the candidates and refined to it: in turns the earliest candidates, as
/// what comes by a detour is late, the first ones, as a detector lists the likeliest first, and random ones.
pub(crate) struct RandomChoices<'a> {
    measured: &'a Pseudoranges,
    /// Standard deviation of a typical measurement, metres, where these carry their own; else 1.
    unit: f64,
    monitor: Monitor,
    diameter: f64,
}

impl<'a> RandomChoices<'a> {
    pub(crate) fn new(measured: &'a Pseudoranges, unit: f64, monitor: &Monitor) -> Self {
        // Late candidates would make the network large.
        let observations = Observations::<2>::new(&earliest(measured), |_, _| true);
        let diameter = Restarts::new(&observations).diameter;
        RandomChoices { measured, unit, monitor: monitor.quiet(), diameter }
    }

    /// A guess of the network's diameter in metres.
    pub(crate) fn diameter(&self) -> f64 {
        self.diameter
    }
}

fn earliest(measured: &Pseudoranges) -> Pseudoranges {
    measured.choosing(|_, _, candidates| least_by(candidates, |value| value))
}

impl<const D: usize> Hypotheses<D> for RandomChoices<'_> {
    fn propose(&self, _: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork<D>> {
        if self.monitor.is_cancelled() {
            return Vec::new();
        }
        let mut rng = generator(seed, index);
        let chosen = match index % 3 {
            0 => earliest(self.measured),
            1 => self.measured.choosing(|_, _, _| 0),
            _ => self.measured.choosing(|_, _, candidates| rng.random_range(0..candidates.all().len())),
        };
        let observations = Observations::new(&chosen, |_, _| true);
        // From the plain guess to anything, as where there is one choice.
        let spread = [1.0, 0.3, 1.0, 0.7][index / 3 % 4];
        let network = Restarts::new(&observations).draw(&observations, spread, &mut rng);
        let unit = self.diameter / self.unit;
        let refine = RefineOptions { anneal_from: Some(0.1 * unit), floor: 1e-9 * unit, ..SEARCH };
        let network = NetworkRefiner::new(&observations, SEARCH_NU, &self.monitor).refine(network, &refine).network;
        if !network.is_finite() {
            return Vec::new();
        }
        let located = network.transmitters.iter().zip(&network.offsets);
        vec![PartialNetwork {
            receivers: network.receivers.iter().copied().map(Some).collect(),
            transmitters: located.map(|(&position, &offset)| Some((position, offset))).collect(),
            clocks: network.clocks.clone(),
        }]
    }
}
