//! `tdoa experiment`.

mod calibrate;
mod chart;
mod checks;
mod clean;
mod common;
mod conditions;
mod damaged;
mod growth;
mod hard;
mod noise;
mod routes;
mod rows;
mod speed;
mod statistics;
mod table2;

use cli::Failure;

/// Repeats an experiment and writes its numbers as CSV and its figures as SVG.
///
/// A run may be stopped at any time; the same command goes on where it was and ends with the same
/// numbers.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    kind: Kind,
}

#[derive(clap::Subcommand)]
enum Kind {
    Table2(table2::Arguments),
    Clean(clean::Arguments),
    Noise(noise::Arguments),
    /// Proves by interval arithmetic that all roots that the minimal solvers report exist and are
    /// distinct.
    Proofs(checks::Arguments),
    Routes(routes::Arguments),
    /// Measures what the options for callers in a hurry save and lose.
    Hurry(checks::Arguments),
    /// Measures what becomes of paths that fail.
    Charts(checks::Arguments),
    Hard(hard::Arguments),
    Speed(speed::Arguments),
    Calibrate(calibrate::Arguments),
    Coverage(calibrate::CoverageArguments),
    Conditions(conditions::Arguments),
    Growth(growth::Arguments),
    Damaged(damaged::Arguments),
}

/// Runs the experiment that the arguments name.
///
/// # Errors
/// Unusable arguments, an experiment that fails, or an interrupt: rows of a table so far are kept.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match &arguments.kind {
        Kind::Table2(arguments) => table2::run(arguments),
        Kind::Clean(arguments) => clean::run(arguments),
        Kind::Noise(arguments) => noise::run(arguments),
        Kind::Hard(arguments) => hard::run(arguments),
        Kind::Speed(arguments) => speed::run(arguments),
        Kind::Proofs(arguments) => checks::proofs(arguments),
        Kind::Routes(arguments) => routes::run(arguments),
        Kind::Hurry(arguments) => checks::hurry(arguments),
        Kind::Charts(arguments) => checks::charts(arguments),
        Kind::Calibrate(arguments) => calibrate::run(arguments),
        Kind::Coverage(arguments) => calibrate::run_coverage(arguments),
        Kind::Conditions(arguments) => conditions::run(arguments),
        Kind::Growth(arguments) => growth::run(arguments),
        Kind::Damaged(arguments) => damaged::run(arguments),
    }
}
