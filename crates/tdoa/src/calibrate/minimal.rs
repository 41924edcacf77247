//! Starting networks from the minimal solvers on subsets of the measurements.

use std::sync::Mutex;

use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;

use super::hypotheses::{Hypotheses, generator};
use crate::minimal::subset::spread;
use crate::minimal::{SolveOptions, Solver};
use crate::pseudoranges::Pseudoranges;
use crate::refine::PartialNetwork;

/// Subsets that are drawn for one call; the one whose nodes lie farthest apart is solved.
const DRAWS: usize = 12;

/// Sizes of the subsets, receivers and transmitters, which take turns as far as the measurements
/// have them.
const SHAPES: [(usize, usize); 3] = [(6, 3), (5, 4), (4, 5)];

/// Proposes every candidate of a minimal solver (6r/3s, 5r/4s or 4r/5s) on one random, spread-out,
/// completely measured subset a call.
pub struct MinimalHypotheses {
    options: SolveOptions,
    solvers: Mutex<Vec<Solver>>,
    /// Calls that are answered; later ones propose nothing.
    most: usize,
}

impl Default for MinimalHypotheses {
    fn default() -> Self {
        MinimalHypotheses::new()
    }
}

impl MinimalHypotheses {
    /// With settings for noisy data: roots that noise has made slightly complex count as real, and
    /// distances may be negative by a twentieth of the network's size.
    pub fn new() -> Self {
        let options = SolveOptions { near_real: 0.1, tolerance: 0.05, ..SolveOptions::default() };
        MinimalHypotheses { options, solvers: Mutex::new(Vec::new()), most: usize::MAX }
    }

    /// A source that gives way after this many calls.
    pub fn at_most(calls: usize) -> Self {
        MinimalHypotheses { most: calls, ..MinimalHypotheses::new() }
    }

    /// Whether some solver's subsets fit into a matrix of this size.
    pub fn fit(receivers: usize, transmitters: usize) -> bool {
        SHAPES.iter().any(|&(m, n)| receivers >= m && transmitters >= n)
    }

    /// The subset of one call: `m` receivers and `n` transmitters, `None` if no draw is complete.
    fn subset(measured: &Pseudoranges, (m, n): (usize, usize), rng: &mut Pcg64Mcg) -> Option<(Vec<usize>, Vec<usize>)> {
        let mut best: Option<(f64, Vec<usize>, Vec<usize>)> = None;
        let mut transmitters: Vec<usize> = (0..measured.transmitters()).collect();
        for _ in 0..DRAWS {
            let chosen = transmitters.partial_shuffle(rng, n).0.to_vec();
            let heard = |i: &usize| chosen.iter().all(|&j| measured.get(*i, j).is_some());
            let mut receivers: Vec<usize> = (0..measured.receivers()).filter(heard).collect();
            if chosen.len() < n || receivers.len() < m {
                continue;
            }
            receivers.shuffle(rng);
            receivers.truncate(m);
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
        let (receivers, transmitters) = (measured.receivers(), measured.transmitters());
        let shapes: Vec<(usize, usize)> =
            SHAPES.into_iter().filter(|&(m, n)| receivers >= m && transmitters >= n).collect();
        // A matrix of a solver's own size has but one subset.
        let only = shapes.contains(&(receivers, transmitters));
        if shapes.is_empty() || index >= if only { 1.min(self.most) } else { self.most } {
            return Vec::new();
        }
        let mut rng = generator(seed ^ 0x6c62_272e_07bb_0142, index);
        let Some((receivers, transmitters)) = Self::subset(measured, shapes[index % shapes.len()], &mut rng) else {
            return Vec::new();
        };
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
