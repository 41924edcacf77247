//! Fibres tracked to other parameters, with jumped and broken paths found and tracked again.

use super::charts::{Charts, OneChart, Rests};
use super::fibre::{Fibre, FibreOptions, PathCounts};
use super::judge::{doubtful, ends_regularly, settle};
use crate::distinct::Coincidences;
use crate::homotopy::{ParameterPath, Segment};
use crate::monitor::Monitor;
use crate::refine::{Refined, Refiner};
use crate::runner::{Flow, Policy, Room, Round, Work, run};
use crate::tracker::{PathEnd, PathResult, PathSet, Tracker, TrackerOptions, Trackers};
use num_complex::Complex64;
use poly::{Evaluate, Lanes8};
use std::marker::PhantomData;

/// Accuracy to which the end of a path that is carried back from another chart must be known.
const CARRIED: f64 = 1e-8;

/// More lost paths than this tell of a degenerate member of the family rather than of bad luck.
const BAD_LUCK: usize = 4;

/// In several charts: of so many lost paths a level of more than [`LONG`] steps in all brings back
/// one at least, or there is no other level; of fewer it may bring back none.
const WORTHWHILE: usize = 8;
const LONG: usize = 100_000;

/// Tracks all solutions of a fibre to the parameters `target`, on the threads of the current rayon
/// pool.
///
/// Regular endpoints that coincide prove that a path has jumped: all paths that share an end, and
/// all that failed, are tracked again with stricter steps. What is still not whole afterwards is
/// counted as failed.
///
/// # Panics
/// If the system is not square or `target` or the fibre do not fit it.
pub fn track_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
) -> (PathSet, PathCounts) {
    track_fibre_watched(system, fibre, target, options, &Monitor::default())
}

/// [`track_fibre`], watched.
pub(crate) fn track_fibre_watched<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
    monitor: &Monitor,
) -> (PathSet, PathCounts) {
    let mut tracker = FibreTracker::over(system, OneChart, Lanes::Threads(Trackers::new(system)), fibre);
    tracker.monitor.clone_from(monitor);
    let counts = tracker.track(fibre, target, options);
    (tracker.paths, counts)
}

/// The whole fibre at other parameters, every solution refined to the last digit; `None` if a path
/// was lost.
///
/// # Panics
/// If the system is not square, or the fibre or the target does not fit it.
pub fn move_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
) -> Option<Fibre> {
    move_fibre_watched(system, fibre, target, options, &Monitor::default())
}

/// [`move_fibre`], watched.
pub(crate) fn move_fibre_watched<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
    monitor: &Monitor,
) -> Option<Fibre> {
    let (ends, counts) = track_fibre_watched(system, fibre, target, options, monitor);
    let mut refiner = Refiner::new(system);
    let solutions = ends.iter().flat_map(|(_, x)| refiner.refine(target, x).point);
    (counts.finite == fibre.len()).then(|| Fibre::new(target.to_vec(), fibre.dimension, solutions.collect()))
}

/// Tracks fibres of one family again and again, on one thread; keeps its memory from call to call.
///
/// In several [`Charts`] a lost path goes on in the next chart from where it broke off, and at
/// stricter levels starts again in all of them.
pub struct FibreTracker<'a, E: Evaluate, C: Charts = OneChart> {
    charts: C,
    monitor: Monitor,
    paths: PathSet,
    segment: Segment,
    ends: [Vec<Complex64>; 2],
    room: Room<Scratch<'a, E>, PathSet>,
}

/// Where paths are tracked.
enum Lanes<'a, E: Evaluate> {
    /// In the lanes of one tracker.
    One(Box<Tracker<'a, E, Lanes8>>),
    /// On all threads.
    Threads(Trackers<'a, E>),
}

/// What a batch needs besides its arguments.
struct Scratch<'a, E: Evaluate> {
    lanes: Lanes<'a, E>,
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

impl<'a, E: Evaluate, C: Charts> FibreTracker<'a, E, C> {
    /// A tracker for a square system, with room for fibres of the size of `fibre`.
    ///
    /// # Panics
    /// If the system does not have as many equations as unknowns.
    pub fn new(system: &'a E, charts: C, fibre: &Fibre) -> Self {
        let tracker = Tracker::new(system, &TrackerOptions::default());
        FibreTracker::over(system, charts, Lanes::One(Box::new(tracker)), fibre)
    }

    fn over(system: &'a E, charts: C, lanes: Lanes<'a, E>, fibre: &Fibre) -> Self {
        let (paths, dimension) = (fibre.len(), fibre.dimension);
        let ends = || [0, 1].map(|_| Vec::with_capacity(fibre.parameters.len()));
        let scratch = Scratch {
            lanes,
            refiner: Refiner::new(system),
            refined: Refined { point: Vec::with_capacity(dimension), ..Refined::default() },
            coincidences: Coincidences::with_capacity(paths),
            from: Vec::with_capacity(paths),
            carried: Vec::with_capacity(paths * dimension),
            back: Vec::with_capacity(dimension),
            segment: Segment::new(&fibre.parameters, &fibre.parameters),
            ends: ends(),
            paths: PathSet::with_capacity(dimension, paths),
            which: Vec::with_capacity(paths),
        };
        // A path may be lost and share its end.
        let which = Vec::with_capacity(2 * paths);
        let batch = PathSet::with_capacity(dimension, paths);
        FibreTracker {
            charts,
            monitor: Monitor::default(),
            paths: PathSet::with_capacity(dimension, paths),
            segment: Segment::new(&fibre.parameters, &fibre.parameters),
            ends: ends(),
            room: Room { memory: scratch, batch, which },
        }
    }

    /// Replaces who may stop the work to come. Nobody at first.
    pub fn set_monitor(&mut self, monitor: &Monitor) {
        self.monitor.clone_from(monitor);
    }

    /// The records and ends of the last call, in the order of the fibre.
    pub fn paths(&self) -> &PathSet {
        &self.paths
    }

    /// Replaces the records, for instance by those of an earlier call.
    pub fn set_paths(&mut self, paths: PathSet) {
        self.paths = paths;
    }

    /// Tracks all solutions of a fibre to the parameters `target`, until each is accounted for or
    /// everything has been tried; see [`paths`](Self::paths) for their ends.
    ///
    /// # Panics
    /// If `target` or the fibre do not fit the system.
    pub fn track(&mut self, fibre: &Fibre, target: &[Complex64], options: &FibreOptions) -> PathCounts {
        self.track_until(fibre, target, options, fibre.len(), |_| false).0
    }

    /// [`track`](Self::track) in portions of `size` paths in the first pass, which `enough` is
    /// shown: once it says so, the rest of the paths is left. Returns also whether it did; the
    /// counts are then of the paths so far.
    ///
    /// # Panics
    /// Those of [`track`](Self::track).
    pub fn track_until(
        &mut self,
        fibre: &Fibre,
        target: &[Complex64],
        options: &FibreOptions,
        size: usize,
        enough: impl FnMut(&PathSet) -> bool,
    ) -> (PathCounts, bool) {
        for (chart, p) in self.ends.iter_mut().zip([&fibre.parameters[..], target]) {
            chart.clear();
            self.charts.parameters(0, p, chart);
        }
        self.segment.join(&self.ends[0], &self.ends[1]);
        self.paths.clear(fibre.dimension);
        let tracking = Tracking {
            charts: &self.charts,
            fibre,
            segment: &self.segment,
            target,
            options,
            monitor: &self.monitor,
            paths: &mut self.paths,
            enough,
            steps: 0,
        };
        let policy = Policy { retries: options.retries, charts: C::COUNT, first: size, batch: size };
        let mut work = Over { tracking, system: PhantomData };
        let outcome = run(&mut work, fibre.len(), &policy, &mut self.room, &self.monitor);
        let found = outcome.flow == Flow::Found;
        let failed = if found { 0 } else { self.room.which.len() };
        (PathCounts { retracked: outcome.retracked, ..self.counts(failed) }, found)
    }

    /// How the paths of the last call have ended, of which `failed` are lost.
    pub fn counts(&self, failed: usize) -> PathCounts {
        let (tracked, at_infinity) = (self.paths.len(), self.paths.count(PathEnd::AtInfinity));
        let finite = tracked.saturating_sub(at_infinity + failed);
        PathCounts { tracked, finite, at_infinity, failed, dropped: 0, retracked: 0 }
    }
}

impl<E: Evaluate> Lanes<'_, E> {
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
            Lanes::One(tracker) => {
                tracker.set_options(options);
                tracker.set_monitor(monitor);
                tracker.track(path, starts, which.iter().copied(), out);
            }
            Lanes::Threads(trackers) => *out = trackers.track(path, starts, which, options, monitor),
        }
    }
}

/// The paths of a fibre to a target.
struct Tracking<'r, C, U> {
    charts: &'r C,
    fibre: &'r Fibre,
    /// The way from there to the target in chart 0.
    segment: &'r Segment,
    target: &'r [Complex64],
    options: &'r FibreOptions,
    monitor: &'r Monitor,
    /// The ends so far.
    paths: &'r mut PathSet,
    enough: U,
    /// Steps of all paths before the last level.
    steps: usize,
}

/// Ties the memory of a batch to the system it is for.
struct Over<'r, 'a, E: Evaluate, C, U> {
    tracking: Tracking<'r, C, U>,
    system: PhantomData<&'a E>,
}

impl<'a, E, C, U> Work for Over<'_, 'a, E, C, U>
where
    E: Evaluate,
    C: Charts,
    U: FnMut(&PathSet) -> bool,
{
    type Batch = PathSet;
    type Memory = Scratch<'a, E>;

    fn batch(&self, scratch: &mut Scratch<'a, E>, numbers: &[usize], round: Round, batch: &mut PathSet) {
        batch.clear(self.tracking.fibre.dimension);
        if round.is_first() {
            self.tracking.first(scratch, numbers, batch);
        } else {
            self.tracking.again(scratch, numbers, round, batch);
        }
    }

    fn absorb(&mut self, batch: &mut PathSet, round: Round) -> Flow {
        let Tracking { paths, enough, .. } = &mut self.tracking;
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

    fn doubtful(&mut self, scratch: &mut Scratch<'a, E>, which: &mut Vec<usize>) {
        let Tracking { paths, options, .. } = &mut self.tracking;
        paths.sort();
        doubtful(paths, options.coincidence, &mut scratch.coincidences, which);
    }

    fn is_hopeless(&mut self, level: u32, before: usize, after: usize) -> bool {
        let tracking = &mut self.tracking;
        let steps: usize = tracking.paths.results().iter().map(|r| r.accepted + r.rejected).sum();
        let spent = steps.saturating_sub(std::mem::replace(&mut tracking.steps, steps));
        C::COUNT > 1 && level > 0 && after > BAD_LUCK && after > before - before / WORTHWHILE && spent > LONG
    }
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

/// The steps of a level; in several charts so many more that a path gets farther with shorter ones.
fn stricter<C: Charts>(settings: &TrackerOptions, level: u32) -> TrackerOptions {
    if level == 0 {
        return settings.clone();
    }
    let stricter = settings.stricter(level);
    if C::COUNT == 1 {
        return stricter;
    }
    TrackerOptions { max_steps: settings.max_steps.saturating_mul(1 << (2 * level).min(20)), ..stricter }
}

impl<C: Charts, U> Tracking<'_, C, U> {
    /// Tracks paths for the first time.
    fn first<E: Evaluate>(&self, scratch: &mut Scratch<'_, E>, numbers: &[usize], batch: &mut PathSet) {
        let Scratch { lanes, refiner, .. } = scratch;
        lanes.track(self.segment, &self.fibre.solutions, numbers, &self.options.tracker, self.monitor, batch);
        settle(refiner, self.target, batch);
    }

    /// Tracks paths again in a chart, from the start or, if they go on, from where they broke off.
    fn again<E: Evaluate>(
        &self,
        scratch: &mut Scratch<'_, E>,
        numbers: &[usize],
        Round { level, chart }: Round,
        batch: &mut PathSet,
    ) {
        let Scratch { lanes, refiner, refined, from, carried, back, segment, ends, paths, which, .. } = scratch;
        for (end, p) in ends.iter_mut().zip([&self.fibre.parameters[..], self.target]) {
            end.clear();
            self.charts.parameters(chart, p, end);
        }
        segment.join(&ends[0], &ends[1]);
        let goes_on = chart > 0 && level.is_multiple_of(2);
        from.clear();
        carried.clear();
        for &k in numbers {
            let result = &self.paths.results()[k];
            let halfway = goes_on && is_broken_off(result);
            from.push(if halfway { result.t } else { 1.0 });
            let point = if halfway { self.paths.point(k) } else { self.fibre.solution(k) };
            self.charts.enter(chart, point, carried);
        }
        which.clear();
        which.extend(0..numbers.len());
        paths.clear(self.fibre.dimension);
        let rests = Rests { segment, from };
        lanes.track(&rests, carried, which, &stricter::<C>(&self.options.tracker, level), self.monitor, paths);
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
                if regular && refined.accuracy < CARRIED {
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
