//! The program `tdoa`: calibration of sensor networks from arrival times alone.

mod calibrate;
mod experiment;
mod interrupt;
mod output;
mod simulate;
mod solve;
mod summary;
mod units;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Calibrates sensor networks in the plane from arrival times alone.
///
/// Exit status: 0 success, 1 no solution or data that cannot determine the network, 2 unusable input or arguments, 130
/// interrupted.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Calibrate(calibrate::Arguments),
    Experiment(experiment::Arguments),
    Simulate(simulate::Arguments),
    Solve(solve::Arguments),
}

/// Exit status after an interrupt, as shells have it: 128 and the number of SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Why the program ends without success.
pub(crate) enum Failure {
    /// Exit status 1: no solution, or data that cannot determine the network.
    Undetermined(String),
    /// Exit status 2: unusable input or arguments.
    Unusable(String),
    /// Exit status 130: stopped from outside.
    Interrupted,
}

impl Failure {
    fn unusable(error: impl std::fmt::Display) -> Failure {
        Failure::Unusable(error.to_string())
    }
}

fn main() -> ExitCode {
    // clap ends the program itself, with status 2, if the arguments are wrong.
    let result = match Arguments::parse().command {
        Command::Calibrate(arguments) => calibrate::run(&arguments),
        Command::Experiment(arguments) => experiment::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
    };
    let (message, status) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Undetermined(message)) => (message, 1),
        Err(Failure::Unusable(message)) => (message, 2),
        Err(Failure::Interrupted) => ("interrupted; nothing was written".to_string(), INTERRUPTED),
    };
    eprintln!("tdoa: {message}");
    ExitCode::from(status)
}

/// Runs work on this many threads; all cores for `None`.
pub(crate) fn on_threads<T: Send>(threads: Option<usize>, work: impl FnOnce() -> T + Send) -> Result<T, Failure> {
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

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
