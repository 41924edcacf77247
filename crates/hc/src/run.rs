//! The circumstances of a run: who watches and stops it, its threads, its checkpoint, its ranks.

use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::monitor::Monitor;
use crate::ranks::Ranks;
#[cfg(feature = "threads")]
use std::sync::Arc;

/// Most threads of a run.
const MAX_THREADS: usize = 1024;

/// Why a run has no threads of its own.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ThreadsError {
    /// A number of threads out of range.
    #[error("the number of threads must be between 1 and {MAX_THREADS}, not {0}")]
    Count(usize),
    /// The operating system refuses them.
    #[error("threads cannot be started: {0}; ask for fewer")]
    Start(String),
}

/// How work is run: who watches it and stops it, on how many threads, and where it is recorded.
///
/// Every long work of the crate is a method here: [`solve`](Run::solve),
/// [`decompose`](Run::decompose), [`monodromy`](Run::monodromy), [`complete`](Run::complete),
/// [`track`](Run::track), [`trace_test`](Run::trace_test), [`certify`](Run::certify) and
/// [`mixed_volume`](Run::mixed_volume). The plain functions of the same names are those of the
/// default run: nobody watches it, nothing is recorded, and it uses the current pool of rayon.
/// A run changes no result: the same seed gives the same bits.
///
/// ```
/// use hc::{Monitor, Run, SolveOptions, System};
///
/// let system: System = "x^2 + y^2 - 5; x*y - 2".parse()?;
/// let monitor = Monitor::calling(|progress| eprintln!("{}: {progress}", progress.done));
/// let run = Run::new().watched(&monitor).threads(2)?;
/// let found = run.solve(&system, &SolveOptions::new().certify(true))?;
/// assert_eq!((found.len(), found.uncertified()), (4, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
#[must_use = "a run does nothing before one of its methods is called"]
pub struct Run {
    monitor: Monitor,
    checkpoint: Option<Checkpoint>,
    #[cfg(feature = "threads")]
    pool: Option<Arc<rayon::ThreadPool>>,
}

impl Run {
    /// The default run.
    pub fn new() -> Run {
        Run::default()
    }

    /// Lets this monitor watch and stop the work. Work that is stopped returns what it has found by
    /// then, marked as partial.
    pub fn watched(self, monitor: &Monitor) -> Run {
        Run { monitor: monitor.clone(), ..self }
    }

    /// Runs on this many threads of its own, which end with the last clone of this run. Without the
    /// feature `threads`, everything runs on the calling thread.
    ///
    /// # Errors
    /// If `count` is not between 1 and 1024, or the threads cannot be started.
    pub fn threads(self, count: usize) -> Result<Run, ThreadsError> {
        if !(1..=MAX_THREADS).contains(&count) {
            return Err(ThreadsError::Count(count));
        }
        #[cfg(feature = "threads")]
        {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
            let pool = pool.map_err(|error| ThreadsError::Start(error.to_string()))?;
            Ok(Run { pool: Some(Arc::new(pool)), ..self })
        }
        #[cfg(not(feature = "threads"))]
        Ok(self)
    }

    /// Records the work in a [checkpoint](crate::checkpoint). What the checkpoint has is not
    /// computed again. The input and all options on which the result depends must be those of the
    /// run that the checkpoint belongs to. `None` records nothing.
    pub fn recorded<'c>(self, checkpoint: impl Into<Option<&'c Checkpoint>>) -> Run {
        Run { checkpoint: checkpoint.into().cloned(), ..self }
    }

    /// Lets several [ranks](crate::ranks) take part, which all call this with the same input and
    /// options. With `None` this process works alone.
    pub fn on_ranks<'a>(self, ranks: impl Into<Option<&'a Ranks<'a>>>) -> RanksRun<'a> {
        RanksRun { run: self, ranks: ranks.into() }
    }

    /// Who watches and stops the work.
    pub(crate) fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// Where the work is recorded, if anywhere.
    pub(crate) fn checkpoint(&self) -> Option<&Checkpoint> {
        self.checkpoint.as_ref()
    }

    /// Refuses a checkpoint, in which `work` would record nothing.
    pub(crate) fn unrecorded(&self, work: &'static str) -> Result<(), CheckpointError> {
        match self.checkpoint {
            Some(_) => Err(CheckpointError::Unrecorded(work)),
            None => Ok(()),
        }
    }

    /// Does `work` on the threads of this run.
    pub(crate) fn install<T: Send>(&self, work: impl FnOnce() -> T + Send) -> T {
        #[cfg(feature = "threads")]
        if let Some(pool) = &self.pool {
            return pool.install(work);
        }
        work()
    }
}

/// A [`Run`] on several [ranks](crate::ranks), or on this process alone.
///
/// All ranks call the same method with the same input and options. Only rank 0 heeds the monitor
/// and has the checkpoint, and only rank 0 gets the result, the same to the bit as without other
/// ranks. The other ranks get `None`, or no results, when they are no longer needed.
#[derive(Clone, Debug)]
#[must_use = "a run does nothing before one of its methods is called"]
pub struct RanksRun<'a> {
    pub(crate) run: Run,
    pub(crate) ranks: Option<&'a Ranks<'a>>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_counted() {
        for count in [0, MAX_THREADS + 1, usize::MAX] {
            assert_eq!(Run::new().threads(count).unwrap_err(), ThreadsError::Count(count));
        }
        for count in [1, 3] {
            let run = Run::new().threads(count).unwrap();
            let expected = if cfg!(feature = "threads") { count } else { 1 };
            assert_eq!(run.install(crate::threads::current_num_threads), expected);
        }
    }
}
