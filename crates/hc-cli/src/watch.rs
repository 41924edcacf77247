//! Work that is watched: a progress bar after a second, and an end soon after an interrupt.

use cli::bar::while_shown;
use cli::{Failure, interrupt};
use hc::{Monitor, Progress};

/// A monitor for work that an interrupt of the program cancels.
///
/// # Errors
/// If the system lets no handler be set.
pub(crate) fn interruptible() -> Result<Monitor, Failure> {
    interrupt::watch().map(Monitor::heeding)
}

/// Runs work on the given number of threads, while another thread shows what `describe` makes of
/// its progress (position, length, words).
pub(crate) fn watched<R: Send>(
    threads: Option<usize>,
    monitor: &Monitor,
    describe: impl Fn(Progress) -> (u64, u64, String) + Send,
    work: impl FnOnce() -> R + Send,
) -> Result<R, Failure> {
    while_shown(threads, move || describe(monitor.progress()), work)
}

/// The progress of one solve.
pub(crate) fn stages(progress: Progress) -> (u64, u64, String) {
    (progress.done, progress.total, progress.to_string())
}
