//! The program `hc`: solutions of polynomial systems by homotopy continuation.

mod certify;
mod family;
mod input;
mod mixed_volume;
mod monodromy;
mod solve;
mod track;

use clap::{Parser, Subcommand};
use family::Failure;
use std::process::ExitCode;

/// Homotopy continuation: all isolated solutions of polynomial systems and of parameter families.
///
/// Exit status: 0 success, 1 no solution or an incomplete result, 2 unusable input or arguments.
#[derive(Parser)]
#[command(name = "hc", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Certify(certify::Arguments),
    MixedVolume(mixed_volume::Arguments),
    Monodromy(monodromy::Arguments),
    Solve(solve::Arguments),
    Track(track::Arguments),
}

fn main() -> ExitCode {
    // clap ends the program itself, with status 2, if the arguments are wrong.
    let (message, status) = match Arguments::parse().command {
        Command::Certify(arguments) => match certify::run(&arguments) {
            Ok(true) => return ExitCode::SUCCESS,
            Ok(false) => return ExitCode::from(1),
            Err(failure) => described(failure),
        },
        Command::MixedVolume(arguments) => match mixed_volume::run(&arguments) {
            Ok(()) => return ExitCode::SUCCESS,
            Err(message) => (message, 2),
        },
        Command::Solve(arguments) => match solve::run(&arguments) {
            Ok(true) => return ExitCode::SUCCESS,
            Ok(false) => return ExitCode::from(1),
            Err(message) => (message, 2),
        },
        Command::Monodromy(arguments) => match monodromy::run(&arguments) {
            Ok(()) => return ExitCode::SUCCESS,
            Err(failure) => described(failure),
        },
        Command::Track(arguments) => match track::run(&arguments) {
            Ok(()) => return ExitCode::SUCCESS,
            Err(failure) => described(failure),
        },
    };
    eprintln!("hc: {message}");
    ExitCode::from(status)
}

fn described(failure: Failure) -> (String, u8) {
    match failure {
        Failure::Incomplete(message) => (message, 1),
        Failure::Unusable(message) => (message, 2),
    }
}
