//! What the programs `hc` and `tdoa` share: exit statuses, files read and written, interrupts,
//! threads, progress bars.

pub mod bar;
pub mod files;
pub mod input;
pub mod interrupt;
pub mod output;
mod standard;
mod writing;

use std::process::ExitCode;

/// Exit status after an interrupt, as shells have it: 128 and the number of SIGINT.
pub const INTERRUPTED: u8 = 130;

/// Why a program ends without success.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Exit status 1: no solution, an incomplete result, or data that cannot determine the answer.
    #[error("{0}")]
    Undetermined(String),
    /// Exit status 2: unusable input or arguments.
    #[error("{0}")]
    Unusable(String),
    /// Exit status 130: stopped from outside.
    #[error("interrupted")]
    Interrupted,
    /// Exit status 130: stopped from outside; what is left is said.
    #[error("interrupted; {0}")]
    Stopped(String),
}

impl Failure {
    /// Unusable input, for the reason that an error gives.
    pub fn unusable(error: impl std::fmt::Display) -> Failure {
        Failure::Unusable(error.to_string())
    }

    /// Unusable input in a file, or in standard input for `-`.
    pub fn in_file(path: &std::path::Path, error: impl std::fmt::Display) -> Failure {
        Failure::Unusable(format!("{}: {error}", standard::name(path)))
    }
}

/// The end of a program: says on standard error why it has failed, `interrupted` being what an
/// interrupt has left.
pub fn finish(program: &str, result: Result<(), Failure>, interrupted: &str) -> ExitCode {
    let (message, status) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Undetermined(message)) => (message, 1),
        Err(Failure::Unusable(message)) => (message, 2),
        Err(Failure::Interrupted) => (format!("interrupted; {interrupted}"), INTERRUPTED),
        Err(error @ Failure::Stopped(_)) => (error.to_string(), INTERRUPTED),
    };
    eprintln!("{program}: {message}");
    ExitCode::from(status)
}

/// A number of threads that was asked for, if any.
///
/// # Errors
/// If it is not between 1 and 1024.
pub fn thread_count(threads: Option<usize>) -> Result<Option<usize>, Failure> {
    match threads {
        Some(count) if count == 0 || count > 1024 => {
            Err(Failure::Unusable(format!("--threads must be between 1 and 1024, not {count}")))
        }
        count => Ok(count),
    }
}

/// This many threads; as many as cores for `None`.
///
/// # Errors
/// If the number is not between 1 and 1024, or threads cannot be started.
pub fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Failure> {
    // Zero is rayon's word for all cores.
    let count = thread_count(threads)?.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(count).build();
    pool.map_err(|error| Failure::Unusable(format!("threads cannot be started: {error}")))
}

/// Runs work on this many threads; all cores for `None`.
///
/// # Errors
/// Those of [`pool`].
pub fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
    Ok(pool(threads)?.install(work))
}
