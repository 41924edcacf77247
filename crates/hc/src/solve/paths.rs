//! The coefficient stage: every path from the generic to the given coefficients, to its end.

use super::ends::{End, Ends};
use super::excess::Excess;
use super::fingerprints::Fingerprints;
use super::record::Record;
use super::solutions::Direction;
use crate::SolveOptions;
use crate::checkpoint::{Part, Recordable, Recorded};
use crate::distinct::{coincidences, groups, relative_distance};
use crate::endgame::Ending;
use crate::homotopy::Segment;
use crate::monitor::Monitor;
use crate::moving::{MovingParts, MovingTrackers};
use crate::ranks::{DividedWork, Lead};
use crate::refine::{LaneRefiners, Refined};
use crate::runner::{Flow, Policy, Round, RunMemory, Work, run};
use crate::singular::Consistency;
use crate::start::Source;
use crate::tolerances::{ends, same};
use crate::tracker::Trackers;
use num_complex::Complex64;
use poly::{Evaluate, Interpreter};
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Whether so many of `count` paths are lost or doubtful after the first round that neither
/// stricter steps nor another start system would help.
pub(super) fn are_hopeless(lost: usize, count: usize) -> bool {
    lost >= HOPELESS && lost > count - count / 4
}

/// Number of paths under way at a time. It bounds the memory for their points, independently of the
/// number of all paths.
const CHUNK: usize = 1 << 11;
/// Number of paths that go through the endgame at a time, because each takes more memory there than
/// before.
const PORTION: usize = 1 << 9;
/// Fewer lost paths are never given up.
const HOPELESS: usize = 32;
/// On trial, this many paths are followed first.
const TRIAL: usize = 32;
/// On trial, one path in this many may end irregularly.
const IRREGULAR: usize = 8;

/// What the paths follow, and how.
pub(super) struct Route<'a, 'e, E: Evaluate, S> {
    pub(super) trackers: &'a Trackers<'e, E>,
    /// What refines regular ends.
    pub(super) refiners: &'a LaneRefiners<'e, E>,
    /// How paths are tracked up to the endgame with fewer operations, if there is a way.
    pub(super) moving: Option<&'a MovingTrackers<'e>>,
    pub(super) start: &'a S,
    /// Number of paths.
    pub(super) count: usize,
    /// The parameters to which they lead.
    pub(super) target: &'a [Complex64],
    /// Regular ends that are excess do not count as [known](SolveOptions::known) solutions; stray ones are in doubt.
    pub(super) excess: &'a Excess<'a>,
    pub(super) options: &'a SolveOptions,
    pub(super) monitor: &'a Monitor,
    /// Where batches of paths are recorded.
    pub(super) record: Option<Part<'a>>,
    /// Who hands out paths to other ranks.
    pub(super) lead: Option<&'a Lead<'a>>,
    /// Whether solutions that these paths miss are found otherwise if there is but one unknown.
    pub(super) has_other_ways: bool,
}

/// Follows the paths of a route; those that share a start or a regular end, have crossed or are
/// lost are tracked again with stricter steps.
///
/// On `trial` the paths are abandoned as soon as too many do not end at regular solutions, because
/// another source may then be less work.
pub(super) fn follow<E: Evaluate, S: Source<E>>(route: Route<'_, '_, E, S>, trial: bool) -> Ends {
    let Route { count, options, monitor, record, lead, .. } = route;
    let mut work = Recorded::new(DividedWork::new(CoefficientStage::new(route, trial), lead, monitor), record, monitor);
    let first = if trial { TRIAL } else { CHUNK };
    let again = options.paths.again.unwrap_or(usize::MAX);
    let policy = Policy { retries: options.paths.retries, charts: 1, again, first, batch: CHUNK };
    let mut workspace = RunMemory::default();
    let outcome = run(&mut work, count, &policy, &mut workspace, monitor);
    let mut stage = work.into_inner().into_inner();
    match outcome.flow {
        Flow::Abandoned => return stage.finish(outcome.retracked, true),
        Flow::Found => stage.ends.reassign(count, End::LOST, End::DROPPED),
        Flow::On => stage.lose_doubtful(&workspace.which),
    }
    stage.ends.bounded = outcome.bounded;
    stage.finish(outcome.retracked, false)
}

/// The coefficient stage: its route, and how its paths have ended so far.
pub(super) struct CoefficientStage<'a, 'e, E: Evaluate, S> {
    pub(super) route: Route<'a, 'e, E, S>,
    pub(super) segment: Segment,
    /// The same segment for the trackers with fewer operations.
    pub(super) moving: Option<(&'a Trackers<'e, Interpreter>, MovingParts<'e>)>,
    trial: bool,
    ends: Ends,
    /// Numbers of directions to infinity: of their valuations and winding numbers.
    directions: BTreeMap<(Vec<i64>, usize), usize>,
    /// Where the paths began, if they were tracked there.
    starts: Fingerprints,
    /// Where the paths that needed the endgame were at a common radius.
    middles: Fingerprints,
    pub(super) round: RoundCounts,
    /// The open paths of the batch that have been through the endgame already.
    pub(super) closed: RefCell<BTreeMap<usize, Record>>,
}

/// The progress of a round.
#[derive(Default)]
pub(super) struct RoundCounts {
    /// Paths of the round, those that have been tracked, and those of them with a regular end.
    pub(super) all: usize,
    pub(super) done: usize,
    pub(super) regular: usize,
}

impl<E: Evaluate, S: Source<E>> Work for CoefficientStage<'_, '_, E, S> {
    type Batch = Vec<Record>;
    type Memory = ();

    fn begin(&mut self, _: Round, count: usize) {
        self.round = RoundCounts { all: count, ..RoundCounts::default() };
    }

    fn batch(&self, (): &mut (), numbers: &[usize], round: Round, batch: &mut Vec<Record>) {
        *batch = self.tracked(numbers, round, self.route.monitor);
    }

    fn absorb(&mut self, batch: &mut Vec<Record>, _: Round) -> Flow {
        self.round.done += batch.len();
        for record in &*batch {
            self.take(record);
        }
        if self.is_whole() { Flow::Found } else { Flow::On }
    }

    fn close(&mut self, (): &mut (), batch: &mut Vec<Record>, round: Round) -> Flow {
        let mut closed = self.closed.take();
        let mut ended = Vec::new();
        let open = batch.extract_if(.., |record| record.is_open());
        let open: Vec<Record> = open.filter(|r| closed.remove(&r.path).map(|r| ended.push(r)).is_none()).collect();
        for record in ended {
            self.take(&record);
            batch.push(record);
        }
        for portion in open.chunks(PORTION) {
            for record in self.ended(portion, round, self.route.monitor) {
                self.take(&record);
                batch.push(record);
            }
        }
        self.round.regular += batch.iter().filter(|record| self.ends.regular.contains_key(&record.path)).count();
        if self.is_whole() {
            return Flow::Found;
        }
        let irregular = (self.round.done - self.round.regular) * IRREGULAR > self.round.done;
        let abandoned = self.trial && round.is_first() && irregular && !self.route.monitor.is_cancelled();
        if abandoned { Flow::Abandoned } else { Flow::On }
    }

    fn is_hopeless(&mut self, level: u32, before: usize, _: usize) -> bool {
        // In one unknown there are better ways to all roots than tracking again.
        let is_needless = self.route.has_other_ways && self.route.trackers.system().variables() == 1;
        level == 0 && (is_needless || are_hopeless(before, self.ends.paths))
    }

    fn doubtful(&mut self, (): &mut (), which: &mut Vec<usize>) {
        *which = self.doubts();
        if self.route.options.known.is_some() {
            // Where two paths share an end a solution is missing; other paths need not have one.
            let jumped = self.jumped();
            if !jumped.is_empty() {
                *which = jumped;
            }
        }
    }
}

impl<E: Evaluate, S: Source<E>> Recordable for CoefficientStage<'_, '_, E, S> {
    fn is_of(batch: &Vec<Record>, numbers: &[usize]) -> bool {
        let mut paths: Vec<usize> = batch.iter().map(|record| record.path).collect();
        paths.sort_unstable();
        paths == numbers
    }

    fn solutions(&self) -> u64 {
        (self.ends.regular.len() + self.ends.singular.len()) as u64
    }
}

impl<'a, 'e, E: Evaluate, S: Source<E>> CoefficientStage<'a, 'e, E, S> {
    /// Before anything is tracked.
    pub(super) fn new(route: Route<'a, 'e, E, S>, trial: bool) -> Self {
        let count = route.count;
        let segment = Segment::new(route.start.parameters(), route.target);
        let moving = route.moving.map(|moving| (moving.trackers(), moving.along(segment.clone())));
        CoefficientStage {
            segment,
            moving,
            route,
            trial,
            ends: Ends::new(count),
            directions: BTreeMap::new(),
            starts: Fingerprints::new(count),
            middles: Fingerprints::new(count),
            round: RoundCounts::default(),
            closed: RefCell::default(),
        }
    }
}

impl<E: Evaluate, S: Source<E>> CoefficientStage<'_, '_, E, S> {
    /// Takes a record, which replaces an earlier record of its path.
    fn take(&mut self, record: &Record) {
        let path = record.path;
        self.ends.lose(path);
        self.middles.forget(path);
        self.starts.forget(path);
        if let Some(fingerprint) = &record.begun {
            self.starts.note(path, fingerprint);
        }
        if let Some(fingerprint) = &record.middle {
            self.middles.note(path, fingerprint);
        }
        match &record.end {
            Ending::Regular(refined) => {
                self.ends.set(path, End::SOLUTION);
                self.ends.regular.insert(path, refined.clone());
            }
            Ending::Singular(end) => {
                self.ends.set(path, End::SINGULAR);
                self.ends.singular.insert(path, end.clone());
            }
            Ending::Infinite { valuations, winding } => {
                let next = self.directions.len();
                let direction = *self.directions.entry((valuations.clone(), *winding)).or_insert(next);
                self.ends.set(path, End::infinite(direction));
            }
            Ending::Lost | Ending::Open { .. } | Ending::Undecided { .. } => {}
        }
    }

    /// Whether as many regular solutions are found as are known to exist.
    fn is_whole(&self) -> bool {
        let Some(known) = self.route.options.known.filter(|&known| self.ends.regular.len() >= known) else {
            return false;
        };
        let is_asked = |point: &[Complex64]| self.route.excess.of_regular(point) == Consistency::Solves;
        let asked = self.ends.regular.iter().filter(|(_, end)| is_asked(&end.point));
        let points: Vec<(usize, &[Complex64])> = asked.map(|(&k, end)| (k, &end.point[..])).collect();
        let groups = coincidences(points.iter().copied(), self.route.options.paths.coincidence);
        points.len() - groups.iter().map(|group| group.len() - 1).sum::<usize>() >= known
    }

    /// Gives up paths that still share an end, which counts once, and other doubtful paths.
    fn lose_doubtful(&mut self, which: &[usize]) {
        for &k in which {
            let first = match self.ends.get(k) {
                End::SOLUTION => !which.iter().take_while(|&&j| j < k).any(|&j| self.same_regular(j, k)),
                End::SINGULAR => true,
                _ => false,
            };
            if !first {
                self.ends.lose(k);
            }
        }
    }

    fn same_regular(&self, j: usize, k: usize) -> bool {
        let [a, b] = [j, k].map(|path| self.ends.regular.get(&path));
        let near = |(a, b): (&Refined, &Refined)| {
            relative_distance(&a.point, &b.point) <= self.route.options.paths.coincidence
        };
        a.zip(b).is_some_and(near)
    }

    fn finish(mut self, retracked: usize, abandoned: bool) -> Ends {
        let mut directions = vec![Direction::default(); self.directions.len()];
        for ((valuations, denominator), k) in self.directions {
            directions[k] = Direction { valuations, denominator, paths: 0 };
        }
        for path in 0..self.ends.paths {
            if let Some(direction) = self.ends.get(path).direction().and_then(|k| directions.get_mut(k)) {
                direction.paths += 1;
            }
        }
        (self.ends.directions, self.ends.retracked, self.ends.abandoned) = (directions, retracked, abandoned);
        self.ends
    }

    /// Paths that share a regular end, in their order.
    fn jumped(&self) -> Vec<usize> {
        let regular = self.ends.regular.iter().map(|(&k, refined)| (k, &refined.point[..]));
        let mut which = coincidences(regular, self.route.options.paths.coincidence).concat();
        which.sort_unstable();
        which
    }

    /// Paths that are lost, share a start or a regular end, have a stray one, have crossed on the way, or end in an
    /// incomplete cycle. If the stored data about paths cannot be read, all paths.
    fn doubts(&mut self) -> Vec<usize> {
        let mut which = self.jumped();
        let stray = self.ends.regular.iter().filter(|(_, end)| self.route.excess.is_stray(&end.point));
        which.extend(stray.map(|(&k, _)| k));
        let crossed =
            [self.starts.coinciding(self.route.options.paths.coincidence), self.middles.coinciding(ends::CROSSED)];
        if crossed.iter().any(Result::is_err) {
            (0..self.ends.paths).for_each(|path| self.ends.lose(path));
        }
        which.extend(crossed.into_iter().flatten().flatten());
        let singular = self.ends.singular.iter().map(|(&k, end)| (k, &end.point[..]));
        for group in groups(singular, same::SINGULAR) {
            // Paths of winding number m come in cycles of m.
            let winding = |k: &usize| self.ends.singular.get(k).map_or(1, |end| end.winding);
            for k in &group {
                let alike = group.iter().filter(|&j| winding(j) == winding(k)).count();
                if !alike.is_multiple_of(winding(k)) {
                    which.push(*k);
                }
            }
        }
        which.extend((0..self.ends.paths).filter(|&path| self.ends.get(path) == End::LOST));
        which.sort_unstable();
        which.dedup();
        which
    }
}

#[cfg(test)]
#[path = "paths_tests.rs"]
mod tests;
