//! The coefficient stage: every path from the generic to the given coefficients, to its end.

use super::prints::Prints;
use crate::distinct::{coincidences, relative_distance};
use crate::endgame::{Ending, Verdict, endgame};
use crate::homotopy::Segment;
use crate::monitor;
use crate::refine::{Refined, Refiner};
use crate::solve::SolveOptions;
use crate::start::Source;
use crate::tracker::{PathEnd, TrackerOptions, track};
use num_complex::Complex64;
use poly::Evaluate;
use std::collections::BTreeMap;

/// Where a path ends. Small, since there is one for each path; points are kept of finite ends only.
#[derive(Clone, Debug)]
pub(super) enum End {
    /// At a regular solution.
    Regular(Box<Refined>),
    /// At a solution at which the Jacobian is singular.
    Singular(Box<SingularEnd>),
    /// At infinity, in the direction of this number.
    Infinite(usize),
    /// Not known.
    Lost,
}

impl End {
    pub(super) fn is_singular(&self) -> bool {
        matches!(self, End::Singular(_))
    }
}

#[derive(Clone, Debug)]
pub(super) struct SingularEnd {
    pub(super) point: Vec<Complex64>,
    pub(super) winding: usize,
    pub(super) error: f64,
}

/// How all paths end.
pub(super) struct Ends {
    /// In the order of the start solutions.
    pub(super) ends: Vec<End>,
    /// Directions of paths to infinity: valuations in units of the reciprocal winding number, and that number.
    pub(super) directions: Vec<(Vec<i64>, usize)>,
    /// Tracks that were run again.
    pub(super) retracked: usize,
    /// Whether they were given up on trial: the ends are then no result.
    pub(super) abandoned: bool,
}

/// Relative distance below which two paths that have not yet ended are one: only paths that have crossed come that near.
const CROSSED: f64 = 1e-11;
/// Relative distance below which two singular ends are one point.
pub(super) const CLUSTER: f64 = 1e-6;
/// Paths that are under way at a time: memory for their points is bounded by this, not by the number of paths.
const CHUNK: usize = 1 << 11;

/// On trial, as many paths are followed first.
const TRIAL: usize = 32;
/// On trial, one path in as many may end irregularly.
const IRREGULAR: u64 = 8;

/// Follows the paths with the numbers below `count` of a source to the parameters `target`; paths that share a start or a
/// regular end, have crossed or are lost are tracked again with stricter steps.
///
/// On `trial` they are abandoned as soon as too many do not end at regular solutions: with another source that may be less work.
pub(super) fn follow<E: Evaluate, S: Source<E>>(
    system: &E,
    start: &S,
    count: usize,
    target: &[Complex64],
    trial: bool,
    options: &SolveOptions,
) -> Ends {
    let mut stage = Stage {
        system,
        start,
        segment: Segment::new(start.parameters(), target),
        target,
        options,
        ends: vec![End::Lost; count],
        directions: BTreeMap::new(),
        starts: Prints::new(if start.is_tracked() { count } else { 0 }),
        middles: Prints::new(count),
    };
    let mut which: Vec<usize> = (0..count).collect();
    let mut retracked = 0;
    for level in 0..=options.paths.retries {
        let settings = if level == 0 { options.paths.tracker.clone() } else { options.paths.tracker.stricter(level) };
        retracked += if level == 0 { 0 } else { which.len() };
        let (mut done, mut regular) = (0, 0);
        let (first, rest) = which.split_at(if trial && level == 0 { TRIAL.min(count) } else { 0 });
        for numbers in std::iter::once(first).chain(rest.chunks(CHUNK)).filter(|numbers| !numbers.is_empty()) {
            stage.run(numbers, &settings, level > 0, &|| {
                options.monitor().enter(monitor::Stage::Paths, which.len() as u64);
                options.monitor().add(done, regular);
            });
            done += numbers.len() as u64;
            regular += numbers.iter().filter(|&&k| matches!(stage.ends[k], End::Regular(_))).count() as u64;
            let irregular = (done - regular) * IRREGULAR > done;
            if trial && level == 0 && irregular && !options.monitor().is_cancelled() {
                return Ends { ends: stage.ends, directions: Vec::new(), retracked, abandoned: true };
            }
        }
        which = stage.doubtful();
        if which.is_empty() || options.monitor().is_cancelled() {
            break;
        }
    }
    // Paths that still share an end: it counts once.
    for &k in &which {
        let first = match &stage.ends[k] {
            End::Regular(_) => !which.iter().take_while(|&&j| j < k).any(|&j| stage.same_regular(j, k)),
            End::Singular(_) => true,
            _ => false,
        };
        if !first {
            stage.ends[k] = End::Lost;
        }
    }
    let mut directions: Vec<((Vec<i64>, usize), usize)> = stage.directions.into_iter().collect();
    directions.sort_by_key(|d| d.1);
    let directions = directions.into_iter().map(|d| d.0).collect();
    Ends { ends: stage.ends, directions, retracked, abandoned: false }
}

struct Stage<'a, E, S> {
    system: &'a E,
    start: &'a S,
    segment: Segment,
    target: &'a [Complex64],
    options: &'a SolveOptions,
    ends: Vec<End>,
    /// Numbers of directions to infinity.
    directions: BTreeMap<(Vec<i64>, usize), usize>,
    /// Where the paths began, if they were tracked there.
    starts: Prints,
    /// Where the paths that needed the endgame were at a common radius.
    middles: Prints,
}

impl<E: Evaluate, S: Source<E>> Stage<'_, E, S> {
    /// Tracks the paths with these numbers to their ends; `begun` is called when they are at their start.
    fn run(&mut self, numbers: &[usize], settings: &TrackerOptions, again: bool, begun: &dyn Fn()) {
        for &k in numbers {
            self.ends[k] = End::Lost;
            self.middles.forget(k);
            if self.start.is_tracked() {
                self.starts.forget(k);
            }
        }
        if self.start.is_tracked() {
            self.options.monitor().enter(monitor::Stage::Start, numbers.len() as u64);
        }
        let reached = self.start.solutions(self.system, numbers, settings);
        if self.start.is_tracked() {
            let n = self.system.variables();
            for (&k, point) in reached.numbers.iter().zip(reached.points.chunks_exact(n)) {
                self.starts.note(k, point, again);
            }
        }
        begun();
        let start = self.options.endgame.start;
        let tracker = TrackerOptions { endgame_start: 0.0, min_t: start, ..settings.clone() };
        let all: Vec<usize> = (0..reached.numbers.len()).collect();
        let paths = track(self.system, &self.segment, &reached.points, &all, &tracker);
        let mut refiner = Refiner::new(self.system);
        let mut undecided = Vec::new();
        let mut handed = Vec::new();
        for (result, point) in paths.iter() {
            match result.end {
                PathEnd::Success => {
                    let refined = refiner.refine(self.target, point);
                    if refiner.is_regular(self.target, &refined) {
                        self.ends[reached.numbers[result.path]] = End::Regular(Box::new(refined));
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
            self.segment.target().iter().zip(self.segment.direction()).map(|(p, d)| p + d * start).collect();
        let settings = TrackerOptions { endgame_start: 0.0, ..settings.clone() };
        let to_near = Segment::new(self.start.parameters(), &near);
        let held = track(self.system, &to_near, &reached.points, &undecided, &settings);
        let held = held.iter().filter(|(r, _)| r.end == PathEnd::Success).map(|(r, x)| (r.path, start, x));
        let turns = self.ends.len();
        let handed = handed.into_iter().chain(held);
        for ending in endgame(self.system, &self.segment, handed, turns, &settings, &self.options.endgame) {
            self.take(reached.numbers[ending.path], ending, &mut refiner, again);
        }
    }

    fn take(&mut self, path: usize, ending: Ending, refiner: &mut Refiner<'_, E>, again: bool) {
        if !ending.middle.is_empty() {
            self.middles.note(path, &ending.middle, again);
        }
        let mut regular = || {
            let refined = refiner.refine(self.target, &ending.point);
            let near = relative_distance(&refined.point, &ending.point) < CLUSTER;
            (near && refiner.is_regular(self.target, &refined)).then(|| End::Regular(Box::new(refined)))
        };
        let regular = match ending.verdict {
            Verdict::Reached | Verdict::Finite { winding: 1, .. } => regular(),
            _ => None,
        };
        let singular = |point, winding, error| End::Singular(Box::new(SingularEnd { point, winding, error }));
        self.ends[path] = match (regular, ending.verdict) {
            (Some(regular), _) => regular,
            (None, Verdict::Finite { winding, error }) => singular(ending.point, winding, error),
            (None, Verdict::Infinite { winding, valuations }) => {
                let next = self.directions.len();
                End::Infinite(*self.directions.entry((valuations, winding)).or_insert(next))
            }
            (None, Verdict::Reached | Verdict::Lost) => End::Lost,
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

    /// Paths that are lost, share a start or a regular end, have crossed on the way, or end in a cycle that is not whole.
    fn doubtful(&self) -> Vec<usize> {
        let regular = self.ends.iter().enumerate().filter_map(|(k, end)| match end {
            End::Regular(refined) => Some((k, &refined.point[..])),
            _ => None,
        });
        let mut which = coincidences(regular, self.options.paths.coincidence).concat();
        which.extend(self.starts.met(self.options.paths.coincidence));
        which.extend(self.middles.met(CROSSED));
        let singular = self.ends.iter().enumerate().filter_map(|(k, end)| match end {
            End::Singular(end) => Some((k, &end.point[..])),
            _ => None,
        });
        for group in groups(singular, CLUSTER) {
            // Paths of winding number m come in cycles of m.
            let winding = |k: usize| match &self.ends[k] {
                End::Singular(end) => end.winding,
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
