//! Progress bars on standard error, for work that takes over a second.

use crate::{Failure, on_threads};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Work that is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// How often a bar is drawn anew.
const TICK: Duration = Duration::from_millis(50);

/// A bar that appears after a second, and only on a terminal.
pub struct Bar {
    started: Instant,
    template: &'static str,
    bar: Mutex<Option<ProgressBar>>,
    /// What [`inc`](Bar::inc) counts, and how far.
    done: AtomicU64,
    length: u64,
}

impl Bar {
    /// A bar by indicatif's template, such as `{bar:40} {pos}/{len} starts, {msg}`.
    pub fn new(template: &'static str) -> Bar {
        Bar { started: Instant::now(), template, bar: Mutex::new(None), done: AtomicU64::new(0), length: 0 }
    }

    /// A bar of so many items that are counted one by one.
    pub fn counted(length: u64) -> Bar {
        let mut bar = Bar::new("{bar:40} {pos}/{len}, {eta} left");
        bar.length = length;
        bar
    }

    /// Counts items that are done.
    pub fn inc(&self, items: u64) {
        let done = self.done.fetch_add(items, Ordering::Relaxed) + items;
        self.show(done, self.length, String::new);
    }

    /// Takes the bar off the screen, as its end does.
    pub fn finish_and_clear(&self) {
        if let Some(bar) = self.lock().take() {
            bar.finish_and_clear();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Option<ProgressBar>> {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows how far the work is; words alone where the length is not known, zero.
    pub fn show(&self, position: u64, length: u64, message: impl FnOnce() -> String) {
        if self.started.elapsed() < PATIENCE || !std::io::stderr().is_terminal() {
            return;
        }
        let mut shown = self.lock();
        let fresh = shown.is_none();
        let bar = shown.get_or_insert_with(|| ProgressBar::new(length));
        let style = ProgressStyle::with_template(if length == 0 { "{msg}" } else { self.template });
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_length(length);
        bar.set_position(position);
        bar.set_message(message());
        if fresh {
            // What was done before is no measure of the speed from here on.
            bar.reset_eta();
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.finish_and_clear();
    }
}

/// Runs work on the given number of threads, while another thread shows how far it is: position,
/// length and words from `describe`.
///
/// # Errors
/// If the threads cannot be had.
pub fn while_shown<R: Send>(
    threads: Option<usize>,
    describe: impl Fn() -> (u64, u64, String) + Send,
    work: impl FnOnce() -> R + Send,
) -> Result<R, Failure> {
    let (done, end) = channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            let bar = Bar::new("{bar:40} {pos}/{len} {msg}");
            while let Err(RecvTimeoutError::Timeout) = end.recv_timeout(TICK) {
                let (position, length, words) = describe();
                bar.show(position, length, || words);
            }
        });
        let result = on_threads(threads, work);
        drop(done);
        result
    })
}
