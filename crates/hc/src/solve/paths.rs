//! The coefficient stage: every path from the generic to the given coefficients, to its end.

use super::classify::Excess;
use super::prints::Prints;
use crate::distinct::{coincidences, relative_distance};
use crate::endgame::{Ending, Verdict, endgame};
use crate::homotopy::Segment;
use crate::monitor;
use crate::refine::{Refined, Refiner};
use crate::solve::SolveOptions;
use crate::start::Source;
use crate::store::Records;
use crate::tracker::{PathEnd, TrackerOptions, track};
use num_complex::Complex64;
use poly::Evaluate;
use std::collections::BTreeMap;

/// How a path ends: four bytes, since there is one for each path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct End(u32);

impl End {
    /// Not known.
    pub(super) const LOST: End = End(0);
    /// At a regular solution.
    pub(super) const REGULAR: End = End(1);
    /// At a solution at which the Jacobian is singular.
    pub(super) const SINGULAR: End = End(2);
    /// Not sought any more, since all solutions are known ([`SolveOptions::known`]).
    pub(super) const DROPPED: End = End(3);

    /// At infinity, in the direction of this number.
    fn infinite(direction: u32) -> End {
        End(direction.saturating_add(4))
    }

    /// The number of the direction, if the path ends at infinity.
    pub(super) fn direction(self) -> Option<usize> {
        self.0.checked_sub(4).map(|direction| direction as usize)
    }
}

#[derive(Clone, Debug)]
pub(super) struct SingularEnd {
    pub(super) point: Vec<Complex64>,
    pub(super) winding: usize,
    pub(super) error: f64,
}

/// The ends of all paths by their numbers.
struct EndList {
    count: usize,
    records: Records,
}

impl EndList {
    /// None known.
    fn new(count: usize) -> Self {
        EndList { count, records: Records::new(4) }
    }

    fn get(&mut self, path: usize) -> End {
        End(self.records.get(path).iter().fold(0, |end, &byte| end << 8 | u32::from(byte)))
    }

    fn set(&mut self, path: usize, end: End) {
        self.records.set(path, &end.0.to_be_bytes());
    }
}

/// How all paths end. Of paths to infinity no points are kept.
pub(super) struct Ends {
    /// Paths whose end is not known.
    pub(super) lost: usize,
    /// Paths whose end is not sought any more.
    pub(super) dropped: usize,
    /// The regular ends by the numbers of their paths.
    pub(super) regular: BTreeMap<usize, Refined>,
    /// The singular ends likewise.
    pub(super) singular: BTreeMap<usize, SingularEnd>,
    /// Directions of paths to infinity, in order: valuations in units of the reciprocal winding number, that number, and the number
    /// of paths.
    pub(super) directions: Vec<(Vec<i64>, usize, usize)>,
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
const IRREGULAR: usize = 8;

/// Follows the paths with the numbers below `count` of a source to the parameters `target`; paths that share a start or a
/// regular end, have crossed or are lost are tracked again with stricter steps. Regular ends in `excess` are none of the
/// [known](SolveOptions::known) ones.
///
/// On `trial` they are abandoned as soon as too many do not end at regular solutions: with another source that may be less work.
pub(super) fn follow<E: Evaluate, S: Source<E>>(
    system: &E,
    start: &S,
    count: usize,
    target: &[Complex64],
    trial: bool,
    excess: &Excess,
    options: &SolveOptions,
) -> Ends {
    let mut stage = Stage {
        system,
        start,
        segment: Segment::new(start.parameters(), target),
        target,
        excess,
        options,
        ends: EndList::new(count),
        regular: BTreeMap::new(),
        singular: BTreeMap::new(),
        directions: BTreeMap::new(),
        starts: Prints::new(count),
        middles: Prints::new(count),
    };
    // In the first round all paths, afterwards those that are doubtful.
    let mut again: Option<Vec<usize>> = None;
    let mut retracked = 0;
    for level in 0..=options.paths.retries {
        let settings = if level == 0 { options.paths.tracker.clone() } else { options.paths.tracker.stricter(level) };
        let all = again.as_ref().map_or(count, Vec::len);
        retracked += if level == 0 { 0 } else { all };
        let (mut done, mut regular) = (0, 0);
        let mut next = if trial && level == 0 { TRIAL } else { CHUNK };
        while done < all {
            let to = (done + next).min(all);
            next = CHUNK;
            let numbers: Vec<usize> =
                again.as_ref().map_or_else(|| (done..to).collect(), |which| which[done..to].to_vec());
            stage.run(&numbers, &settings, level > 0, &|| {
                options.monitor().enter(monitor::Stage::Paths, all as u64);
                options.monitor().add(done as u64, regular as u64);
            });
            done = to;
            if stage.is_whole() {
                stage.drop_others();
                return stage.finish(retracked, false);
            }
            regular += numbers.iter().filter(|&k| stage.regular.contains_key(k)).count();
            let irregular = (done - regular) * IRREGULAR > done;
            if trial && level == 0 && irregular && !options.monitor().is_cancelled() {
                return stage.finish(retracked, true);
            }
        }
        let doubtful = again.insert(stage.doubtful());
        if options.known.is_some() {
            // Where two paths share an end a solution is missing; other paths need not have one.
            let jumped = stage.jumped();
            if !jumped.is_empty() {
                *doubtful = jumped;
            }
        }
        if doubtful.is_empty() || options.monitor().is_cancelled() {
            break;
        }
    }
    // Paths that still share an end: it counts once.
    let which = again.unwrap_or_default();
    for &k in &which {
        let first = match stage.ends.get(k) {
            End::REGULAR => !which.iter().take_while(|&&j| j < k).any(|&j| stage.same_regular(j, k)),
            End::SINGULAR => true,
            _ => false,
        };
        if !first {
            stage.lose(k);
        }
    }
    stage.finish(retracked, false)
}

struct Stage<'a, E, S> {
    system: &'a E,
    start: &'a S,
    segment: Segment,
    target: &'a [Complex64],
    excess: &'a Excess,
    options: &'a SolveOptions,
    ends: EndList,
    regular: BTreeMap<usize, Refined>,
    singular: BTreeMap<usize, SingularEnd>,
    /// Numbers of directions to infinity.
    directions: BTreeMap<(Vec<i64>, usize), u32>,
    /// Where the paths began, if they were tracked there.
    starts: Prints,
    /// Where the paths that needed the endgame were at a common radius.
    middles: Prints,
}

impl<E: Evaluate, S: Source<E>> Stage<'_, E, S> {
    /// Tracks the paths with these numbers to their ends; `begun` is called when they are at their start.
    fn run(&mut self, numbers: &[usize], settings: &TrackerOptions, again: bool, begun: &dyn Fn()) {
        for &k in numbers {
            self.lose(k);
            self.middles.forget(k);
            self.starts.forget(k);
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
                        self.end_regularly(reached.numbers[result.path], refined);
                    } else {
                        undecided.push(result.path);
                    }
                }
                PathEnd::Singular => handed.push((result.path, result.t, point)),
                _ => {}
            }
        }
        if self.is_whole() {
            return;
        }
        // Paths that seemed to reach the target, but not at a regular solution: once more up to where the endgame begins.
        let near: Vec<Complex64> =
            self.segment.target().iter().zip(self.segment.direction()).map(|(p, d)| p + d * start).collect();
        let settings = TrackerOptions { endgame_start: 0.0, ..settings.clone() };
        let to_near = Segment::new(self.start.parameters(), &near);
        let held = track(self.system, &to_near, &reached.points, &undecided, &settings);
        let held = held.iter().filter(|(r, _)| r.end == PathEnd::Success).map(|(r, x)| (r.path, start, x));
        let turns = self.ends.count;
        let handed = handed.into_iter().chain(held);
        for ending in endgame(self.system, &self.segment, handed, turns, &settings, &self.options.endgame) {
            self.take(reached.numbers[ending.path], ending, &mut refiner, again);
        }
    }

    fn lose(&mut self, path: usize) {
        self.ends.set(path, End::LOST);
        self.regular.remove(&path);
        self.singular.remove(&path);
    }

    fn end_regularly(&mut self, path: usize, refined: Refined) {
        self.ends.set(path, End::REGULAR);
        self.regular.insert(path, refined);
    }

    fn take(&mut self, path: usize, ending: Ending, refiner: &mut Refiner<'_, E>, again: bool) {
        if !ending.middle.is_empty() {
            self.middles.note(path, &ending.middle, again);
        }
        if matches!(ending.verdict, Verdict::Reached | Verdict::Finite { winding: 1, .. }) {
            let refined = refiner.refine(self.target, &ending.point);
            let near = relative_distance(&refined.point, &ending.point) < CLUSTER;
            if near && refiner.is_regular(self.target, &refined) {
                self.end_regularly(path, refined);
                return;
            }
        }
        match ending.verdict {
            Verdict::Finite { winding, error } => {
                self.ends.set(path, End::SINGULAR);
                self.singular.insert(path, SingularEnd { point: ending.point, winding, error });
            }
            Verdict::Infinite { winding, valuations } => {
                let next = self.directions.len() as u32;
                let direction = *self.directions.entry((valuations, winding)).or_insert(next);
                self.ends.set(path, End::infinite(direction));
            }
            Verdict::Reached | Verdict::Lost => {}
        }
    }

    /// Whether as many regular solutions are found as are known to exist.
    fn is_whole(&self) -> bool {
        let Some(known) = self.options.known.filter(|&known| self.regular.len() >= known) else { return false };
        let asked = self.regular.iter().filter(|(_, end)| !self.excess.contains_regular(&end.point));
        let points: Vec<(usize, &[Complex64])> = asked.map(|(&k, end)| (k, &end.point[..])).collect();
        let groups = coincidences(points.iter().copied(), self.options.paths.coincidence);
        points.len() - groups.iter().map(|group| group.len() - 1).sum::<usize>() >= known
    }

    fn drop_others(&mut self) {
        for path in 0..self.ends.count {
            if self.ends.get(path) == End::LOST {
                self.ends.set(path, End::DROPPED);
            }
        }
    }

    fn same_regular(&self, j: usize, k: usize) -> bool {
        let [a, b] = [j, k].map(|path| self.regular.get(&path));
        let near =
            |(a, b): (&Refined, &Refined)| relative_distance(&a.point, &b.point) <= self.options.paths.coincidence;
        a.zip(b).is_some_and(near)
    }

    fn finish(mut self, retracked: usize, abandoned: bool) -> Ends {
        let mut infinite = vec![0; self.directions.len()];
        let (mut lost, mut dropped) = (0, 0);
        for path in 0..self.ends.count {
            let end = self.ends.get(path);
            lost += usize::from(end == End::LOST);
            dropped += usize::from(end == End::DROPPED);
            end.direction().and_then(|direction| infinite.get_mut(direction)).into_iter().for_each(|paths| *paths += 1);
        }
        let directions = self.directions.into_iter().map(|((v, winding), k)| (v, winding, infinite[k as usize]));
        let directions = directions.filter(|(_, _, paths)| *paths > 0).collect();
        Ends { lost, dropped, regular: self.regular, singular: self.singular, directions, retracked, abandoned }
    }

    /// Paths that share a regular end, in their order.
    fn jumped(&self) -> Vec<usize> {
        let regular = self.regular.iter().map(|(&k, refined)| (k, &refined.point[..]));
        let mut which = coincidences(regular, self.options.paths.coincidence).concat();
        which.sort_unstable();
        which
    }

    /// Paths that are lost, share a start or a regular end, have crossed on the way, or end in a cycle that is not whole; all if what is
    /// known of them cannot be read.
    fn doubtful(&mut self) -> Vec<usize> {
        let mut which = self.jumped();
        let crossed = [self.starts.met(self.options.paths.coincidence), self.middles.met(CROSSED)];
        if crossed.iter().any(Result::is_err) {
            (0..self.ends.count).for_each(|path| self.lose(path));
        }
        which.extend(crossed.into_iter().flatten().flatten());
        let singular = self.singular.iter().map(|(&k, end)| (k, &end.point[..]));
        for group in groups(singular, CLUSTER) {
            // Paths of winding number m come in cycles of m.
            let winding = |k: &usize| self.singular.get(k).map_or(1, |end| end.winding);
            for k in &group {
                let alike = group.iter().filter(|&j| winding(j) == winding(k)).count();
                if !alike.is_multiple_of(winding(k)) {
                    which.push(*k);
                }
            }
        }
        which.extend((0..self.ends.count).filter(|&path| self.ends.get(path) == End::LOST));
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
