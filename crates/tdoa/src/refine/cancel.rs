//! Work that may be asked to stop. Long computations check often whether to stop; decompositions
//! cannot check, and are left behind.

use hc::Monitor;

/// The work was asked to stop before there was a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cancelled;

/// Fails once the work is asked to stop.
pub(crate) fn check(monitor: &Monitor) -> Result<(), Cancelled> {
    if monitor.is_cancelled() { Err(Cancelled) } else { Ok(()) }
}

/// The result of work on a dense matrix, which cannot look at the monitor. Where it is long it has a
/// thread of its own, which is left to itself once the work is asked to stop.
#[cfg(feature = "threads")]
pub(crate) fn apart<T: Send + 'static>(
    monitor: &Monitor,
    is_long: bool,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, Cancelled> {
    use std::sync::{Arc, Mutex, PoisonError, mpsc};
    use std::time::Duration;

    /// How often the monitor is looked at.
    const TICK: Duration = Duration::from_millis(5);

    check(monitor)?;
    if !is_long {
        return Ok(work());
    }
    // Taken back where no thread can be had.
    let shared = Arc::new(Mutex::new(Some(work)));
    let take = |shared: &Mutex<Option<_>>| shared.lock().unwrap_or_else(PoisonError::into_inner).take();
    let (sender, receiver) = mpsc::sync_channel(1);
    let theirs = Arc::clone(&shared);
    let spawned = std::thread::Builder::new().spawn(move || {
        if let Some(work) = take(&theirs) {
            // Nobody listens any more where the work was asked to stop.
            let _ = sender.send(work());
        }
    });
    let Ok(thread) = spawned else {
        return take(&shared).map(|work| work()).ok_or(Cancelled);
    };
    loop {
        match receiver.recv_timeout(TICK) {
            Ok(found) => return Ok(found),
            Err(mpsc::RecvTimeoutError::Timeout) => check(monitor)?,
            Err(mpsc::RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => return Err(Cancelled),
            },
        }
    }
}

/// The result of work on a dense matrix, which cannot look at the monitor.
#[cfg(not(feature = "threads"))]
pub(crate) fn apart<T>(monitor: &Monitor, _: bool, work: impl FnOnce() -> T) -> Result<T, Cancelled> {
    check(monitor)?;
    Ok(work())
}

#[cfg(all(test, feature = "threads"))]
mod tests {
    use super::{Cancelled, apart};
    use hc::Monitor;
    use std::sync::mpsc;
    use std::thread::spawn;

    #[test]
    fn long_work_is_left_behind() {
        for is_long in [false, true] {
            assert_eq!(apart(&Monitor::default(), is_long, || 7), Ok(7));
        }
        let monitor = Monitor::watched();
        let (begun, begins) = mpsc::channel();
        let (ended, ends) = mpsc::channel::<()>();
        let handle = monitor.clone();
        let stopper = spawn(move || begins.recv().map(|()| handle.cancel()));
        // Work that ends only after it was left behind.
        let found = apart(&monitor, true, move || (begun.send(()), ends.recv()).1.is_ok());
        assert_eq!(found, Err(Cancelled));
        drop(ended);
        assert!(stopper.join().unwrap().is_ok());
        assert_eq!(apart(&monitor, true, || 7), Err(Cancelled));
    }
}
