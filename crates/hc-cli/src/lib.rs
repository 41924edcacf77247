//! The program `hc`: solutions of polynomial systems by homotopy continuation.

mod certify;
mod checkpoint;
mod codegen;
mod decompose;
mod family;
mod input;
mod mixed_volume;
mod monodromy;
mod numbers;
mod points;
mod report;
mod solve;
mod sweep;
mod track;
mod watch;

use clap::{Parser, Subcommand};
use cli::Failure;
use hc::ranks::Ranks;
use mpirun::{Machine, Program, Sharing};
use std::process::ExitCode;

/// Homotopy continuation: all isolated solutions of polynomial systems and of parameter families.
///
/// Exit status: 0 success, 1 no solution or an incomplete result, 2 unusable input or arguments,
/// 130 interrupted (the result is partial and says so).
#[derive(Parser)]
#[command(name = "hc", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    machine: Machine,
}

#[derive(Subcommand)]
enum Command {
    Certify(certify::Arguments),
    Codegen(codegen::Arguments),
    Decompose(decompose::Arguments),
    MixedVolume(mixed_volume::Arguments),
    Monodromy(monodromy::Arguments),
    Solve(solve::Arguments),
    Sweep(sweep::Arguments),
    Track(track::Arguments),
}

impl Program for Arguments {
    const NAME: &'static str = "hc";
    const SHARED: &'static str = "only `hc solve`, `track`, `monodromy` and `mixed-volume` run on several ranks";

    fn machine(&self) -> &Machine {
        &self.machine
    }

    fn sharing(&self) -> Option<&Sharing> {
        match &self.command {
            Command::Solve(arguments) => Some(&arguments.ranks),
            Command::Track(arguments) => Some(&arguments.ranks),
            Command::MixedVolume(arguments) => Some(&arguments.ranks),
            Command::Monodromy(arguments) => Some(&arguments.ranks),
            Command::Certify(_) | Command::Codegen(_) | Command::Decompose(_) | Command::Sweep(_) => None,
        }
    }

    fn execute(&self, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
        match &self.command {
            Command::Solve(arguments) => solve::run(arguments, ranks),
            Command::Track(arguments) => track::run(arguments, ranks),
            Command::MixedVolume(arguments) => mixed_volume::run(arguments, ranks),
            Command::Monodromy(arguments) => monodromy::run(arguments, ranks),
            Command::Certify(arguments) => certify::run(arguments),
            Command::Codegen(arguments) => codegen::run(arguments),
            Command::Decompose(arguments) => decompose::run(arguments),
            Command::Sweep(arguments) => sweep::run(arguments),
        }
    }

    fn left(&self) -> &'static str {
        "the result is partial"
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
