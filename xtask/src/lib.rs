//! Development tasks: `cargo xtask codegen | experiments | compare | counts`.

mod codegen;
mod refill;

use clap::{Parser, Subcommand};
use experiments::{compare, counts, results};

#[derive(Parser)]
#[command(name = "cargo xtask", about = "Development tasks of this workspace")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    /// Write the generated solvers from the families and their stored fibres.
    Codegen(codegen::CodegenArguments),
    /// Repeat the experiments behind docs/results.md.
    Experiments(results::ExperimentsArguments),
    /// Measure this project beside the peers that are installed.
    Compare(compare::CompareArguments),
    /// Solve the systems with verified counts for many seeds.
    Counts(counts::CountsArguments),
}

/// Runs the task that the arguments of the process name.
///
/// # Errors
/// If the task fails.
pub fn main() -> anyhow::Result<()> {
    match Arguments::parse().task {
        Task::Codegen(arguments) => codegen::run(&arguments),
        Task::Experiments(arguments) => results::run(&arguments),
        Task::Compare(arguments) => compare::run(&arguments),
        Task::Counts(arguments) => counts::run(&arguments),
    }
}
