//! Work that is watched: a progress bar after a second, and an end soon after an interrupt.

use cli::bar::Bar;
use cli::{Failure, interrupt, on_threads};
use hc::monitor::{Monitor, Progress, Stage};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// How often the bar is drawn anew.
const TICK: Duration = Duration::from_millis(50);

/// A monitor for work that an interrupt of the program cancels.
///
/// # Errors
/// If the system lets no handler be set.
pub(crate) fn interruptible() -> Result<Monitor, Failure> {
    interrupt::watch().map(Monitor::heeding)
}

/// Runs work on the given number of threads, while another thread shows what `describe` makes of its progress (position,
/// length, words).
pub(crate) fn watched<R: Send>(
    threads: Option<usize>,
    monitor: &Monitor,
    describe: impl Fn(Progress) -> (u64, u64, String) + Send,
    work: impl FnOnce() -> R + Send,
) -> Result<R, Failure> {
    let (done, end) = channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let bar = Bar::new("{bar:40} {pos}/{len} {msg}");
            while let Err(RecvTimeoutError::Timeout) = end.recv_timeout(TICK) {
                let (position, length, words) = describe(monitor.progress());
                bar.show(position, length, || words);
            }
        });
        let result = on_threads(threads, work);
        drop(done);
        result
    })
}

/// The progress of one solve.
pub(crate) fn stages(progress: Progress) -> (u64, u64, String) {
    let counted = progress.counted;
    let words = match progress.stage {
        Stage::MixedCells => format!("{} mixed cells, of volume {counted}", progress.done),
        Stage::Start => "paths to generic coefficients".to_owned(),
        Stage::Paths => format!("paths, {counted} of them at regular solutions"),
        Stage::Endgame => "paths through the endgame".to_owned(),
        Stage::Loop => format!("paths round a loop, {} solutions so far", progress.total / 3),
        _ => "preparing".to_owned(),
    };
    (progress.done, progress.total, words)
}
