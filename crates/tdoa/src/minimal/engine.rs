//! From measurements to all networks that explain them, for any [`Formulation`]: tracks the stored fibre to the data, accounts for
//! every path, and turns real solutions into networks.

use super::formulation::Formulation;
use super::nearest::nearest;
use super::normalised::{Normalised, rank};
use super::rank::transmitters_on_a_line;
use super::real::real_root;
use super::{SolveError, SolveOptions, Start, check, scratch};
use crate::calibrate::flatness;
use crate::network::{Candidate, MinimalSolution, Network, PathCounts, RootCounts};
use crate::pseudoranges::Pseudoranges;
use hc::fibre::{Fibre, doubtful};
use hc::homotopy::Segment;
use hc::poly::Lanes8;
use hc::refine::Refiner;
use hc::tracker::{PathEnd, PathResult, PathSet, Tracker};
use num_complex::Complex64;

/// Turns of the stored fibre, one after the other where paths stay lost: each gives other paths to the same ends.
const TURNS: [f64; 3] = [0.0, 0.7, -1.1];

/// So many lost paths are bad luck; more of them tell of a degenerate network, whose roots no other path reaches either.
const BAD_LUCK: usize = 4;

/// A solver of one configuration; keeps its memory from call to call.
pub(crate) struct Engine<F: Formulation> {
    tracker: Tracker<'static, F::System, Lanes8>,
    stored: Fibre,
    paths: PathSet,
}

impl<F: Formulation> Engine<F> {
    /// A solver with its start solutions.
    pub(crate) fn new() -> Self {
        let stored = F::fibre();
        let paths = PathSet::new(stored.dimension);
        Engine { tracker: Tracker::new(F::system(), &SolveOptions::default().paths.tracker), stored, paths }
    }

    /// Every network that explains a matrix of the formulation's size.
    pub(crate) fn solve(
        &mut self,
        measured: &Pseudoranges,
        options: &SolveOptions,
    ) -> Result<MinimalSolution, SolveError> {
        let size = (measured.receivers(), measured.transmitters());
        assert_eq!(size, (F::RECEIVERS, F::TRANSMITTERS), "size of the matrix");
        check(measured)?;
        let data = Normalised::new(measured);
        let target: Vec<Complex64> = data.parameters().iter().map(|&f| f.into()).collect();
        let (roots, paths) = match options.start {
            Start::Stored => {
                let paths = self.track(&target, options);
                let good = self.paths.iter().filter(|(r, _)| r.end == PathEnd::Success);
                (good.map(|(_, x)| x.to_vec()).collect(), paths)
            }
            Start::Polyhedral => {
                self.paths.clear(self.stored.dimension);
                scratch::roots::<F>(data.parameters())?
            }
        };
        let mut refiner = Refiner::new(F::system());
        let complex = match options.start {
            Start::Stored => paths.finite,
            Start::Polyhedral => roots.len(),
        };
        let mut counts = RootCounts { complex, ..RootCounts::default() };
        let mut candidates = Vec::new();
        for root in &roots {
            let Some((x, real)) = real_root::<F>(&mut refiner, &target, root, options.near_real) else { continue };
            counts.real += usize::from(real);
            let Some(network) = F::network(data.parameters(), &x) else { continue };
            counts.positive_definite += usize::from(real);
            let candidate = data.candidate(network, options);
            counts.physical += usize::from(real && candidate.physical);
            candidates.push(candidate);
        }
        rank(&mut candidates);
        for candidate in &mut candidates {
            data.restore(&mut candidate.network);
            candidate.residual = candidate.network.rms(measured);
        }
        let mut warnings = warnings(&paths, &candidates);
        if transmitters_on_a_line(data.parameters(), F::TRANSMITTERS) {
            warnings.push(
                "the data fit transmitters in one line, and then every receiver may be its mirror image: such networks are not among these;                  move a transmitter off the line"
                    .to_owned(),
            );
        }
        let configuration = measured.configuration();
        Ok(MinimalSolution { configuration, solver: F::NAME, paths, counts, warnings, candidates })
    }

    /// The records of the paths of the last call.
    pub(crate) fn records(&self) -> &[PathResult] {
        self.paths.results()
    }

    /// Tracks all paths, again from a turned fibre where some stay lost, and keeps the most complete set.
    fn track(&mut self, target: &[Complex64], options: &SolveOptions) -> PathCounts {
        let mut retracked = 0;
        let mut best: Option<(usize, PathSet)> = None;
        for (attempt, turn) in TURNS.into_iter().enumerate() {
            retracked += if attempt > 0 { self.stored.len() } else { 0 };
            let start = nearest::<F>(&self.stored, target, turn);
            let (lost, again) = self.track_from(&start, target, options);
            retracked += again;
            if attempt == 0 && lost == 0 {
                best = None;
                break;
            }
            if best.as_ref().is_none_or(|(fewest, _)| lost < *fewest) {
                best = Some((lost, self.paths.clone()));
            }
            if lost == 0 || lost > BAD_LUCK {
                break;
            }
        }
        let failed = best.as_ref().map_or(0, |(lost, _)| *lost);
        if let Some((_, paths)) = best {
            self.paths = paths;
        }
        let at_infinity = self.paths.count(PathEnd::AtInfinity);
        let tracked = self.paths.len();
        PathCounts { tracked, finite: tracked - at_infinity - failed, at_infinity, failed, retracked }
    }

    /// Tracks all paths from one fibre. Those that fail, jump or take too many steps are continued in the other charts, then with more
    /// and shorter steps in all of them. Returns how many are lost, and how many were tracked again.
    fn track_from(&mut self, start: &Fibre, target: &[Complex64], options: &SolveOptions) -> (usize, usize) {
        let settings = &options.paths;
        let n = start.dimension;
        let mut refiner = Refiner::new(F::system());
        let mut retracked = 0;
        let mut lost: Vec<usize> = (0..start.len()).collect();
        let mut again = PathSet::new(n);
        for level in 0..=settings.retries {
            let tracker = if level == 0 { settings.tracker.clone() } else { settings.tracker.stricter(level) };
            self.tracker.set_options(&tracker);
            for chart in 0..F::CHARTS {
                let path = Segment::new(&F::parameters(chart, &start.parameters), &F::parameters(chart, target));
                if level == 0 && chart == 0 {
                    self.paths.clear(n);
                    self.tracker.track(&path, &start.solutions, lost.iter().copied(), &mut self.paths);
                    self.paths.sort();
                } else {
                    retracked += lost.len();
                    let carried: Vec<Complex64> =
                        lost.iter().flat_map(|&k| F::enter(chart, start.solution(k))).collect();
                    again.clear(n);
                    self.tracker.track(&path, &carried, 0..lost.len(), &mut again);
                    for (result, point) in again.iter().filter(|(r, _)| r.end == PathEnd::Success) {
                        let back = refiner.refine(target, &F::leave(chart, point));
                        if back.accuracy < 1e-8 {
                            let k = lost[result.path];
                            self.paths.replace(k, PathResult { path: k, ..*result }, &back.point);
                        }
                    }
                }
                lost = doubtful(&self.paths, settings.coincidence);
                if lost.is_empty() {
                    return (0, retracked);
                }
            }
        }
        (lost.len(), retracked)
    }
}

/// Physical candidates flatter than this are said to be collinear; exact data tell no more of them.
const FLAT: f64 = 1e-4;

fn warnings(paths: &PathCounts, candidates: &[Candidate]) -> Vec<String> {
    let mut warnings = Vec::new();
    if paths.failed > 0 {
        warnings.push(format!(
            "{} of {} paths were lost: the list of networks may not be whole; the nodes may be collinear or nearly coincide",
            paths.failed, paths.tracked
        ));
    }
    for (kind, points) in
        [("receivers", (|n| &n.receivers) as fn(&Network) -> &Vec<[f64; 2]>), ("transmitters", |n| &n.transmitters)]
    {
        if candidates.iter().any(|c| c.physical && flatness(points(&c.network)) < FLAT) {
            warnings.push(format!(
                "in a network that fits, the {kind} lie in one line: the data cannot tell on which side of it the other nodes lie; \
                 move some {kind} off the line"
            ));
        }
    }
    warnings
}
