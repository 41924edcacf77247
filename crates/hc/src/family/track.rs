//! Fibres tracked to other parameters, with jumped and broken paths found and tracked again.

use super::charts::{Charts, OneChart};
use super::fibre::{Fibre, FibreOptions, PathCounts};
use super::stated::Stated;
use super::tracking::{FibreMemory, FibreWork, PathTrackers};
use crate::linalg::exchanges_at;
use crate::monitor::Monitor;
use crate::ranks::{DividedWork, Lead};
use crate::refine::Refiner;
use crate::runner::{Flow, Policy, RunMemory, run};
use crate::tracker::{PathEnd, PathSet, Tracker, TrackerOptions, Trackers};
use num_complex::Complex64;
use poly::Evaluate;
use std::cell::Cell;

/// Tracks all solutions of a fibre to the parameters `target`, on the threads of the current rayon
/// pool.
///
/// Regular endpoints that coincide prove that a path has jumped. All paths that share an end, and
/// all that failed, are tracked again with stricter steps. Paths that are still in doubt afterwards
/// count as failed.
///
/// # Panics
/// If the system is not square, or `target` or the fibre does not fit it.
pub fn track_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
    monitor: &Monitor,
) -> (PathSet, PathCounts) {
    track_fibre_led(system, fibre, target, options, monitor, None)
}

/// [`track_fibre`], by all ranks if this one leads them.
pub(super) fn track_fibre_led<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
    monitor: &Monitor,
    lead: Option<&Lead<'_>>,
) -> (PathSet, PathCounts) {
    let mut tracker = FibreTracker::on_all_threads(system, OneChart, fibre);
    tracker.monitor.clone_from(monitor);
    let (counts, _) = tracker.track_led(fibre, target, options, fibre.len(), |_| false, lead);
    (tracker.paths, counts)
}

/// The whole fibre at other parameters, with every solution refined to the last digit; `None` if a
/// path was lost.
///
/// # Panics
/// If the system is not square, or the fibre or the target does not fit it.
pub fn move_fibre<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &FibreOptions,
    monitor: &Monitor,
) -> Option<Fibre> {
    moved(system, fibre, target, &track_fibre(system, fibre, target, options, monitor))
}

/// The fibre to whose solutions all of another have been tracked; `None` if a path was lost.
pub(super) fn moved<E: Evaluate>(
    system: &E,
    fibre: &Fibre,
    target: &[Complex64],
    (ends, counts): &(PathSet, PathCounts),
) -> Option<Fibre> {
    let mut refiner = Refiner::new(system);
    let solutions = ends.iter().flat_map(|(_, x)| refiner.refine(target, x).point);
    (counts.finite == fibre.len()).then(|| Fibre {
        is_partial: fibre.is_partial,
        ..Fibre::new(target.to_vec(), fibre.dimension, solutions.collect())
    })
}

/// Tracks fibres of one family again and again, on one thread or on all. It keeps its memory from
/// call to call.
///
/// In several [`Charts`], a lost path continues in the next chart from where it broke off. At
/// stricter levels it starts again in all charts.
pub struct FibreTracker<'a, E: Evaluate, C: Charts = OneChart> {
    system: &'a E,
    charts: C,
    monitor: Monitor,
    paths: PathSet,
    workspace: RunMemory<FibreMemory<'a, E>, PathSet>,
    stated: Stated<'a>,
}

impl<'a, E: Evaluate, C: Charts> FibreTracker<'a, E, C> {
    /// A tracker for a square system, with room for fibres of the size of `fibre`, on one thread.
    ///
    /// # Panics
    /// If the system does not have as many equations as unknowns.
    pub fn new(system: &'a E, charts: C, fibre: &Fibre) -> Self {
        let exchanges = exchanges_at(system, &fibre.parameters, &fibre.solutions);
        let tracker = Tracker::new(system, &TrackerOptions::default()).exchanging(exchanges);
        FibreTracker::over(system, charts, PathTrackers::One(Box::new(tracker)), fibre)
    }

    /// [`new`](Self::new), with the paths on the threads of the current rayon pool. The results do not
    /// depend on them.
    ///
    /// # Panics
    /// If the system does not have as many equations as unknowns.
    pub fn on_all_threads(system: &'a E, charts: C, fibre: &Fibre) -> Self {
        let trackers = Trackers::from_solutions(system, &fibre.parameters, &fibre.solutions);
        FibreTracker::over(system, charts, PathTrackers::Threads(trackers), fibre)
    }

    fn over(system: &'a E, charts: C, lanes: PathTrackers<'a, E>, fibre: &Fibre) -> Self {
        let (paths, dimension) = (fibre.len(), fibre.dimension);
        // A path may be lost and share its end.
        let which = Vec::with_capacity(2 * paths);
        let batch = PathSet::with_capacity(dimension, paths);
        FibreTracker {
            system,
            charts,
            monitor: Monitor::default(),
            paths: PathSet::with_capacity(dimension, paths),
            workspace: RunMemory { memory: FibreMemory::new(system, lanes, fibre, paths), batch, which },
            stated: Stated::default(),
        }
    }

    /// A tracker of the fibres of a family that states more than its equations.
    ///
    /// [`track`](Self::track) then counts ends at which a factor vanishes, or that do not solve all equations, as failed
    /// ([`PathEnd::Degenerate`]); a path can jump to them. Of each orbit under a symmetry one path is tracked, and the
    /// others end at its images, with no steps of their own. All are tracked where these paths do not tell where the
    /// others end: where one is lost, or images meet.
    #[must_use]
    pub fn stating(self, stated: Stated<'a>) -> Self {
        FibreTracker { stated, ..self }
    }

    /// Sets the monitor that may stop later work. The default monitor stops nothing.
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

    /// Tracks all solutions of a fibre to the parameters `target`, until each path is accounted for
    /// or everything has been tried. [`paths`](Self::paths) has their ends.
    ///
    /// # Panics
    /// If `target` or the fibre does not fit the system.
    pub fn track(&mut self, fibre: &Fibre, target: &[Complex64], options: &FibreOptions) -> PathCounts {
        let mut stated = std::mem::take(&mut self.stated);
        let counts = self.track_stated(&mut stated, fibre, target, options);
        self.stated = stated;
        counts
    }

    /// [`track`](Self::track), with what is stated.
    fn track_stated(
        &mut self,
        stated: &mut Stated<'a>,
        fibre: &Fibre,
        target: &[Complex64],
        options: &FibreOptions,
    ) -> PathCounts {
        let mut unfolded = None;
        let mut before = 0;
        if let Some(orbits) = stated.orbits(fibre)
            && let Some(tracked) = orbits.tracked()
        {
            let counts = self.track_until(tracked, target, options, tracked.len(), |_| false).0;
            if counts.failed == 0 && orbits.unfold(target, &mut self.paths, options.coincidence) {
                unfolded = Some(PathCounts { retracked: counts.retracked, ..self.counts(0) });
            }
            before = counts.tracked + counts.retracked;
        }
        let mut counts = match unfolded {
            Some(counts) => counts,
            None => {
                let all = self.track_until(fibre, target, options, fibre.len(), |_| false).0;
                PathCounts { retracked: all.retracked + before, ..all }
            }
        };
        let degenerate = stated.mark(self.system, target, &mut self.paths).min(counts.finite);
        counts.finite -= degenerate;
        counts.failed += degenerate;
        counts
    }

    /// [`track`](Self::track) in portions of `size` paths in the first pass. `enough` sees each
    /// portion; once it returns true, the remaining paths are left. The result also says whether
    /// `enough` returned true; the counts then cover the paths so far. What is [stated](Self::stating) is left aside.
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
        self.track_led(fibre, target, options, size, enough, None)
    }

    /// [`track_until`](Self::track_until); in one chart by all ranks, if this one leads them.
    fn track_led(
        &mut self,
        fibre: &Fibre,
        target: &[Complex64],
        options: &FibreOptions,
        size: usize,
        enough: impl FnMut(&PathSet) -> bool,
        lead: Option<&Lead<'_>>,
    ) -> (PathCounts, bool) {
        self.paths.clear(fibre.dimension);
        let work = FibreWork {
            system: self.system,
            charts: &self.charts,
            fibre,
            target,
            options,
            monitor: &self.monitor,
            paths: &mut self.paths,
            enough,
            steps: 0,
            reported: Cell::default(),
        };
        let again = options.again.unwrap_or(usize::MAX);
        let policy = Policy { retries: options.retries, charts: C::COUNT, again, first: size, batch: size };
        let mut work = DividedWork::new(work, lead, &self.monitor);
        let outcome = run(&mut work, fibre.len(), &policy, &mut self.workspace, &self.monitor);
        let found = outcome.flow == Flow::Found;
        let failed = if found { 0 } else { self.workspace.which.len() };
        (PathCounts { retracked: outcome.retracked, ..self.counts(failed) }, found)
    }

    /// How the paths of the last call ended; `failed` of them are lost.
    pub fn counts(&self, failed: usize) -> PathCounts {
        let (tracked, at_infinity) = (self.paths.len(), self.paths.count(PathEnd::AtInfinity));
        let finite = tracked.saturating_sub(at_infinity + failed);
        PathCounts { tracked, finite, at_infinity, failed, dropped: 0, retracked: 0 }
    }
}
