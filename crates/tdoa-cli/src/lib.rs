//! The program `tdoa`: calibration of sensor networks from arrival times alone.

mod calibrate;
mod clocks;
mod frame;
mod input;
mod known;
mod listen;
mod locate;
mod partial;
mod provenance;
mod recordings;
mod simulate;
mod solve;
mod summary;
mod units;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use cli::{Failure, interrupt, on_threads, output};
use hc::ranks::Ranks;
use mpirun::{Machine, Program, Sharing};

/// Calibrates sensor networks in the plane and in space from arrival times alone.
///
/// Exit status: 0 success, 1 no solution or data that cannot determine the network, 2 unusable
/// input or arguments, 130 interrupted.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    machine: Machine,
}

#[derive(Subcommand)]
enum Command {
    Calibrate(Box<calibrate::Arguments>),
    #[cfg(feature = "experiments")]
    Experiment(experiments::command::Arguments),
    Listen(listen::Arguments),
    Locate(locate::Arguments),
    Simulate(simulate::Arguments),
    Solve(solve::Arguments),
}

impl Program for Arguments {
    const NAME: &'static str = "tdoa";
    #[cfg(feature = "experiments")]
    const SHARED: &'static str = experiments::command::Arguments::SHARED;
    #[cfg(not(feature = "experiments"))]
    const SHARED: &'static str = "no command of this build runs on several ranks";

    fn machine(&self) -> &Machine {
        &self.machine
    }

    fn sharing(&self) -> Option<&Sharing> {
        match &self.command {
            #[cfg(feature = "experiments")]
            Command::Experiment(arguments) => arguments.sharing(),
            Command::Calibrate(_)
            | Command::Listen(_)
            | Command::Locate(_)
            | Command::Simulate(_)
            | Command::Solve(_) => None,
        }
    }

    #[cfg_attr(not(feature = "experiments"), allow(unused_variables))]
    fn execute(&self, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
        match &self.command {
            Command::Calibrate(arguments) => calibrate::run(arguments),
            #[cfg(feature = "experiments")]
            Command::Experiment(arguments) => experiments::command::run(arguments, ranks),
            Command::Listen(arguments) => listen::run(arguments),
            Command::Locate(arguments) => locate::run(arguments),
            Command::Simulate(arguments) => simulate::run(arguments),
            Command::Solve(arguments) => solve::run(arguments),
        }
    }

    fn left(&self) -> &'static str {
        match &self.command {
            #[cfg(feature = "experiments")]
            Command::Experiment(_) => "the rows so far are kept, and the same command goes on from there",
            _ => "nothing was written",
        }
    }
}

/// Runs the program with the arguments of the process; its exit status.
pub fn main() -> ExitCode {
    mpirun::main::<Arguments>()
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
