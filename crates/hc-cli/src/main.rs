//! The program `hc`: polynomial systems by homotopy continuation.

mod input;
mod mixed_volume;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Polynomial systems by homotopy continuation.
///
/// Exit status: 0 success, 2 unusable input or arguments.
#[derive(Parser)]
#[command(version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    MixedVolume(mixed_volume::Arguments),
}

fn main() -> ExitCode {
    // clap ends the program itself, with status 2, if the arguments are wrong.
    let result = match Arguments::parse().command {
        Command::MixedVolume(arguments) => mixed_volume::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("hc: {message}");
            ExitCode::from(2)
        }
    }
}
