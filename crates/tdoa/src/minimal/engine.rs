//! From measurements to all networks that explain them, for any [`Formulation`]: tracks the stored fibre to the data, accounts for
//! every path, and turns real solutions into networks.

use super::error::SolveError;
use super::formulation::Formulation;
use super::linear::LeastSquares;
use super::nearest::Nearest;
use super::normalised::{Normalised, rank};
use super::options::{SolveOptions, Start};
use super::polish::Polisher;
use super::proofs::{RootProofs, prove};
use super::real::real_root;
use super::recover::{Again, BAD_LUCK, Recovery};
use super::scratch;
use super::solution::{Candidate, MinimalSolution, PathCounts, RootCounts};
use crate::pseudoranges::Pseudoranges;
use hc::fibre::Fibre;
use hc::homotopy::Segment;
use hc::poly::Lanes8;
use hc::refine::{Refined, Refiner};
use hc::tracker::{PathEnd, PathResult, PathSet, Tracker};
use num_complex::Complex64;

/// Turns of the stored fibre, one after the other where paths stay lost: each gives other paths to the same ends.
const TURNS: [f64; 3] = [0.0, 0.7, -1.1];

/// Paths tracked at a time where the search stops at the first network that fits: four batches of eight.
const PART: usize = 32;

/// Room for so many candidates is made at once; there are hardly ever more.
const CANDIDATES: usize = 64;

/// A solver of one configuration; keeps its memory from call to call.
pub(crate) struct Engine<F: Formulation> {
    tracking: Tracking<F>,
    roots: Roots<F>,
    data: Normalised,
    /// The parameters of the last call.
    target: Vec<Complex64>,
}

impl<F: Formulation> Engine<F> {
    /// A solver with its start solutions.
    pub(crate) fn new() -> Self {
        let stored = F::fibre();
        let start = stored.clone();
        let tracking = Tracking {
            tracker: Tracker::new(F::system(), &SolveOptions::default().paths.tracker),
            paths: PathSet::with_capacity(stored.dimension, stored.len()),
            again: Again::new(&stored),
            stored,
            nearest: Nearest::default(),
            start,
            segment: Segment::default(),
        };
        let roots = Roots {
            refiner: Refiner::new(F::system()),
            refined: Refined::default(),
            squares: LeastSquares::default(),
            polisher: Polisher::default(),
        };
        Engine { tracking, roots, data: Normalised::default(), target: Vec::new() }
    }

    /// Every network that explains a matrix of the formulation's size that has passed the checks, warnings left to the caller. After the first call memory is allocated for the result alone, unless
    /// all paths have to be tracked again or a root is so ill-conditioned that only double-double tells it from a singular one.
    pub(crate) fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &SolveOptions,
    ) -> Result<MinimalSolution, SolveError> {
        let size = (measured.receivers(), measured.transmitters());
        assert_eq!(size, (F::RECEIVERS, F::TRANSMITTERS), "size of the matrix");
        self.data.take(measured);
        self.target.clear();
        self.target.extend(self.data.parameters().iter().map(|&f| Complex64::from(f)));
        let (data, target, roots) = (&self.data, &self.target[..], &mut self.roots);
        let candidates = Vec::with_capacity(CANDIDATES);
        let mut found =
            Found::<F> { measured, data, options, target, roots, counts: RootCounts::default(), candidates };
        let (paths, stopped_early) = match options.start {
            Start::Stored => self.tracking.run(&mut found),
            Start::Polyhedral => self.tracking.run_polyhedral(&mut found)?,
        };
        let Found { counts, mut candidates, .. } = found;
        rank(&mut candidates);
        let (configuration, warnings) = (measured.configuration(), Vec::new());
        Ok(MinimalSolution { configuration, solver: F::NAME, paths, counts, stopped_early, warnings, candidates })
    }

    /// The records of the paths of the last call.
    pub(crate) fn records(&self) -> &[PathResult] {
        self.tracking.paths.results()
    }

    /// Proofs that the complex roots of the last call exist and are distinct.
    pub(crate) fn prove(&self) -> Option<RootProofs> {
        let ends = self.tracking.paths.iter().filter(|(r, _)| r.end == PathEnd::Success);
        prove::<F>(&self.target, &ends.map(|(_, x)| x.to_vec()).collect::<Vec<_>>())
    }
}

/// The paths, and what follows them.
struct Tracking<F: Formulation> {
    tracker: Tracker<'static, F::System, Lanes8>,
    stored: Fibre,
    nearest: Nearest,
    /// The stored fibre in the position nearest to the data.
    start: Fibre,
    segment: Segment,
    paths: PathSet,
    again: Again<F>,
}

impl<F: Formulation> Tracking<F> {
    /// Tracks all paths, again from a turned fibre where some stay lost, keeps the most complete set and adds its roots to `found`.
    /// Returns the counts and whether the search stopped at a network that fits.
    fn run(&mut self, found: &mut Found<'_, F>) -> (PathCounts, bool) {
        let (target, options) = (found.target, found.options);
        let mut retracked = 0;
        let mut best: Option<(usize, PathSet)> = None;
        for (attempt, turn) in TURNS.into_iter().enumerate() {
            retracked += if attempt > 0 { self.stored.len() } else { 0 };
            self.nearest.find::<F>(&self.stored, target, turn, &mut self.start);
            let parameters = |p: &[Complex64]| F::parameters(0, p);
            self.segment.join(&parameters(&self.start.parameters), &parameters(target));
            let in_parts = attempt == 0 && options.first_under.is_some();
            if in_parts && self.stops_early(found) {
                return (self.counts(0, 0), true);
            }
            let recovery = Recovery::<F> {
                start: &self.start,
                segment: &self.segment,
                target,
                settings: &options.paths,
                fallback: options.fallback,
                tracker: &mut self.tracker,
                paths: &mut self.paths,
                again: &mut self.again,
            };
            let (lost, again) = recovery.run(in_parts);
            retracked += again;
            if attempt == 0 && lost == 0 {
                best = None;
                break;
            }
            if best.as_ref().is_none_or(|(fewest, _)| lost < *fewest) {
                best = Some((lost, self.paths.clone()));
            }
            // The roots of a degenerate network no other path reaches either.
            if lost == 0 || lost > BAD_LUCK {
                break;
            }
        }
        let failed = best.as_ref().map_or(0, |(lost, _)| *lost);
        if let Some((_, paths)) = best {
            self.paths = paths;
        }
        let counts = self.counts(failed, retracked);
        found.clear();
        self.paths.iter().filter(|(r, _)| r.end == PathEnd::Success).for_each(|(_, x)| found.add(x));
        found.counts.complex = counts.finite;
        (counts, false)
    }

    /// The same from a polyhedral start system: for the data, and where that leaves roots missing through a random member.
    fn run_polyhedral(&mut self, found: &mut Found<'_, F>) -> Result<(PathCounts, bool), SolveError> {
        let monitor = &found.options.paths.tracker.monitor;
        let direct = scratch::at_data::<F>(found.target, monitor)?;
        let mut spent = direct.paths.retracked;
        if !direct.whole {
            let (member, tracked) = scratch::at_random::<F>(found.target, monitor)?;
            spent += tracked;
            if let Some(mut member) = member {
                spent += direct.paths.tracked;
                std::mem::swap(&mut self.stored, &mut member);
                let (paths, stopped_early) = self.run(found);
                self.stored = member;
                if monitor.is_cancelled() {
                    return Err(SolveError::Cancelled);
                }
                return Ok((PathCounts { retracked: spent + paths.retracked, ..paths }, stopped_early));
            }
        }
        self.paths.clear(self.stored.dimension);
        direct.fibre.solutions.chunks_exact(self.stored.dimension).for_each(|root| found.add(root));
        found.counts.complex = direct.fibre.len();
        Ok((PathCounts { retracked: spent, ..direct.paths }, false))
    }

    /// How the paths that are stored have ended.
    fn counts(&self, failed: usize, retracked: usize) -> PathCounts {
        let (tracked, at_infinity) = (self.paths.len(), self.paths.count(PathEnd::AtInfinity));
        let dropped = self.paths.count(PathEnd::Dropped);
        let finite = tracked - at_infinity - dropped - failed;
        PathCounts { tracked, finite, at_infinity, failed, dropped, retracked }
    }

    /// Tracks the paths a part at a time until one gives a physical network that fits; whether one did.
    fn stops_early(&mut self, found: &mut Found<'_, F>) -> bool {
        self.tracker.set_options(&found.options.paths.tracker);
        self.paths.clear(self.start.dimension);
        let mut from = 0;
        while from < self.start.len() {
            let to = (from + PART).min(self.start.len());
            let before = self.paths.len();
            self.tracker.track(&self.segment, &self.start.solutions, from..to, &mut self.paths);
            for (_, x) in self.paths.iter().skip(before).filter(|(r, _)| r.end == PathEnd::Success) {
                found.counts.complex += 1;
                found.add(x);
            }
            if found.fits() {
                // Paths that ended otherwise would be tracked again if the search went on.
                return true;
            }
            from = to;
        }
        self.paths.sort();
        false
    }
}

/// What makes networks of roots; keeps its memory.
struct Roots<F: Formulation> {
    refiner: Refiner<'static, F::System>,
    refined: Refined,
    squares: LeastSquares,
    polisher: Polisher,
}

/// The networks of the real roots found so far.
struct Found<'a, F: Formulation> {
    measured: &'a Pseudoranges,
    data: &'a Normalised,
    options: &'a SolveOptions,
    target: &'a [Complex64],
    roots: &'a mut Roots<F>,
    counts: RootCounts,
    candidates: Vec<Candidate>,
}

impl<F: Formulation> Found<'_, F> {
    fn clear(&mut self) {
        self.counts = RootCounts::default();
        self.candidates.clear();
    }

    /// Counts a root and, if it is real with real positions, adds its network.
    fn add(&mut self, root: &[Complex64]) {
        let Roots { refiner, refined, squares, polisher } = &mut *self.roots;
        let Some((x, real)) = real_root::<F>(refiner, self.target, root, self.options.near_real, refined) else {
            return;
        };
        self.counts.real += usize::from(real);
        let Some(network) = F::network(self.data.parameters(), &x, squares) else { return };
        self.counts.positive_definite += usize::from(real);
        let mut candidate = self.data.candidate(network, self.options, polisher);
        self.counts.physical += usize::from(real && candidate.physical);
        self.data.restore(&mut candidate.network);
        candidate.residual = candidate.network.rms(self.measured);
        self.candidates.push(candidate);
    }

    /// Whether a network is good enough to stop at.
    fn fits(&self) -> bool {
        let limit = self.options.first_under.unwrap_or(0.0);
        self.candidates.iter().any(|c| c.physical && c.residual < limit)
    }
}
