//! What the programs `hc` and `tdoa` share: exit statuses, files read and written, interrupts, threads, progress bars.

pub mod bar;
pub mod input;
pub mod interrupt;
pub mod output;

use std::process::ExitCode;

/// Exit status after an interrupt, as shells have it: 128 and the number of SIGINT.
pub const INTERRUPTED: u8 = 130;

/// Why a program ends without success.
#[derive(Debug)]
pub enum Failure {
    /// Exit status 1: no solution, an incomplete result, or data that cannot determine the answer.
    Undetermined(String),
    /// Exit status 2: unusable input or arguments.
    Unusable(String),
    /// Exit status 130: stopped from outside.
    Interrupted,
}

impl Failure {
    /// Unusable input, for the reason that an error gives.
    pub fn unusable(error: impl std::fmt::Display) -> Failure {
        Failure::Unusable(error.to_string())
    }

    /// Unusable input in a file.
    pub fn in_file(path: &std::path::Path, error: impl std::fmt::Display) -> Failure {
        Failure::Unusable(format!("{}: {error}", path.display()))
    }
}

/// The end of a program: says on standard error why it has failed, `interrupted` being what an interrupt has left.
pub fn finish(program: &str, result: Result<(), Failure>, interrupted: &str) -> ExitCode {
    let (message, status) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Undetermined(message)) => (message, 1),
        Err(Failure::Unusable(message)) => (message, 2),
        Err(Failure::Interrupted) => (format!("interrupted; {interrupted}"), INTERRUPTED),
    };
    eprintln!("{program}: {message}");
    ExitCode::from(status)
}

/// Runs work on this many threads; all cores for `None`.
///
/// # Errors
/// If the number is not between 1 and 1024, or threads cannot be started.
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    let mut builder = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = threads {
        if threads == 0 || threads > 1024 {
            return Err(Failure::Unusable(format!("--threads must be between 1 and 1024, not {threads}")));
        }
        builder = builder.num_threads(threads);
    }
    let pool = builder.build().map_err(|error| Failure::Unusable(format!("threads cannot be started: {error}")))?;
    Ok(pool.install(work))
}
