//! Witness points that can be tracked while their hyperplanes move.

use super::deflated::DeflatedEquations;
use super::equations::NamedEquations;
use super::slices::Slices;
use crate::distinct::relative_distance;
use crate::family::{Fibre, FibreOptions, track_fibre};
use crate::monitor::Monitor;
use crate::refine::Refiner;
use crate::solve::{SolveOptions, ends};
use crate::tolerances::{same, witness};
use crate::tracker::{PathEnd, PathResult};
use num_complex::Complex64;
use poly::Interpreter;

/// Most steps of a path: paths that need more do not end at regular points.
const STEPS: usize = 500;

/// Witness points of components of one dimension and one local structure, as regular solutions of a
/// family of which the hyperplanes are the parameters.
pub(super) struct WitnessSet {
    pub(super) family: Interpreter,
    /// The points, with named sums and multipliers behind their coordinates.
    pub(super) fibre: Fibre,
    /// The numbers of the points.
    pub(super) numbers: Vec<usize>,
    /// The number of coordinates of a point.
    pub(super) unknowns: usize,
    dimension: usize,
}

impl WitnessSet {
    /// The sets that can be tracked of some witness points, which all have the same multiplicity.
    pub(super) fn all(
        equations: &NamedEquations<'_>,
        slices: &Slices,
        points: &[Vec<Complex64>],
        seed: u64,
    ) -> Vec<WitnessSet> {
        let all = DeflatedEquations::new(equations, points.iter().cloned().enumerate());
        let sets = all.regular(slices.dimension(), seed).into_iter();
        sets.filter_map(|regular| WitnessSet::new(&regular, slices, equations.unknowns, seed)).collect()
    }

    /// The points that are regular solutions once the equations are combined to as many as there are
    /// unknowns.
    fn new(equations: &DeflatedEquations, slices: &Slices, unknowns: usize, seed: u64) -> Option<WitnessSet> {
        let family = slices.family(equations, seed)?.compile().ok()?;
        let parameters = slices.parameters();
        let mut refiner = Refiner::new(&family);
        let (mut numbers, mut solutions) = (Vec::new(), Vec::new());
        for (&k, point) in &equations.points {
            let refined = refiner.refine(&parameters, point);
            let (before, after) = (&point[..unknowns], &refined.point[..unknowns]);
            if refiner.is_regular(&parameters, &refined) && relative_distance(before, after) < witness::NEAR {
                numbers.push(k);
                solutions.extend(refined.point);
            }
        }
        let fibre = Fibre { is_partial: true, ..Fibre::new(parameters, equations.unknowns(), solutions) };
        let dimension = slices.dimension();
        (!numbers.is_empty()).then_some(WitnessSet { family, fibre, numbers, unknowns, dimension })
    }

    /// Whether a point lies on one of the components, as far as its digits tell: the witness points are
    /// tracked to general hyperplanes through it, where one of them arrives there (Sommese, Verschelde &
    /// Wampler 2001, SIAM J. Numer. Anal. 38:2022).
    pub(super) fn contains(&self, point: &[Complex64], seed: u64, monitor: &Monitor) -> bool {
        let slices = Slices::through(point, self.dimension, seed);
        let target = slices.parameters();
        let is_there = |end: &[Complex64]| relative_distance(&end[..self.unknowns], point) < same::SINGULAR;
        let mut options = FibreOptions { retries: 0, ..FibreOptions::default() };
        options.tracker.max_steps = STEPS;
        let (found, _) = track_fibre(&self.family, &self.fibre, &target, &options, monitor);
        // Where components meet, the Jacobian is singular at the end of a path that comes straight there.
        let arrives =
            |result: &PathResult| matches!(result.end, PathEnd::Success | PathEnd::Singular) && result.t == 0.0;
        if found.iter().any(|(result, end)| arrives(result) && is_there(end)) {
            return true;
        }
        // Where a component meets itself, paths may come there in cycles.
        let open = found.iter().filter(|(result, _)| !arrives(result)).map(|(result, _)| result.path);
        let open: Vec<Complex64> = open.flat_map(|k| self.fibre.solution(k)).copied().collect();
        let fibre = Fibre { is_partial: true, ..Fibre::new(self.fibre.parameters.clone(), self.fibre.dimension, open) };
        let mut options = SolveOptions::new();
        options.paths.tracker.max_steps = STEPS;
        options.paths.retries = 1;
        ends(&self.family, &fibre, &target, &options, monitor).any(|end| is_there(&end))
    }
}
