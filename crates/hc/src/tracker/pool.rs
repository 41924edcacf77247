//! Trackers that are kept from call to call.

use super::{PathEnd, PathSet, Tracker, TrackerOptions};
use crate::homotopy::ParameterPath;
use crate::linalg::{RowExchanges, exchanges_at};
use crate::monitor::Monitor;
// Without threads, iterators have `map` of their own.
#[cfg(feature = "threads")]
use crate::threads::ParallelIterator;
use crate::threads::{IntoParallelIterator, current_num_threads};
use num_complex::Complex64;
use poly::{Evaluate, Lanes8};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Most paths that one thread takes at a time; at the end of each part lanes run empty.
const CHUNK: usize = 256;
/// Parts for each thread, if there are enough paths, so that no thread waits long for another.
const PARTS: usize = 4;

/// Trackers of one system, as many as threads have asked for. The legs of an endgame are so short
/// that making a tracker for each would show.
pub(crate) struct Trackers<'a, E: Evaluate> {
    system: &'a E,
    /// The rows that quick steps exchange.
    exchanges: RowExchanges,
    idle: Mutex<Vec<Tracker<'a, E, Lanes8>>>,
}

impl<'a, E: Evaluate> Trackers<'a, E> {
    /// A pool without trackers yet, for a square system.
    pub(crate) fn new(system: &'a E) -> Self {
        Trackers { system, exchanges: RowExchanges::new(), idle: Mutex::new(Vec::new()) }
    }

    /// A pool without trackers yet, for paths from these solutions (`n` coordinates each) for the parameters `p`.
    pub(crate) fn from_solutions(system: &'a E, p: &[Complex64], solutions: &[Complex64]) -> Self {
        Trackers::exchanging(system, exchanges_at(system, p, solutions))
    }

    /// A pool without trackers yet, whose quick steps exchange these rows.
    pub(crate) fn exchanging(system: &'a E, exchanges: RowExchanges) -> Self {
        Trackers { system, exchanges, idle: Mutex::new(Vec::new()) }
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
            .map(|part| {
                let idle = self.idle().pop();
                let mut tracker =
                    idle.unwrap_or_else(|| Tracker::new(self.system, options).exchanging(self.exchanges.clone()));
                tracker.set_options(options);
                tracker.set_monitor(monitor);
                let mut out = PathSet::new(n);
                let end = which.len().min((part + 1) * size);
                tracker.track(path, starts, which[part * size..end].iter().copied(), &mut out);
                self.idle().push(tracker);
                let done = out.len() - out.count(PathEnd::Cancelled);
                monitor.add(done as u64, out.count(PathEnd::Success) as u64);
                out
            })
            .collect();
        let mut all = PathSet::new(n);
        parts.iter().for_each(|part| all.append(part));
        all.sort();
        all
    }

    /// The trackers that no thread uses.
    fn idle(&self) -> MutexGuard<'_, Vec<Tracker<'a, E, Lanes8>>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
