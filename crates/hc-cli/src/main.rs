//! The program `hc`: polynomial systems by homotopy continuation.

mod input;
mod mixed_volume;
mod solve;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Polynomial systems by homotopy continuation.
///
/// Exit status: 0 success, 1 no solution, 2 unusable input or arguments.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    MixedVolume(mixed_volume::Arguments),
    Solve(solve::Arguments),
}

fn main() -> ExitCode {
    // clap ends the program itself, with status 2, if the arguments are wrong.
    let result = match Arguments::parse().command {
        Command::MixedVolume(arguments) => mixed_volume::run(&arguments).map(|()| true),
        Command::Solve(arguments) => solve::run(&arguments),
    };
    match result {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(message) => {
            eprintln!("hc: {message}");
            ExitCode::from(2)
        }
    }
}
