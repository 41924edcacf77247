//! Ctrl-C (and SIGTERM, SIGHUP): the search stops, nothing is written.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::Failure;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Set once the program has been interrupted. The first interrupt asks the search to stop, a second ends the program at
/// once; files appear under their names only when they are whole.
pub(crate) fn watch() -> Result<&'static AtomicBool, Failure> {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(crate::INTERRUPTED));
        }
    };
    match ctrlc::set_handler(handler) {
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(&INTERRUPTED),
        Err(error) => Err(Failure::Unusable(format!("interrupts cannot be caught ({error})"))),
    }
}

/// Fails if the program has been interrupted.
pub(crate) fn check() -> Result<(), Failure> {
    if INTERRUPTED.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
}
