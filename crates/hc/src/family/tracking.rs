//! One pass over paths of a fibre: they are tracked and judged, and replace the results of earlier passes.

use super::charts::{Charts, OneChart, Remainders};
use super::fibre::{Fibre, FibreOptions};
use crate::distinct::Coincidences;
use crate::homotopy::{ParameterPath, Segment};
use crate::monitor::Monitor;
use crate::ranks::{RanksError, Shareable, Task, Worker};
use crate::refine::{Refined, Refiner};
use crate::runner::{Flow, Round, Work};
use crate::tolerances::families;
use crate::tracker::{PathEnd, PathResult, PathSet, Tracker, TrackerOptions, Trackers};
use num_complex::Complex64;
use poly::{Evaluate, Lanes8};
use std::cell::Cell;

/// More lost paths than this tell of a degenerate member of the family rather than of bad luck.
const BAD_LUCK: usize = 4;

/// In several charts, a level of more than [`LONG`] steps in all has to bring back at least one in so many
/// lost paths, or no other level follows. If fewer paths are lost, it may bring back none.
const WORTHWHILE: usize = 8;
const LONG: usize = 100_000;

/// If after the first level more than one path in so many is lost, and that took more than [`VERY_LONG`]
/// steps, no other level follows: the member is degenerate, and what is lost is at infinity or singular.
const MANY: usize = 16;
const VERY_LONG: usize = 500_000;

/// Where paths are tracked.
pub(super) enum PathTrackers<'a, E: Evaluate> {
    /// In the lanes of one tracker.
    One(Box<Tracker<'a, E, Lanes8>>),
    /// On all threads.
    Threads(Trackers<'a, E>),
}

/// What a batch needs besides its arguments.
pub(super) struct FibreMemory<'a, E: Evaluate> {
    lanes: PathTrackers<'a, E>,
    refiner: Refiner<'a, E>,
    refined: Refined,
    coincidences: Coincidences,
    from: Vec<f64>,
    carried: Vec<Complex64>,
    back: Vec<Complex64>,
    segment: Segment,
    ends: [Vec<Complex64>; 2],
    paths: PathSet,
    which: Vec<usize>,
}

impl<'a, E: Evaluate> FibreMemory<'a, E> {
    /// Memory for so many paths of a fibre.
    pub(super) fn new(system: &'a E, lanes: PathTrackers<'a, E>, fibre: &Fibre, paths: usize) -> Self {
        FibreMemory {
            lanes,
            refiner: Refiner::new(system),
            refined: Refined { point: Vec::with_capacity(fibre.dimension), ..Refined::default() },
            coincidences: Coincidences::with_capacity(paths),
            from: Vec::with_capacity(paths),
            carried: Vec::with_capacity(paths * fibre.dimension),
            back: Vec::with_capacity(fibre.dimension),
            segment: Segment::new(&fibre.parameters, &fibre.parameters),
            ends: [0, 1].map(|_| Vec::with_capacity(fibre.parameters.len())),
            paths: PathSet::with_capacity(fibre.dimension, paths),
            which: Vec::with_capacity(paths),
        }
    }
}

impl<E: Evaluate> PathTrackers<'_, E> {
    /// Tracks the paths with these numbers into `starts` and appends them to `out`.
    fn track<P: ParameterPath>(
        &mut self,
        path: &P,
        starts: &[Complex64],
        which: &[usize],
        options: &TrackerOptions,
        monitor: &Monitor,
        out: &mut PathSet,
    ) {
        match self {
            PathTrackers::One(tracker) => {
                tracker.set_options(options);
                tracker.set_monitor(monitor);
                tracker.track(path, starts, which.iter().copied(), out);
            }
            PathTrackers::Threads(trackers) => *out = trackers.track(path, starts, which, options, monitor),
        }
    }
}

/// The paths of a fibre to a target.
pub(super) struct FibreWork<'r, 'a, E: Evaluate, C, U> {
    pub(super) system: &'a E,
    pub(super) charts: &'r C,
    pub(super) fibre: &'r Fibre,
    pub(super) target: &'r [Complex64],
    pub(super) options: &'r FibreOptions,
    pub(super) monitor: &'r Monitor,
    /// The ends that are known so far.
    pub(super) paths: &'r mut PathSet,
    pub(super) enough: U,
    /// Steps of all paths before the last level.
    pub(super) steps: usize,
    /// In a batch on several ranks, the paths that were reported to the monitor.
    pub(super) reported: Cell<usize>,
}

impl<'a, E, C, U> Work for FibreWork<'_, 'a, E, C, U>
where
    E: Evaluate,
    C: Charts,
    U: FnMut(&PathSet) -> bool,
{
    type Batch = PathSet;
    type Memory = FibreMemory<'a, E>;

    fn begin(&mut self, _: Round, _: usize) {
        self.reported.set(0);
    }

    fn batch(&self, scratch: &mut FibreMemory<'a, E>, numbers: &[usize], round: Round, batch: &mut PathSet) {
        self.pass(scratch, numbers, round, self.monitor, batch);
    }

    fn absorb(&mut self, batch: &mut PathSet, round: Round) -> Flow {
        let FibreWork { paths, enough, .. } = self;
        if round.is_first() {
            let found = enough(batch);
            paths.append(batch);
            return if found { Flow::Found } else { Flow::On };
        }
        for (result, point) in batch.iter() {
            let k = result.path;
            let old = paths.results()[k];
            let work = PathResult {
                accepted: old.accepted + result.accepted,
                rejected: old.rejected + result.rejected,
                jacobians: old.jacobians + result.jacobians,
                ..if is_better::<C>(result) { *result } else { old }
            };
            if is_better::<C>(result) {
                paths.replace(k, work, point);
            } else {
                paths.replace_record(k, work);
            }
        }
        Flow::On
    }

    fn doubtful(&mut self, scratch: &mut FibreMemory<'a, E>, which: &mut Vec<usize>) {
        let FibreWork { paths, options, .. } = self;
        paths.sort();
        doubtful(paths, options.coincidence, &mut scratch.coincidences, which);
    }

    fn is_hopeless(&mut self, level: u32, before: usize, after: usize) -> bool {
        let steps: usize = self.paths.results().iter().map(|r| r.accepted + r.rejected).sum();
        let spent = steps.saturating_sub(std::mem::replace(&mut self.steps, steps));
        let useless = level > 0 && after > BAD_LUCK && after > before - before / WORTHWHILE && spent > LONG;
        let degenerate = level == 0 && after > self.fibre.len() / MANY && spent > VERY_LONG;
        C::COUNT > 1 && (useless || degenerate)
    }
}

/// Only rounds in one chart are shared: in several charts, they go on from where paths broke off.
impl<E, C, U> Shareable for FibreWork<'_, '_, E, C, U>
where
    E: Evaluate,
    C: Charts,
    U: FnMut(&PathSet) -> bool,
{
    type End = (PathResult, Vec<Complex64>);

    fn ends(&self, numbers: &[usize], round: Round) -> Vec<Self::End> {
        let fibre = self.fibre;
        let trackers = Trackers::from_solutions(self.system, &fibre.parameters, &fibre.solutions);
        let lanes = PathTrackers::Threads(trackers);
        let mut scratch = FibreMemory::new(self.system, lanes, fibre, numbers.len());
        let mut batch = PathSet::with_capacity(fibre.dimension, numbers.len());
        // The progress of a batch is told as a whole.
        self.pass(&mut scratch, numbers, round, &self.monitor.quiet(), &mut batch);
        batch.sort();
        batch.iter().map(|(result, point)| (*result, point.to_vec())).collect()
    }

    fn is_end(&self, (result, point): &Self::End, number: usize) -> bool {
        result.path == number && point.len() == self.fibre.dimension
    }

    fn gather(&self, ends: Vec<Self::End>, batch: &mut PathSet) {
        batch.clear(self.fibre.dimension);
        for (result, point) in ends {
            batch.push(result, point);
        }
    }

    fn reached(&self, paths: usize) {
        let before = self.reported.replace(paths);
        self.monitor.add(paths.saturating_sub(before) as u64, 0);
    }
}

/// Tracks paths of a fibre for rank 0 as long as it sends any.
///
/// # Panics
/// If the system is not square, or the fibre or the target does not fit it.
pub(super) fn serve_fibre<E: Evaluate, T>(
    worker: &Worker<'_>,
    task: &Task<T>,
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
) -> Result<(), RanksError> {
    let work = FibreWork {
        system,
        charts: &OneChart,
        fibre,
        target,
        options,
        monitor: &task.monitor,
        paths: &mut PathSet::new(fibre.dimension),
        enough: |_: &PathSet| false,
        steps: 0,
        reported: Cell::default(),
    };
    worker.serve(task, |numbers, round| work.ends(numbers, round))
}

/// Whether a path that was tracked again has come farther than before. Where paths go to infinity
/// in one of several charts, they may end in the others.
fn is_better<C: Charts>(result: &PathResult) -> bool {
    match result.end {
        PathEnd::Success => true,
        PathEnd::AtInfinity => C::COUNT == 1,
        _ => C::COUNT > 1 && is_broken_off(result),
    }
}

/// Whether a path ended on the way, at a point from which it may go on in another chart.
fn is_broken_off(result: &PathResult) -> bool {
    matches!(result.end, PathEnd::MaxSteps | PathEnd::StepTooSmall | PathEnd::AccuracyLimit) && result.t > 0.0
}

/// The settings of a level, at all of which paths are tracked with all care. In several charts the number
/// of steps grows, so that a path gets farther with shorter steps.
fn stricter<C: Charts>(settings: &TrackerOptions, level: u32) -> TrackerOptions {
    if level == 0 {
        return TrackerOptions { quick: false, ..settings.clone() };
    }
    let stricter = settings.stricter(level);
    if C::COUNT == 1 {
        return stricter;
    }
    TrackerOptions { max_steps: settings.max_steps.saturating_mul(1 << (2 * level).min(20)), ..stricter }
}

impl<'a, E: Evaluate, C: Charts, U> FibreWork<'_, 'a, E, C, U> {
    /// Tracks the paths with these numbers in a round.
    fn pass(
        &self,
        scratch: &mut FibreMemory<'a, E>,
        numbers: &[usize],
        round: Round,
        monitor: &Monitor,
        batch: &mut PathSet,
    ) {
        let FibreMemory { ends, segment, .. } = scratch;
        for (end, p) in ends.iter_mut().zip([&self.fibre.parameters[..], self.target]) {
            end.clear();
            self.charts.parameters(round.chart, p, end);
        }
        segment.join(&ends[0], &ends[1]);
        batch.clear(self.fibre.dimension);
        if round.is_first() {
            let options = self.options.tracker.first(self.fibre.is_partial);
            scratch.lanes.track(&scratch.segment, &self.fibre.solutions, numbers, &options, monitor, batch);
            settle(&mut scratch.refiner, self.target, batch);
        } else {
            self.again(scratch, numbers, round, monitor, batch);
        }
    }

    /// Tracks paths again in a chart, along its segment, from the start or, if they go on, from where they broke off.
    fn again(
        &self,
        scratch: &mut FibreMemory<'a, E>,
        numbers: &[usize],
        Round { level, chart }: Round,
        monitor: &Monitor,
        batch: &mut PathSet,
    ) {
        let FibreMemory { lanes, refiner, refined, from, carried, back, segment, paths, which, .. } = scratch;
        let goes_on = chart > 0 && level.is_multiple_of(2);
        from.clear();
        carried.clear();
        for &k in numbers {
            // What has become of a path is not known to a rank that begins it anew.
            let broken = goes_on.then(|| &self.paths.results()[k]).filter(|result| is_broken_off(result));
            from.push(broken.map_or(1.0, |result| result.t));
            let point = if broken.is_some() { self.paths.point(k) } else { self.fibre.solution(k) };
            self.charts.enter(chart, point, carried);
        }
        which.clear();
        which.extend(0..numbers.len());
        paths.clear(self.fibre.dimension);
        let rests = Remainders { segment, from };
        lanes.track(&rests, carried, which, &stricter::<C>(&self.options.tracker, level), monitor, paths);
        if chart == 0 {
            settle(refiner, self.target, paths);
        }
        for (result, point) in paths.iter() {
            let mut record = PathResult { path: numbers[result.path], t: result.t * from[result.path], ..*result };
            back.clear();
            self.charts.leave(chart, point, back);
            if chart > 0 && result.end == PathEnd::Success {
                let regular = ends_regularly(refiner, segment.target(), result, point);
                if regular {
                    refiner.refine_into(self.target, back, refined);
                }
                if regular && refined.accuracy < families::CARRIED {
                    back.copy_from_slice(&refined.point);
                } else {
                    record.end = PathEnd::Singular;
                }
            }
            if back.iter().any(|z| !z.is_finite()) {
                record.end = PathEnd::Singular;
            }
            batch.push(record, back.iter().copied());
        }
    }
}

/// Whether a path with this record has reached a regular solution `x` (one entry per unknown) for
/// the parameters `target` (one entry per parameter).
///
/// A system may have components of singular solutions besides its fibre. Newton's method converges
/// to them too, slowly, and this does not show where coordinates vanish. Newton's method must
/// therefore return to an end with such coordinates, or with a singular Jacobian, from some
/// distance, if need be in double-double.
fn ends_regularly<E: Evaluate>(
    refiner: &mut Refiner<'_, E>,
    target: &[Complex64],
    result: &PathResult,
    x: &[Complex64],
) -> bool {
    let largest = x.iter().map(|z| z.norm_sqr()).fold(0.0, f64::max);
    let plain = || result.pivot > f64::EPSILON && x.iter().all(|z| z.norm_sqr() > families::VANISHED_SQR * largest);
    let mut attracts = || refiner.contracts(target, x) || refiner.contracts_precisely(target, x);
    result.end == PathEnd::Success && (plain() || attracts())
}

/// Refines the regular ends that the tracker leaves vague, so that coinciding ends can be
/// recognised. Where Newton's method does not settle, or the end is not a regular solution, the
/// path becomes [`PathEnd::Singular`].
fn settle<E: Evaluate>(refiner: &mut Refiner<'_, E>, target: &[Complex64], paths: &mut PathSet) {
    let mut refined = std::mem::take(&mut refiner.spare);
    for k in 0..paths.len() {
        let result = paths.results()[k];
        if result.end != PathEnd::Success {
            continue;
        }
        if !ends_regularly(refiner, target, &result, paths.point(k)) {
            paths.replace_record(k, PathResult { end: PathEnd::Singular, ..result });
        } else if result.accuracy > families::VAGUE {
            refiner.refine_into(target, paths.point(k), &mut refined);
            let end = if refined.accuracy <= families::SETTLED { PathEnd::Success } else { PathEnd::Singular };
            paths.replace(k, PathResult { end, accuracy: refined.accuracy, ..result }, &refined.point);
        }
    }
    refiner.spare = refined;
}

/// Writes to `which` the paths that failed or share a regular end with another path, by the index
/// of their start solutions. These have to be tracked again.
///
/// `paths` must hold the paths `0 .. len` in order.
fn doubtful(paths: &PathSet, tolerance: f64, memory: &mut Coincidences, which: &mut Vec<usize>) {
    which.clear();
    let results = paths.results();
    let regular = (0..paths.len()).filter(|&k| results[k].end == PathEnd::Success);
    memory.members(regular, |k| paths.point(k), tolerance, which);
    for k in which.iter_mut() {
        *k = results[*k].path;
    }
    which.extend(results.iter().filter(|r| !r.end.is_good()).map(|r| r.path));
    which.sort_unstable();
    which.dedup();
}
