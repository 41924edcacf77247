//! Whether results are being written, so that a second interrupt leaves them time.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Number of writes that have begun and not ended.
static OPEN: AtomicUsize = AtomicUsize::new(0);

/// One file may follow another by this.
const PAUSE: Duration = Duration::from_millis(200);

/// Results are being written while this lives.
pub(crate) struct Writing(());

impl Writing {
    pub(crate) fn begin() -> Writing {
        OPEN.fetch_add(1, Ordering::SeqCst);
        Writing(())
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        OPEN.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Waits until nothing has been written for a moment, or at most this long; not at all where
/// nothing is being written.
pub(crate) fn wait(most: Duration) {
    let begun = Instant::now();
    let mut quiet = None;
    while begun.elapsed() < most {
        if OPEN.load(Ordering::SeqCst) > 0 {
            quiet = Some(Instant::now());
        } else if quiet.is_none_or(|since| since.elapsed() > PAUSE) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_for_what_is_being_written_and_no_longer_than_told() {
        let open = Writing::begin();
        let begun = Instant::now();
        wait(Duration::from_millis(300));
        assert!(begun.elapsed() >= Duration::from_millis(300));
        let writer = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(100));
            drop(open);
            Instant::now()
        });
        wait(Duration::from_secs(60));
        let waited = Instant::now();
        assert!(waited >= writer.join().unwrap());
    }
}
