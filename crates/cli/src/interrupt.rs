//! Ctrl-C (and SIGTERM, SIGHUP): the work is asked to stop.

use crate::{Failure, INTERRUPTED, writing};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

static SEEN: AtomicBool = AtomicBool::new(false);

/// How long a second interrupt waits for results that are being written, which may be to a pipe
/// that nobody reads.
const PATIENCE: Duration = Duration::from_secs(10);

/// Set once the program has been interrupted. The first interrupt asks the work to stop, a second
/// ends the program at once, or when the results that the first one asked for are written, ten
/// seconds later at most. Files appear under their names only when they are whole.
///
/// # Errors
/// If the system lets no handler be set.
pub fn watch() -> Result<&'static AtomicBool, Failure> {
    let handler = || {
        if SEEN.swap(true, Ordering::Relaxed) {
            writing::wait(PATIENCE);
            std::process::exit(i32::from(INTERRUPTED));
        }
    };
    match ctrlc::set_handler(handler) {
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(&SEEN),
        Err(error) => Err(Failure::Unusable(format!("interrupts cannot be caught ({error})"))),
    }
}

/// Fails if the program has been interrupted.
///
/// # Errors
/// [`Failure::Interrupted`] after an interrupt.
pub fn check() -> Result<(), Failure> {
    if SEEN.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
}
