//! `tdoa experiment`.

mod book;
mod calibrate;
mod chart;
mod checks;
mod clean;
mod clocks;
mod common;
mod conditions;
mod crew;
mod damaged;
mod dimension;
mod families;
mod growth;
mod hard;
mod kinds;
mod noise;
mod recording;
mod reduced;
mod routes;
mod sound;
mod speed;
mod statistics;
mod table;
mod table2;

use cli::Failure;
use hc::ranks::Ranks;
use mpirun::Sharing;

/// Repeats an experiment and writes its numbers as CSV and its figures as SVG.
///
/// A run may be stopped at any time; the same command goes on where it was and ends with the same
/// numbers.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    kind: Kind,
    #[command(flatten)]
    ranks: Sharing,
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
    /// Measures how paths that fail are recovered.
    Charts(checks::Arguments),
    Hard(hard::Arguments),
    Speed(speed::Arguments),
    Calibrate(calibrate::Arguments),
    Coverage(calibrate::CoverageArguments),
    Conditions(conditions::Arguments),
    Growth(growth::Arguments),
    Damaged(damaged::Arguments),
    Reduced(reduced::Arguments),
    Dimension(dimension::Arguments),
    Clocks(clocks::Arguments),
    Sound(sound::Arguments),
    Kinds(kinds::Arguments),
    Families(families::Arguments),
}

impl Arguments {
    /// Which experiments several ranks can do.
    pub const SHARED: &str = "only `tdoa experiment calibrate`, `clean`, `clocks`, `conditions`, `coverage`, `damaged`, `dimension`, `families`, \
                              `kinds`, `noise`, `reduced`, `routes`, `sound` and `table2` run on several ranks";

    /// Options of work over several ranks, where the experiment has them.
    pub fn sharing(&self) -> Option<&Sharing> {
        match &self.kind {
            // One after the other, to take times, or done soon.
            Kind::Speed(_) | Kind::Growth(_) | Kind::Hard(_) | Kind::Proofs(_) | Kind::Hurry(_) | Kind::Charts(_) => {
                None
            }
            Kind::Table2(_)
            | Kind::Clean(_)
            | Kind::Noise(_)
            | Kind::Routes(_)
            | Kind::Calibrate(_)
            | Kind::Coverage(_)
            | Kind::Conditions(_)
            | Kind::Damaged(_)
            | Kind::Reduced(_)
            | Kind::Dimension(_)
            | Kind::Clocks(_)
            | Kind::Sound(_)
            | Kind::Kinds(_)
            | Kind::Families(_) => Some(&self.ranks),
        }
    }
}

/// Runs the experiment that the arguments name, with the other ranks if there are any: rank 0 alone
/// prints, and writes files.
///
/// # Errors
/// Unusable arguments, an experiment that fails, or an interrupt: rows of a table so far are kept.
pub fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    match &arguments.kind {
        Kind::Table2(arguments) => table2::run(arguments, ranks),
        Kind::Clean(arguments) => clean::run(arguments, ranks),
        Kind::Noise(arguments) => noise::run(arguments, ranks),
        Kind::Hard(arguments) => hard::run(arguments),
        Kind::Speed(arguments) => speed::run(arguments),
        Kind::Proofs(arguments) => checks::proofs(arguments),
        Kind::Routes(arguments) => routes::run(arguments, ranks),
        Kind::Hurry(arguments) => checks::hurry(arguments),
        Kind::Charts(arguments) => checks::charts(arguments),
        Kind::Calibrate(arguments) => calibrate::run(arguments, ranks),
        Kind::Coverage(arguments) => calibrate::run_coverage(arguments, ranks),
        Kind::Conditions(arguments) => conditions::run(arguments, ranks),
        Kind::Growth(arguments) => growth::run(arguments),
        Kind::Damaged(arguments) => damaged::run(arguments, ranks),
        Kind::Reduced(arguments) => reduced::run(arguments, ranks),
        Kind::Dimension(arguments) => dimension::run(arguments, ranks),
        Kind::Clocks(arguments) => clocks::run(arguments, ranks),
        Kind::Sound(arguments) => sound::run(arguments, ranks),
        Kind::Kinds(arguments) => kinds::run(arguments, ranks),
        Kind::Families(arguments) => families::run(arguments, ranks),
    }
}
