//! Ctrl-C (and SIGTERM, SIGHUP): the work is asked to stop.

use crate::{Failure, INTERRUPTED};
use std::sync::atomic::{AtomicBool, Ordering};

static SEEN: AtomicBool = AtomicBool::new(false);

/// Set once the program has been interrupted. The first interrupt asks the work to stop, a second ends the program at
/// once; files appear under their names only when they are whole.
///
/// # Errors
/// If the system lets no handler be set.
pub fn watch() -> Result<&'static AtomicBool, Failure> {
    let handler = || {
        if SEEN.swap(true, Ordering::Relaxed) {
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
