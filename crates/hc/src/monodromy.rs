//! Filling a fibre: all solutions of a family for one generic parameter point, from a single one.
//!
//! Parameters go round random triangles; solutions come back as other solutions of the same irreducible component
//! (Duff, Hill, Jensen, Lee, Leykin, Sommars 2018, arXiv:1609.08722). That a fibre is whole is never guessed: it is told by a known count or by
//! the [trace test](crate::trace), and the result says which.

use crate::distinct::coincidences;
use crate::fibre::{Fibre, FibreOptions, track_fibre};
use crate::monitor::{Monitor, Stage};
use crate::random::Random;
use crate::refine::Refiner;
use crate::tracker::PathEnd;
use num_complex::Complex64;
use poly::Evaluate;

/// Settings of monodromy.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MonodromyOptions {
    /// Seed of the loops. Default 0.
    pub seed: u64,
    /// The known number of solutions, if any: reaching it ends the search. Default `None`.
    pub roots: Option<usize>,
    /// Loops without a new solution after which the search ends, provided that they had at least 64 chances (loops times solutions)
    /// to bring one. Default 8.
    pub patience: usize,
    /// Solutions at most; a fibre that exceeds it is given up. Default 100,000.
    pub max_solutions: usize,
    /// Settings for the paths. By default difficult paths are given up early (2,000 steps, one retry): what they would have found, easier
    /// paths of later loops find.
    pub fibre: FibreOptions,
}

impl MonodromyOptions {
    /// Who watches, and may stop, the search. Default nobody.
    pub fn set_monitor(&mut self, monitor: Monitor) {
        self.fibre.tracker.monitor = monitor;
    }
}

impl Default for MonodromyOptions {
    fn default() -> Self {
        let mut fibre = FibreOptions::default();
        fibre.tracker.max_steps = 2_000;
        fibre.retries = 1;
        MonodromyOptions { seed: 0, roots: None, patience: 8, max_solutions: 100_000, fibre }
    }
}

/// Why the search for solutions ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stop {
    /// The known number of solutions was reached.
    RootsReached,
    /// The last loops brought nothing new. Not a proof: see the trace test.
    NoProgress,
    /// More solutions than allowed.
    TooMany,
    /// The monitor was cancelled: these are the solutions found so far.
    Cancelled,
}

/// What monodromy found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MonodromyResult {
    /// The fibre, refined.
    pub fibre: Fibre,
    /// Why the search ended.
    pub stop: Stop,
    /// Loops gone.
    pub loops: usize,
    /// Paths tracked.
    pub paths: usize,
}

/// Completes `start` (one or several solutions for generic parameters) by loops in parameter space.
///
/// `accept` is asked about every new solution; solutions that it refuses (degenerate ones) are dropped.
///
/// # Panics
/// If the system is not square or the fibre does not fit it.
pub fn monodromy<E: Evaluate>(
    system: &E,
    start: &Fibre,
    accept: impl Fn(&[Complex64], &[Complex64]) -> bool,
    options: &MonodromyOptions,
) -> MonodromyResult {
    let mut fibre = start.clone();
    let (mut loops, mut idle, mut paths) = (0, 0, 0);
    let monitor = &options.fibre.tracker.monitor;
    let stop = loop {
        if monitor.is_cancelled() {
            break Stop::Cancelled;
        }
        if options.roots.is_some_and(|roots| fibre.len() >= roots) {
            break Stop::RootsReached;
        }
        if idle >= options.patience && idle * fibre.len() >= 64 {
            break Stop::NoProgress;
        }
        if fibre.len() > options.max_solutions {
            break Stop::TooMany;
        }
        let mut random = Random::new(options.seed, loops as u64);
        let corners = [0, 1].map(|_| random.normals(system.parameters()));
        let before = fibre.len();
        paths += 3 * before;
        monitor.enter(Stage::Loop, 3 * before as u64);
        go_round(system, &mut fibre, &corners, &accept, options);
        loops += 1;
        idle = if fibre.len() > before { 0 } else { idle + 1 };
    };
    MonodromyResult { fibre, stop, loops, paths }
}

/// Tracks the whole fibre round one triangle and adds what is new.
fn go_round<E: Evaluate>(
    system: &E,
    fibre: &mut Fibre,
    corners: &[Vec<Complex64>; 2],
    accept: &impl Fn(&[Complex64], &[Complex64]) -> bool,
    options: &MonodromyOptions,
) {
    let n = fibre.dimension;
    let mut moving = fibre.clone();
    for corner in [&corners[0], &corners[1], &fibre.parameters] {
        let (ends, _) = track_fibre(system, &moving, corner, &options.fibre);
        // Paths that share an end have been counted as failed; whichever is true is found by a later loop.
        let regular = ends.iter().filter(|(r, _)| r.end == PathEnd::Success);
        let mut solutions: Vec<Complex64> = regular.flat_map(|(_, x)| x.iter().copied()).collect();
        remove_repeated(&mut solutions, n, 0, options.fibre.coincidence);
        moving = Fibre { parameters: corner.clone(), dimension: n, solutions };
    }
    let known = fibre.len();
    let mut refiner = Refiner::new(system);
    for x in moving.solutions.chunks_exact(n.max(1)) {
        let refined = refiner.refine(&fibre.parameters, x);
        if refined.accuracy < 1e-12 && accept(&fibre.parameters, &refined.point) {
            fibre.solutions.extend(refined.point);
        }
    }
    remove_repeated(&mut fibre.solutions, n, known, options.fibre.coincidence);
}

/// Drops every point after the first `keep` that coincides with an earlier one.
fn remove_repeated(solutions: &mut Vec<Complex64>, n: usize, keep: usize, tolerance: f64) {
    let mut drop = vec![false; solutions.len() / n.max(1)];
    for group in coincidences(solutions.chunks_exact(n.max(1)).enumerate(), tolerance) {
        group[1..].iter().filter(|&&k| k >= keep).for_each(|&k| drop[k] = true);
    }
    let mut k = 0;
    solutions.retain(|_| {
        k += 1;
        !drop[(k - 1) / n]
    });
}
