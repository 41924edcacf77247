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
mod ranks;
mod report;
mod solve;
mod track;
mod watch;

use clap::{Parser, Subcommand};
use cli::Failure;
use hc::ranks::{Exchange, Ranks, RanksOptions};
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

/// Does what was asked for, as one of several ranks if there are others.
fn execute(command: &Command, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    match command {
        Command::Solve(arguments) => solve::run(arguments, ranks),
        Command::Track(arguments) => track::run(arguments, ranks),
        Command::MixedVolume(arguments) => mixed_volume::run(arguments, ranks),
        Command::Monodromy(arguments) => monodromy::run(arguments, ranks),
        _ if ranks.is_some() => {
            let those = "only `hc solve`, `track`, `monodromy` and `mixed-volume` run on several ranks";
            Err(Failure::Unusable(format!("{those}; start this without mpirun")))
        }
        Command::Certify(arguments) => certify::run(arguments),
        Command::Codegen(arguments) => codegen::run(arguments),
        Command::Decompose(arguments) => decompose::run(arguments),
    }
}

/// Runs the program with the arguments of the process; its exit status.
pub fn main() -> ExitCode {
    ranks::with(run)
}

/// Runs the program, as one of the ranks between which `exchange` carries messages.
fn run(exchange: Option<&dyn Exchange>) -> ExitCode {
    let is_lead = exchange.is_none_or(|exchange| exchange.rank() == 0);
    let command = match Arguments::try_parse() {
        Ok(arguments) => arguments.command,
        Err(error) => {
            if is_lead {
                // Nobody is there to be told that the words cannot be printed.
                let _ = error.print();
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let options = match &command {
        Command::Solve(arguments) => arguments.ranks.options(),
        Command::Track(arguments) => arguments.ranks.options(),
        Command::MixedVolume(arguments) => arguments.ranks.options(),
        Command::Monodromy(arguments) => arguments.ranks.options(),
        _ => RanksOptions::new(),
    };
    let ranks = exchange.map(|exchange| Ranks::new(exchange, &options));
    let result = execute(&command, ranks.as_ref());
    if !is_lead {
        // Rank 0 says what there is to be said.
        let failure = result.err().map(|error| error.to_string());
        ranks.inspect(|ranks| ranks.finish(failure.as_deref()));
        return ExitCode::SUCCESS;
    }
    let status = cli::finish("hc", result, "the result is partial");
    ranks.inspect(|ranks| ranks.finish(None));
    status
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
