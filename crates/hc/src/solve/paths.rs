//! The coefficient stage: every path from the generic to the given coefficients, to its end.

use crate::distinct::{coincidences, relative_distance};
use crate::endgame::{Ending, Verdict, endgame};
use crate::fibre::Fibre;
use crate::homotopy::Segment;
use crate::refine::{Refined, Refiner};
use crate::solve::SolveOptions;
use crate::tracker::{PathEnd, TrackerOptions, track};
use num_complex::Complex64;
use poly::Evaluate;

/// Where a path ends.
#[derive(Clone, Debug)]
pub(super) enum End {
    /// At a regular solution.
    Regular(Refined),
    /// At a solution at which the Jacobian is singular.
    Singular { point: Vec<Complex64>, winding: usize, error: f64 },
    /// At infinity, in the direction of these valuations, in units of the reciprocal winding number.
    Infinite { valuations: Vec<i64>, winding: usize },
    /// Not known.
    Lost,
}

impl End {
    pub(super) fn is_singular(&self) -> bool {
        matches!(self, End::Singular { .. })
    }
}

/// Relative distance below which two paths that have not yet ended are one: only paths that have crossed come that near.
const CROSSED: f64 = 1e-11;
/// Relative distance below which two singular ends are one point.
pub(super) const CLUSTER: f64 = 1e-6;

/// Follows all paths of a fibre to the parameters `target`; paths that share a regular end, have crossed or are lost are
/// tracked again with stricter steps. Returns the ends in the order of the fibre and how many tracks were run again.
pub(super) fn follow<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &SolveOptions,
) -> (Vec<End>, usize) {
    let mut stage = Stage {
        system,
        fibre,
        target,
        options,
        ends: vec![End::Lost; fibre.len()],
        middles: vec![Vec::new(); fibre.len()],
    };
    let mut which: Vec<usize> = (0..fibre.len()).collect();
    let mut retracked = 0;
    for level in 0..=options.paths.retries {
        options.monitor().enter(crate::monitor::Stage::Paths, which.len() as u64);
        let settings = if level == 0 { options.paths.tracker.clone() } else { options.paths.tracker.stricter(level) };
        retracked += if level == 0 { 0 } else { which.len() };
        stage.run(&which, &settings);
        which = stage.doubtful();
        if which.is_empty() || options.monitor().is_cancelled() {
            break;
        }
    }
    // Paths that still share an end: it counts once.
    for &k in &which {
        let first = match &stage.ends[k] {
            End::Regular(_) => !which.iter().take_while(|&&j| j < k).any(|&j| stage.same_regular(j, k)),
            End::Singular { .. } => true,
            _ => false,
        };
        if !first {
            stage.ends[k] = End::Lost;
        }
    }
    (stage.ends, retracked)
}

struct Stage<'a, E: Evaluate> {
    system: &'a E,
    fibre: &'a Fibre,
    target: &'a [Complex64],
    options: &'a SolveOptions,
    ends: Vec<End>,
    /// Where the paths that needed the endgame were at a common radius.
    middles: Vec<Vec<Complex64>>,
}

impl<E: Evaluate> Stage<'_, E> {
    /// Tracks the paths with these indices to their ends.
    fn run(&mut self, which: &[usize], settings: &TrackerOptions) {
        let start = self.options.endgame.start;
        let tracker = TrackerOptions { endgame_start: 0.0, min_t: start, ..settings.clone() };
        let segment = Segment::new(&self.fibre.parameters, self.target);
        let paths = track(self.system, &segment, &self.fibre.solutions, which, &tracker);
        let mut refiner = Refiner::new(self.system);
        let mut undecided = Vec::new();
        let mut handed = Vec::new();
        for (result, point) in paths.iter() {
            self.ends[result.path] = End::Lost;
            self.middles[result.path].clear();
            match result.end {
                PathEnd::Success => {
                    let refined = refiner.refine(self.target, point);
                    if refiner.contracts(self.target, &refined.point) {
                        self.ends[result.path] = End::Regular(refined);
                    } else {
                        undecided.push(result.path);
                    }
                }
                PathEnd::Singular => handed.push((result.path, result.t, point)),
                _ => {}
            }
        }
        // Paths that seemed to reach the target, but not at a regular solution: once more up to where the endgame begins.
        let near: Vec<Complex64> =
            segment.target().iter().zip(segment.direction()).map(|(p, d)| p + d * start).collect();
        let settings = TrackerOptions { endgame_start: 0.0, ..settings.clone() };
        let held = track(
            self.system,
            &Segment::new(&self.fibre.parameters, &near),
            &self.fibre.solutions,
            &undecided,
            &settings,
        );
        let held = held.iter().filter(|(r, _)| r.end == PathEnd::Success).map(|(r, x)| (r.path, start, x));
        let turns = self.fibre.len();
        let all = handed.into_iter().chain(held);
        for ending in endgame(self.system, &segment, all, turns, &settings, &self.options.endgame) {
            self.take(ending, &mut refiner);
        }
    }

    fn take(&mut self, ending: Ending, refiner: &mut Refiner<'_, E>) {
        let path = ending.path;
        self.middles[path] = ending.middle;
        let mut regular = || {
            let refined = refiner.refine(self.target, &ending.point);
            let near = relative_distance(&refined.point, &ending.point) < CLUSTER;
            (near && refiner.contracts(self.target, &refined.point)).then_some(End::Regular(refined))
        };
        self.ends[path] = match ending.verdict {
            Verdict::Reached => regular().unwrap_or(End::Lost),
            Verdict::Finite { winding: 1, error } => {
                regular().unwrap_or(End::Singular { point: ending.point, winding: 1, error })
            }
            Verdict::Finite { winding, error } => End::Singular { point: ending.point, winding, error },
            Verdict::Infinite { winding, valuations } => End::Infinite { valuations, winding },
            Verdict::Lost => End::Lost,
        };
    }

    fn same_regular(&self, j: usize, k: usize) -> bool {
        match (&self.ends[j], &self.ends[k]) {
            (End::Regular(a), End::Regular(b)) => {
                relative_distance(&a.point, &b.point) <= self.options.paths.coincidence
            }
            _ => false,
        }
    }

    /// Paths that are lost, share a regular end, have crossed on the way, or end in a cycle that is not whole.
    fn doubtful(&self) -> Vec<usize> {
        let regular = self.ends.iter().enumerate().filter_map(|(k, end)| match end {
            End::Regular(refined) => Some((k, &refined.point[..])),
            _ => None,
        });
        let mut which = coincidences(regular, self.options.paths.coincidence).concat();
        let middles = self.middles.iter().enumerate().filter(|(_, x)| !x.is_empty());
        which.extend(coincidences(middles.map(|(k, x)| (k, &x[..])), CROSSED).concat());
        let singular = self.ends.iter().enumerate().filter_map(|(k, end)| match end {
            End::Singular { point, .. } => Some((k, &point[..])),
            _ => None,
        });
        for group in groups(singular, CLUSTER) {
            // Paths of winding number m come in cycles of m.
            let winding = |k: usize| match self.ends[k] {
                End::Singular { winding, .. } => winding,
                _ => 1,
            };
            for &k in &group {
                let alike = group.iter().filter(|&&j| winding(j) == winding(k)).count();
                if !alike.is_multiple_of(winding(k)) {
                    which.push(k);
                }
            }
        }
        which.extend(self.ends.iter().enumerate().filter(|(_, end)| matches!(end, End::Lost)).map(|(k, _)| k));
        which.sort_unstable();
        which.dedup();
        which
    }
}

/// All points by groups of coinciding ones; a point alone is a group too.
pub(super) fn groups<'a>(
    points: impl Iterator<Item = (usize, &'a [Complex64])> + Clone,
    tolerance: f64,
) -> Vec<Vec<usize>> {
    let mut all = coincidences(points.clone(), tolerance);
    let mut grouped: Vec<usize> = all.concat();
    grouped.sort_unstable();
    all.extend(points.map(|(k, _)| k).filter(|k| grouped.binary_search(k).is_err()).map(|k| vec![k]));
    all.sort();
    all
}
