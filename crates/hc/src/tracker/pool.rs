//! Trackers that are kept from call to call.

use super::{PathEnd, PathSet, Tracker, TrackerOptions};
use crate::homotopy::ParameterPath;
use crate::monitor::Monitor;
use crate::threads::{IntoParallelIterator, ParallelIterator, current_num_threads};
use num_complex::Complex64;
use poly::{Evaluate, Lanes8};
use std::sync::{Mutex, PoisonError};

/// Most paths that one thread takes at a time; at the end of each part lanes run empty.
const CHUNK: usize = 256;
/// Parts for each thread, if there are enough paths, so that no thread waits long for another.
const PARTS: usize = 4;

/// Trackers of one system, as many as threads have asked for. The legs of an endgame are so short
/// that making a tracker for each would show.
pub(crate) struct Trackers<'a, E: Evaluate> {
    system: &'a E,
    idle: Mutex<Vec<Tracker<'a, E, Lanes8>>>,
}

/// A tracker that goes back to the others when it is no longer needed.
struct Borrowed<'a, 'b, E: Evaluate> {
    trackers: &'b Trackers<'a, E>,
    tracker: Option<Tracker<'a, E, Lanes8>>,
}

impl<E: Evaluate> Drop for Borrowed<'_, '_, E> {
    fn drop(&mut self) {
        self.trackers.idle.lock().unwrap_or_else(PoisonError::into_inner).extend(self.tracker.take());
    }
}

impl<'a, E: Evaluate> Trackers<'a, E> {
    /// A pool without trackers yet, for a square system.
    pub(crate) fn new(system: &'a E) -> Self {
        Trackers { system, idle: Mutex::new(Vec::new()) }
    }

    /// The system.
    pub(crate) fn system(&self) -> &'a E {
        self.system
    }

    /// Tracks as [`super::track`] does.
    pub(crate) fn track<P: ParameterPath>(
        &self,
        path: &P,
        starts: &[Complex64],
        which: &[usize],
        options: &TrackerOptions,
        monitor: &Monitor,
    ) -> PathSet {
        let n = self.system.variables();
        let threads = current_num_threads();
        let parts = if threads > 1 { PARTS * threads } else { 1 };
        let size = which.len().div_ceil(parts).clamp(8, CHUNK);
        let parts: Vec<PathSet> = (0..which.len().div_ceil(size))
            .into_par_iter()
            .map_init(
                || self.borrow(options, monitor),
                |borrowed, part| {
                    let mut out = PathSet::new(n);
                    let end = which.len().min((part + 1) * size);
                    let which = which[part * size..end].iter().copied();
                    if let Some(tracker) = &mut borrowed.tracker {
                        tracker.track(path, starts, which, &mut out);
                        let done = out.len() - out.count(PathEnd::Cancelled);
                        monitor.add(done as u64, out.count(PathEnd::Success) as u64);
                    }
                    out
                },
            )
            .collect();
        let mut all = PathSet::new(n);
        for part in &parts {
            for (result, point) in part.iter() {
                all.push(*result, point.iter().copied());
            }
        }
        all.sort();
        all
    }

    fn borrow(&self, options: &TrackerOptions, monitor: &Monitor) -> Borrowed<'a, '_, E> {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut tracker = idle.unwrap_or_else(|| Tracker::new(self.system, options));
        tracker.set_options(options);
        tracker.set_monitor(monitor);
        Borrowed { trackers: self, tracker: Some(tracker) }
    }
}
