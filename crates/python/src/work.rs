//! Work beside the interpreter: the lock is released, signals are heeded, progress is told, panics
//! are caught.

use crate::errors::Failure;
use hc::{Monitor, Progress};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::thread::ThreadId;
use std::time::{Duration, Instant};

/// How often signals are looked for: an interrupt is to end the work within a tenth of a second.
const TICK: Duration = Duration::from_millis(20);

/// How often progress is told.
const TOLD: Duration = Duration::from_millis(100);

/// Most threads that may be asked for, as in the programs.
const MOST_THREADS: usize = 1024;

/// How work is done: what all functions take.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct WorkOptions {
    /// Threads; all cores for `None`.
    pub(crate) threads: Option<usize>,
    /// Called with words, how much is done and of how much.
    pub(crate) progress: Option<Py<PyAny>>,
}

/// Threads, of which process, and how many were asked for.
struct Kept {
    process: u32,
    threads: usize,
    pool: Arc<ThreadPool>,
}

/// Those of the last call.
static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

/// This many threads, those of the last call where they are as many. A child process has none of
/// its parent's.
fn pool(threads: Option<usize>) -> Result<Arc<ThreadPool>, Failure> {
    if let Some(count) = threads.filter(|count| !(1..=MOST_THREADS).contains(count)) {
        return Err(Failure::Input(format!("threads must be between 1 and {MOST_THREADS}, not {count}")));
    }
    // Zero is rayon's word for all cores.
    let (process, threads) = (std::process::id(), threads.unwrap_or(0));
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(kept) = kept.as_ref().filter(|kept| (kept.process, kept.threads) == (process, threads)) {
        return Ok(kept.pool.clone());
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).thread_name(|k| format!("hc-{k}")).build();
    let pool = Arc::new(pool.map_err(|error| Failure::Input(format!("threads cannot be started: {error}")))?);
    if let Some(old) = kept.replace(Kept { process, threads, pool: pool.clone() })
        && old.process != process
    {
        // Those threads are not of this process: nothing can be told to them.
        std::mem::forget(old);
    }
    Ok(pool)
}

/// What work has given.
pub(crate) struct Done<R> {
    pub(crate) result: R,
    /// The exception that the handler of a signal has raised, if one has stopped the work.
    pub(crate) stopped: Option<PyErr>,
    /// Time of the work itself, without what Python adds.
    pub(crate) seconds: f64,
}

/// Runs work: on threads of its own, or on the thread that calls where that is to do it alone.
///
/// # Errors
/// A wrong number of threads, a panic, or an exception of the progress.
pub(crate) fn run<R: Send + 'static>(
    py: Python<'_>,
    how: &WorkOptions,
    work: impl FnOnce(&Monitor) -> R + Send + 'static,
) -> Result<Done<R>, Failure> {
    let timed = move |monitor: &Monitor| {
        let begun = Instant::now();
        let ended = catch_unwind(AssertUnwindSafe(|| work(monitor)));
        ended.map(|result| (result, begun.elapsed().as_secs_f64()))
    };
    let (ended, stopped) = match (how.threads == Some(1)).then(alone).flatten() {
        Some(pool) => {
            let (monitor, stopped) = watched_by(py, how);
            let ended = py.detach(|| pool.install(|| timed(&monitor)));
            (ended, stopped.lock().unwrap_or_else(PoisonError::into_inner).take())
        }
        None => beside(py, how, timed)?,
    };
    // An interrupt that came with the end.
    let stopped = stopped.or_else(|| py.check_signals().err());
    let (result, seconds) = ended.map_err(|payload| Failure::panicked(payload.as_ref()))?;
    Ok(Done { result, stopped, seconds })
}

/// A pool of the calling thread alone: work of one thread need not wait for another to wake, twice.
/// `None` if another thread has been the first to ask.
fn alone() -> Option<&'static ThreadPool> {
    static ALONE: OnceLock<Option<(ThreadId, ThreadPool)>> = OnceLock::new();
    let this = std::thread::current().id();
    let pool = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().ok().map(|pool| (this, pool));
    ALONE.get_or_init(pool).as_ref().filter(|(thread, _)| *thread == this).map(|(_, pool)| pool)
}

/// Looks for signals, and tells how far the work is.
fn heed(py: Python<'_>, progress: Option<&Py<PyAny>>, now: Progress, told: &mut Instant) -> PyResult<()> {
    py.check_signals()?;
    if let Some(progress) = progress.filter(|_| told.elapsed() >= TOLD) {
        progress.call1(py, (now.to_string(), now.done, now.total))?;
        *told = Instant::now();
    }
    Ok(())
}

/// The exception that has stopped work.
type Stopped = Arc<Mutex<Option<PyErr>>>;

/// A monitor of work on this thread: where the work asks whether it is to stop, signals are heeded.
fn watched_by(py: Python<'_>, how: &WorkOptions) -> (Monitor, Stopped) {
    let stopped = Stopped::default();
    let (kept, progress) = (stopped.clone(), how.progress.as_ref().map(|progress| progress.clone_ref(py)));
    let times = Mutex::new((Instant::now(), Instant::now()));
    let monitor = Monitor::asking(move |now| {
        let mut times = times.lock().unwrap_or_else(PoisonError::into_inner);
        let (asked, told) = &mut *times;
        if asked.elapsed() < TICK {
            return false;
        }
        let heard = Python::attach(|py| heed(py, progress.as_ref(), now, told));
        *asked = Instant::now();
        let stop = heard.is_err();
        *kept.lock().unwrap_or_else(PoisonError::into_inner) = heard.err();
        stop
    });
    (monitor, stopped)
}

/// What has come of work: its result and time, or what it panicked with.
type Ended<R> = std::thread::Result<(R, f64)>;

/// Runs work on other threads; this one heeds signals meanwhile.
fn beside<R: Send + 'static>(
    py: Python<'_>,
    how: &WorkOptions,
    work: impl FnOnce(&Monitor) -> Ended<R> + Send + 'static,
) -> Result<(Ended<R>, Option<PyErr>), Failure> {
    let pool = pool(how.threads)?;
    let monitor = Monitor::watched();
    let (sender, receiver) = channel();
    let watched = monitor.clone();
    pool.spawn(move || {
        // Nobody waits any more where Python has gone.
        let _ = sender.send(work(&watched));
    });
    let mut told = Instant::now();
    let mut stopped = None;
    // `Receiver` is for one thread; whoever releases the lock must not move.
    let receiver = Mutex::new(receiver);
    loop {
        let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK);
        match py.detach(wait) {
            Ok(ended) => return Ok((ended, stopped)),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(Failure::Internal("the threads of the work have gone".to_owned()));
            }
            Err(RecvTimeoutError::Timeout) if stopped.is_some() => {}
            Err(RecvTimeoutError::Timeout) => {
                stopped = heed(py, how.progress.as_ref(), monitor.progress(), &mut told).err();
                if stopped.is_some() {
                    monitor.cancel();
                }
            }
        }
    }
}

/// A result, or what has stopped it with the partial result as its attribute `partial`.
pub(crate) fn whole<'py>(
    py: Python<'py>,
    result: Bound<'py, PyAny>,
    stopped: Option<PyErr>,
) -> Result<Bound<'py, PyAny>, Failure> {
    match stopped {
        None => Ok(result),
        Some(error) => {
            // An exception without attributes is raised without.
            let _ = error.value(py).setattr("partial", result);
            Err(error.into())
        }
    }
}
