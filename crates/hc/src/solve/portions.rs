//! Paths of the coefficient stage in portions: tracked, taken through the endgame, and handed to other
//! ranks.

use super::fingerprints::Fingerprint;
use super::paths::{CoefficientStage, Route};
use super::record::Record;
use crate::distinct::relative_distance;
use crate::endgame::{EndgameOptions, Ending, SingularEnd, endgame};
use crate::homotopy::Segment;
use crate::monitor::{self, Monitor};
use crate::ranks::{RanksError, Shareable, Task, Worker};
use crate::refine::{Refined, Refiner};
use crate::runner::Round;
use crate::start::{Source, StartSolutions};
use crate::threads::IntoParallelIterator;
// Without threads, iterators have `map` of their own.
#[cfg(feature = "threads")]
use crate::threads::ParallelIterator;
use crate::tolerances::{ends, same};
use crate::tracker::{PathEnd, PathSet, TrackerOptions};
use num_complex::Complex64;
use poly::Evaluate;
use serde::{Deserialize, Serialize};

/// Number of ends that one thread refines at a time.
const PART: usize = 64;

/// Number of paths beside which it takes no time to make refiners anew.
const MANY: usize = 1024;

impl<E: Evaluate, S: Source<E>> CoefficientStage<'_, '_, E, S> {
    fn settings(&self, round: Round) -> TrackerOptions {
        let given = &self.route.options.paths.tracker;
        if round.level == 0 { given.first(self.route.start.is_partial()) } else { given.stricter(round.level) }
    }

    /// The settings of the endgame: from the second round again on it begins early in every second one,
    /// for paths on which too few digits are left before.
    fn endgame(&self, round: Round) -> EndgameOptions {
        let options = self.route.options.endgame.clone();
        let early = round.level > 0 && round.level.is_multiple_of(2);
        let start = if early { options.start.max(ends::EARLY) } else { options.start };
        EndgameOptions { start, ..options }
    }

    /// Tracks paths to regular ends, or to the point where the endgame begins. Returns one record
    /// per path, in order; none once the work is cancelled.
    pub(super) fn tracked(&self, numbers: &[usize], round: Round, monitor: &Monitor) -> Vec<Record> {
        let Route { trackers, start, .. } = self.route;
        if monitor.is_cancelled() {
            // Not even start solutions are made any more; there may be millions of paths to come.
            return Vec::new();
        }
        let settings = self.settings(round);
        if start.is_tracked() {
            monitor.enter(monitor::Stage::Start, numbers.len() as u64);
        }
        let reached = start.solutions(trackers, numbers, &settings, monitor);
        monitor.enter(monitor::Stage::Paths, self.round.all as u64);
        monitor.add(self.round.done as u64, self.round.regular as u64);
        let tracker = TrackerOptions { endgame_start: 0.0, min_t: self.endgame(round).start, ..settings };
        let all: Vec<usize> = (0..reached.numbers.len()).collect();
        let points = &reached.points;
        let paths = match &self.moving {
            Some((trackers, path)) => trackers.track(path, points, &all, &tracker, monitor),
            None => trackers.track(&self.segment, points, &all, &tracker, monitor),
        };
        let ends = self.ends_of(&paths, &reached);
        let mut records: Vec<Record> = numbers.iter().map(|&path| Record::lost(path)).collect();
        for (result, end) in paths.results().iter().zip(ends) {
            let path = reached.numbers[result.path];
            let begun = start.is_tracked().then(|| Fingerprint::new(reached.point(result.path), !round.is_first()));
            if let Ok(k) = numbers.binary_search(&path) {
                records[k] = Record { path, begun, middle: None, end };
            }
        }
        records
    }

    /// How tracked paths end: regularly, where refinement says so, or not yet.
    fn ends_of(&self, paths: &PathSet, reached: &StartSolutions) -> impl Iterator<Item = Ending> {
        let Route { refiners, target, .. } = self.route;
        let arrived: Vec<usize> = (0..paths.len()).filter(|&k| paths.results()[k].end == PathEnd::Success).collect();
        let refined = |part: usize| {
            let end = arrived.len().min((part + 1) * PART);
            let points: Vec<&[Complex64]> = arrived[part * PART..end].iter().map(|&k| paths.point(k)).collect();
            refiners.with(target, |refiner| {
                let refined = refiner.refine(&points).into_iter().zip(points);
                let is_regular = |(refined, point): (Refined, &[Complex64])| {
                    let near = relative_distance(&refined.point, point) < ends::ARRIVED;
                    (near && refiner.single().is_regular(target, &refined)).then_some(refined)
                };
                refined.map(is_regular).collect()
            })
        };
        let regular: Vec<Vec<Option<Refined>>> =
            (0..arrived.len().div_ceil(PART)).into_par_iter().map(refined).collect();
        if paths.len() >= MANY {
            // Their memory would be held while other paths are tracked.
            refiners.release();
        }
        let mut regular = regular.into_iter().flatten();
        paths.iter().map(move |(result, point)| match result.end {
            // Once more up to where the endgame begins, if not regular.
            PathEnd::Success => regular
                .next()
                .flatten()
                .map_or_else(|| Ending::Undecided { start: reached.point(result.path).to_vec() }, Ending::Regular),
            PathEnd::Singular => Ending::Open { t: result.t, point: point.to_vec() },
            _ => Ending::Lost,
        })
    }

    /// Takes open paths through the endgame. Returns one record per path, in order.
    pub(super) fn ended(&self, open: &[Record], round: Round, monitor: &Monitor) -> Vec<Record> {
        let Route { trackers, start, target, .. } = self.route;
        let settings = self.settings(round);
        // Paths that seemed to reach the target, but not at a regular solution: once more up to
        // where the endgame begins.
        let options = self.endgame(round);
        let begin = options.start;
        let near: Vec<Complex64> =
            self.segment.target().iter().zip(self.segment.direction()).map(|(p, d)| p + d * begin).collect();
        let tracker = TrackerOptions { endgame_start: 0.0, ..settings };
        let to_near = Segment::new(start.parameters(), &near);
        let mut undecided = Vec::new();
        let mut starts = Vec::new();
        let mut handed: Vec<(usize, f64, &[Complex64])> = Vec::new();
        for (k, record) in open.iter().enumerate() {
            match &record.end {
                Ending::Undecided { start } => {
                    undecided.push(k);
                    starts.extend_from_slice(start);
                }
                Ending::Open { t, point } => handed.push((k, *t, point)),
                _ => {}
            }
        }
        let all: Vec<usize> = (0..undecided.len()).collect();
        let held = trackers.track(&to_near, &starts, &all, &tracker, monitor);
        let held = held.iter().filter(|(r, _)| r.end == PathEnd::Success);
        handed.extend(held.map(|(r, x)| (undecided[r.path], begin, x)));
        let mut records: Vec<Record> =
            open.iter().map(|record| Record { begun: record.begun.clone(), ..Record::lost(record.path) }).collect();
        let mut refiner = Refiner::new(trackers.system());
        let ends = endgame(trackers, &self.segment, handed, self.route.count, &tracker, &options, monitor);
        for (k, end, middle) in ends {
            records[k].middle = (!middle.is_empty()).then(|| Fingerprint::new(&middle, !round.is_first()));
            records[k].end = decided(&mut refiner, target, end, !round.is_first());
        }
        records
    }
}

/// The end of a path after its endgame; if it is regular after all, it is refined. A path
/// that comes to the target along the radius `again`, although it is singular there, ends on a
/// component.
fn decided<E: Evaluate>(refiner: &mut Refiner<'_, E>, target: &[Complex64], end: Ending, again: bool) -> Ending {
    if let Ending::Open { point, .. } | Ending::Singular(SingularEnd { point, winding: 1, .. }) = &end {
        let refined = refiner.refine(target, point);
        let near = relative_distance(&refined.point, point) < same::SINGULAR;
        if near && refiner.is_regular(target, &refined) {
            return Ending::Regular(refined);
        }
    }
    match end {
        Ending::Open { point, .. } if again => {
            Ending::Singular(SingularEnd { point, winding: 1, error: ends::REACHED })
        }
        Ending::Open { .. } => Ending::Lost,
        end => end,
    }
}

/// A start system, as rank 0 describes it to the others, which make it themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Announced {
    /// Whether it is that of one stage, on trial.
    pub(super) trial: bool,
    pub(super) attempt: u64,
}

/// Tracks paths of a route for rank 0 as long as it sends any.
pub(super) fn serve<E: Evaluate, S: Source<E>>(
    worker: &Worker<'_>,
    task: &Task<Announced>,
    route: Route<'_, '_, E, S>,
) -> Result<(), RanksError> {
    let stage = CoefficientStage::new(route, task.content.trial);
    worker.serve(task, |numbers, round| stage.ends(numbers, round))
}

impl<E: Evaluate, S: Source<E>> Shareable for CoefficientStage<'_, '_, E, S> {
    /// How far a path gets in one go: up to the endgame, and if it needs that through it.
    type End = (Record, Option<Record>);

    fn ends(&self, numbers: &[usize], round: Round) -> Vec<Self::End> {
        // The progress of a batch is told as a whole.
        let monitor = self.route.monitor.quiet();
        let records = self.tracked(numbers, round, &monitor);
        let (places, open): (Vec<usize>, Vec<Record>) =
            records.iter().enumerate().filter(|(_, record)| record.is_open()).map(|(k, r)| (k, r.clone())).unzip();
        let mut ends: Vec<Self::End> = records.into_iter().map(|record| (record, None)).collect();
        for (k, record) in places.into_iter().zip(self.ended(&open, round, &monitor)) {
            ends[k].1 = Some(record);
        }
        ends
    }

    fn is_end(&self, end: &Self::End, path: usize) -> bool {
        let unknowns = self.route.trackers.system().variables();
        let fits = |record: &Record| record.path == path && record.fits(unknowns);
        let (record, ended) = end;
        fits(record) && ended.as_ref().is_none_or(|ended| record.is_open() && fits(ended) && !ended.is_open())
    }

    fn gather(&self, ends: Vec<Self::End>, batch: &mut Vec<Record>) {
        batch.clear();
        let mut closed = self.closed.borrow_mut();
        closed.clear();
        for (record, ended) in ends {
            closed.extend(ended.map(|record| (record.path, record)));
            batch.push(record);
        }
    }

    fn reached(&self, paths: usize) {
        let (monitor, all) = (self.route.monitor, self.round.all as u64);
        let progress = monitor.progress();
        if (progress.stage, progress.total) != (monitor::Stage::Paths, all) {
            monitor.enter(monitor::Stage::Paths, all);
        }
        monitor.reach((self.round.done + paths) as u64, self.round.regular as u64);
    }
}
