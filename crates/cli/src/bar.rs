//! Progress bars on standard error, for work that takes over a second.

use indicatif::{ProgressBar, ProgressStyle};
use std::cell::Cell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Work that is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar that appears after a second, and only on a terminal.
pub struct Bar {
    started: Instant,
    template: &'static str,
    bar: Cell<Option<ProgressBar>>,
}

impl Bar {
    /// A bar by indicatif's template, such as `{bar:40} {pos}/{len} starts, {msg}`.
    pub fn new(template: &'static str) -> Bar {
        Bar { started: Instant::now(), template, bar: Cell::new(None) }
    }

    /// Shows how far the work is; words alone where the length is not known, zero.
    pub fn show(&self, position: u64, length: u64, message: impl FnOnce() -> String) {
        if self.started.elapsed() < PATIENCE || !std::io::stderr().is_terminal() {
            return;
        }
        let bar = self.bar.take().unwrap_or_else(|| ProgressBar::new(length));
        let style = ProgressStyle::with_template(if length == 0 { "{msg}" } else { self.template });
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_length(length);
        bar.set_position(position);
        bar.set_message(message());
        self.bar.set(Some(bar));
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        if let Some(bar) = self.bar.take() {
            bar.finish_and_clear();
        }
    }
}
