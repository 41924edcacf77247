//! Starting networks from the 6r/3s solver on subsets of the measurements.

use std::sync::Mutex;

use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

use super::hypotheses::{Hypotheses, generator};
use crate::minimal::{SixThree, SolveOptions};
use crate::pseudoranges::Pseudoranges;
use crate::refine::PartialNetwork;

/// Subsets that are drawn for one call; the one whose nodes lie farthest apart is solved.
const DRAWS: usize = 12;

/// Proposes every candidate of the 6r/3s solver on one random, spread-out, completely measured subset a call.
pub struct MinimalHypotheses {
    options: SolveOptions,
    solvers: Mutex<Vec<SixThree>>,
    /// Calls that are answered; later ones propose nothing.
    most: usize,
}

impl Default for MinimalHypotheses {
    fn default() -> Self {
        MinimalHypotheses::new()
    }
}

impl MinimalHypotheses {
    /// With settings for noisy data: roots that noise has made slightly complex count as real, and distances may be
    /// negative by a twentieth of the network's size.
    pub fn new() -> Self {
        let options = SolveOptions { near_real: 0.1, tolerance: 0.05, ..SolveOptions::default() };
        MinimalHypotheses { options, solvers: Mutex::new(Vec::new()), most: usize::MAX }
    }

    /// The same, for this many calls only.
    pub fn at_most(calls: usize) -> Self {
        MinimalHypotheses { most: calls, ..MinimalHypotheses::new() }
    }

    /// The subset of one call: receivers and transmitters, `None` if no draw is complete.
    fn subset(measured: &Pseudoranges, rng: &mut Pcg64Mcg) -> Option<(Vec<usize>, Vec<usize>)> {
        let mut best: Option<(f64, Vec<usize>, Vec<usize>)> = None;
        let mut transmitters: Vec<usize> = (0..measured.transmitters()).collect();
        for _ in 0..DRAWS {
            let chosen = transmitters.partial_shuffle(rng, 3).0.to_vec();
            let heard = |i: &usize| chosen.iter().all(|&j| measured.get(*i, j).is_some());
            let mut receivers: Vec<usize> = (0..measured.receivers()).filter(heard).collect();
            if chosen.len() < 3 || receivers.len() < 6 {
                continue;
            }
            receivers.shuffle(rng);
            receivers.truncate(6);
            let apart = spread(measured, &receivers, &chosen);
            if best.as_ref().is_none_or(|(other, ..)| apart > *other) {
                best = Some((apart, receivers, chosen));
            }
        }
        best.map(|(_, receivers, transmitters)| (receivers, transmitters))
    }
}

impl Hypotheses for MinimalHypotheses {
    fn propose(&self, measured: &Pseudoranges, index: usize, seed: u64) -> Vec<PartialNetwork> {
        // A matrix of six receivers and three transmitters has but one subset.
        let only = measured.receivers() == 6 && measured.transmitters() == 3;
        if index >= if only { 1.min(self.most) } else { self.most } {
            return Vec::new();
        }
        let mut rng = generator(seed ^ 0x6c62_272e_07bb_0142, index);
        let Some((receivers, transmitters)) = Self::subset(measured, &mut rng) else { return Vec::new() };
        let spare = self.solvers.lock().unwrap_or_else(std::sync::PoisonError::into_inner).pop();
        let mut solver = spare.unwrap_or_default();
        let solution = solver.solve(&measured.select(&receivers, &transmitters), &self.options);
        self.solvers.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(solver);
        let Ok(solution) = solution else { return Vec::new() };
        let physical = solution.candidates.iter().filter(|candidate| candidate.physical);
        physical
            .map(|candidate| {
                let mut part = PartialNetwork::unknown(measured.receivers(), measured.transmitters());
                part.place(&candidate.network, &receivers, &transmitters);
                part
            })
            .collect()
    }
}

/// The smallest difference between two rows (their common offset apart) or two columns: a bound from below on how near
/// two of the nodes are.
fn spread(measured: &Pseudoranges, receivers: &[usize], transmitters: &[usize]) -> f64 {
    let part = measured.select(receivers, transmitters);
    let f = |i: usize, j: usize| part.values()[i * part.transmitters() + j];
    let (m, n) = (part.receivers(), part.transmitters());
    let mut least = f64::INFINITY;
    for a in 0..m {
        for b in a + 1..m {
            least = least.min((0..n).map(|j| (f(a, j) - f(b, j)).abs()).fold(0.0, f64::max));
        }
    }
    for a in 0..n {
        for b in a + 1..n {
            let differences = (0..m).map(|i| f(i, a) - f(i, b));
            let (low, high) = differences.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
            // Moving a transmitter by d changes its differences by at most 2 d.
            least = least.min(0.5 * (high - low));
        }
    }
    least
}
