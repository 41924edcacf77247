//! The program `hc`: solutions of polynomial systems by homotopy continuation.

mod family;
mod monodromy;
mod track;

use clap::{Parser, Subcommand};
use family::Failure;
use std::process::ExitCode;

/// Homotopy continuation: all solutions of parameter families of polynomial systems.
///
/// Exit status: 0 success, 1 an incomplete result, 2 unusable input or arguments.
#[derive(Parser)]
#[command(name = "hc", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Monodromy(monodromy::Arguments),
    Track(track::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Monodromy(arguments) => monodromy::run(&arguments),
        Command::Track(arguments) => track::run(&arguments),
    };
    let (message, status) = match result {
        Ok(()) => return ExitCode::SUCCESS,
        Err(Failure::Incomplete(message)) => (message, 1),
        Err(Failure::Unusable(message)) => (message, 2),
    };
    eprintln!("hc: {message}");
    ExitCode::from(status)
}
