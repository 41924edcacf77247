//! The program `hc`: solutions of polynomial systems by homotopy continuation.

mod certify;
mod checkpoint;
mod codegen;
mod decompose;
mod family;
mod input;
mod mixed_volume;
mod monodromy;
mod points;
mod report;
mod solve;
mod track;
mod watch;

use clap::{Parser, Subcommand};
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
}

#[derive(Subcommand)]
enum Command {
    Certify(certify::Arguments),
    Codegen(codegen::Arguments),
    Decompose(decompose::Arguments),
    MixedVolume(mixed_volume::Arguments),
    Monodromy(monodromy::Arguments),
    Solve(solve::Arguments),
    Track(track::Arguments),
}

/// Runs the program with the arguments of the process; its exit status.
pub fn main() -> ExitCode {
    // clap ends the program itself, with status 2, if the arguments are wrong.
    let result = match Arguments::parse().command {
        Command::Certify(arguments) => certify::run(&arguments),
        Command::Codegen(arguments) => codegen::run(&arguments),
        Command::Decompose(arguments) => decompose::run(&arguments),
        Command::MixedVolume(arguments) => mixed_volume::run(&arguments),
        Command::Monodromy(arguments) => monodromy::run(&arguments),
        Command::Solve(arguments) => solve::run(&arguments),
        Command::Track(arguments) => track::run(&arguments),
    };
    cli::finish("hc", result, "the result is partial")
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
