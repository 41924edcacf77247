//! Threads that compute rows of a table.

use cli::Failure;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Threads, each with a state of its own.
///
/// A row stays on one thread, so that its processor time can be told from that of the others; what it
/// does in parallel runs in a pool of its own.
pub(super) struct Crew<S> {
    seats: Vec<(rayon::ThreadPool, Mutex<S>)>,
}

impl<S: Send> Crew<S> {
    /// As many as are asked for; as cores for `None`.
    ///
    /// # Errors
    /// If the number is not between 1 and 1024, or threads cannot be started.
    pub(super) fn new(threads: Option<usize>, state: impl Fn() -> S) -> Result<Crew<S>, Failure> {
        let count = cli::thread_count(threads)?;
        let count = count.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
        let seats =
            (0..count).map(|_| Ok((cli::pool(Some(1))?, Mutex::new(state())))).collect::<Result<_, Failure>>()?;
        Ok(Crew { seats })
    }

    /// Calls `one` for each of the numbers, in ascending order as threads are free, until it breaks.
    pub(super) fn each(&self, numbers: &[usize], one: impl Fn(&mut S, usize) -> ControlFlow<()> + Sync) {
        let next = AtomicUsize::new(0);
        let work = |(pool, state): &(rayon::ThreadPool, Mutex<S>)| {
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            let state: &mut S = &mut state;
            while let Some(&number) = numbers.get(next.fetch_add(1, Ordering::Relaxed)) {
                if pool.install(|| one(state, number)).is_break() {
                    next.store(numbers.len(), Ordering::Relaxed);
                }
            }
        };
        std::thread::scope(|scope| {
            for seat in self.seats.iter().take(numbers.len()) {
                scope.spawn(|| work(seat));
            }
        });
    }
}
