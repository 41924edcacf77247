//! Watching and stopping the reading of recordings.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// How far the reading of recordings is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ListenProgress {
    /// Samples of all channels that have been read. What is read twice counts twice.
    pub done: u64,
    /// Samples of all channels that are read in all, by what headers say; it is corrected where a file has more or fewer. Zero
    /// before files are opened.
    pub total: u64,
}

/// What is being done, in words: `recordings are read, 42 %`.
impl fmt::Display for ListenProgress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (100 * u128::from(self.done)).checked_div(self.total.into()) {
            None => f.write_str("recordings are opened"),
            Some(percent) => write!(f, "recordings are read, {} %", percent.min(100)),
        }
    }
}

/// A handle on [`listen_watched`](crate::listen_watched) at work; clones share it. Any thread may ask for the progress, or stop
/// the work.
///
/// ```
/// let monitor = sound::ListenMonitor::default();
/// let other = monitor.clone();
/// // From any thread, at any time:
/// other.stop();
/// let options = sound::ListenOptions::default();
/// # let mut room = sound::RoomOptions::default();
/// # room.sources = sound::Placement::Random(1);
/// # let made = sound::simulate_room(&room)?;
/// # let folder = std::env::temp_dir().join(format!("sound-monitor-{}", std::process::id()));
/// # std::fs::create_dir_all(&folder)?;
/// # let path = folder.join("claps.wav");
/// # sound::write_wav(&path, made.sample_rate, &made.channels, sound::SampleFormat::Int16)?;
/// let heard = sound::listen_watched(&[vec![&path]], &options, &monitor);
/// assert!(matches!(heard, Err(sound::ListenError::Stopped)));
/// # std::fs::remove_dir_all(folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct ListenMonitor {
    shared: Arc<Shared>,
}

/// Whether the work is to stop.
type Question = Box<dyn Fn(ListenProgress) -> bool + Send + Sync>;

#[derive(Default)]
struct Shared {
    is_stopped: AtomicBool,
    question: Option<Question>,
    done: AtomicU64,
    total: AtomicU64,
}

impl fmt::Debug for Shared {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Shared { is_stopped, done, total, .. } = self;
        f.debug_struct("Shared").field("is_stopped", is_stopped).field("done", done).field("total", total).finish()
    }
}

impl ListenMonitor {
    /// A handle on work that stops also once `question` returns true. It is called with the progress for each block that
    /// is read.
    pub fn asking(question: impl Fn(ListenProgress) -> bool + Send + Sync + 'static) -> ListenMonitor {
        ListenMonitor { shared: Arc::new(Shared { question: Some(Box::new(question)), ..Shared::default() }) }
    }

    /// Asks the work to stop: soon, and for good. It ends with [`ListenError::Stopped`](crate::ListenError::Stopped).
    pub fn stop(&self) {
        self.shared.is_stopped.store(true, Ordering::Relaxed);
    }

    /// Whether the work has been asked to stop.
    pub fn is_stopped(&self) -> bool {
        let asked = || self.shared.question.as_ref().is_some_and(|question| question(self.progress()));
        self.shared.is_stopped.load(Ordering::Relaxed) || asked()
    }

    /// How far the work is. The numbers may belong to slightly different instants.
    pub fn progress(&self) -> ListenProgress {
        let [done, total] = [&self.shared.done, &self.shared.total].map(|number| number.load(Ordering::Relaxed));
        ListenProgress { done, total }
    }

    /// Begins work in which this many samples are read.
    pub(crate) fn begin(&self, total: u64) {
        self.shared.done.store(0, Ordering::Relaxed);
        self.shared.total.store(total, Ordering::Relaxed);
    }

    /// Samples were read.
    pub(crate) fn add(&self, samples: u64) {
        self.shared.done.fetch_add(samples, Ordering::Relaxed);
    }

    /// So many samples are read where others were expected.
    pub(crate) fn correct(&self, expected: u64, found: u64) {
        let total = self.progress().total.saturating_sub(expected).saturating_add(found);
        self.shared.total.store(total, Ordering::Relaxed);
    }

    /// All is done: what comes after the last event need not be read.
    pub(crate) fn finish(&self) {
        self.shared.done.store(self.progress().total, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::{ListenMonitor, ListenProgress};

    #[test]
    fn clones_share_what_they_count() {
        let monitor = ListenMonitor::default();
        assert_eq!(monitor.progress().to_string(), "recordings are opened");
        let other = monitor.clone();
        monitor.begin(1000);
        other.add(425);
        assert_eq!(monitor.progress(), ListenProgress { done: 425, total: 1000 });
        assert_eq!(monitor.progress().to_string(), "recordings are read, 42 %");
        // Of 600 there were only 200.
        monitor.correct(600, 200);
        assert_eq!(other.progress(), ListenProgress { done: 425, total: 600 });
        monitor.finish();
        assert_eq!(other.progress().to_string(), "recordings are read, 100 %");
        assert!(!monitor.is_stopped());
        other.stop();
        assert!(monitor.is_stopped());
    }

    #[test]
    fn a_question_stops_what_asks_it() {
        let monitor = ListenMonitor::asking(|progress| progress.done >= 500);
        monitor.begin(1000);
        monitor.add(499);
        assert!(!monitor.is_stopped());
        monitor.add(1);
        assert!(monitor.is_stopped() && !ListenMonitor::default().is_stopped());
    }
}
