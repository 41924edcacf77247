//! `tdoa experiment routes`.

use std::fmt::Write;

use crate::trials::checks::route_trial;
use tdoa::minimal::Solver;

use super::common::{Common, Size, normal, thread_seconds};
use super::statistics::short;
use super::table::Table;
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Compares all real networks from the stored start of the minimal solvers with those from a
/// polyhedral start system, which is computed for each network as in the paper; where that leaves
/// roots missing, another one is computed for a random member of the family.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "6r/3s,7r/3s,9r/3s,5r/4s,6r/4s,5r/5s,7r/4s,5r/6s,4r/5s,4r/6s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Number of networks of each configuration (positions and offsets standard normal, no noise).
    #[arg(long, default_value_t = 100)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

const HEADER: &str =
    "configuration,seed,roots_stored,roots_polyhedral,real_stored,real_polyhedral,paths,retracked,agree,seconds";

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let common = &arguments.common;
    let (trials, keys) = common.trials(&arguments.configuration, arguments.instances);
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(Solver::new, |solver, k| {
        let (size, seed) = trials[k];
        let simulation = normal(size, 0.0, seed)?;
        let started = thread_seconds();
        let t = route_trial(solver, &simulation).map_err(Failure::unusable)?;
        Ok(format!(
            "{},{},{},{},{},{},{},{:.2}",
            t.stored.complex,
            t.polyhedral.complex,
            t.stored.real,
            t.polyhedral.real,
            t.paths.tracked,
            t.paths.retracked,
            t.agree,
            thread_seconds() - started
        ))
    })?;
    let Some(rows) = rows else { return Ok(()) };
    let mut summary = String::from(
        "configuration,instances,agree,roots_stored,roots_polyhedral,at_data,seconds_mean,seconds_max,seeds_that_differ\n",
    );
    let each = arguments.instances as usize;
    for (g, &size) in arguments.configuration.iter().enumerate() {
        let numbers = |column: &str| rows.numbers(column, g * each..(g + 1) * each);
        let sum = |column: &str| numbers(column).iter().sum::<f64>();
        let agree = numbers("agree");
        let differ = common.seeds(arguments.instances).zip(&agree).filter(|(_, agree)| **agree == 0.0);
        // Paths that a random member takes count as tracked again.
        let at_data = numbers("retracked").iter().filter(|retracked| **retracked == 0.0).count();
        // Writing to a string does not fail.
        let _ = writeln!(
            summary,
            "{size},{each},{},{},{},{at_data},{},{},{}",
            sum("agree"),
            sum("roots_stored"),
            sum("roots_polyhedral"),
            short(sum("seconds") / each.max(1) as f64),
            short(numbers("seconds").into_iter().fold(0.0, f64::max)),
            differ.map(|(seed, _)| seed.to_string()).collect::<Vec<_>>().join(" ")
        );
    }
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}
