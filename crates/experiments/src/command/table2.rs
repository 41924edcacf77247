//! `tdoa experiment table2`.

use std::fmt::Write;

use tdoa::minimal::{MinimalOptions, Solver};

use super::book::Rows;
use super::chart::{Labels, Series, histogram};
use super::common::{Common, Size, normal};
use super::statistics::{moments, short};
use super::table::Table;
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Counts the solutions of clean random 6r/3s networks (the paper's Table 2): real, with positive
/// definite H, physical.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// Number of networks.
    #[arg(long, default_value_t = 10_000)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

const HEADER: &str = "seed,complex,real,positive_definite,physical,failed";

/// The counts of the table, and what they are called in it.
const KINDS: [(&str, &str); 3] =
    [("real", "real"), ("positive_definite", "real with H > 0"), ("physical", "physical: all f - o >= 0")];

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let common = &arguments.common;
    let size = Size { receivers: 6, transmitters: 3 };
    let seeds = common.seeds(arguments.instances);
    let keys: Vec<String> = seeds.clone().map(|seed| seed.to_string()).collect();
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(Solver::new, |solver, k| {
        let simulation = normal::<2>(size, 0.0, seeds.start + k as u64)?;
        let solution = solver.solve(&simulation.pseudoranges, &MinimalOptions::default()).map_err(Failure::unusable)?;
        let c = solution.counts;
        Ok(format!("{},{},{},{},{}", c.complex, c.real, c.positive_definite, c.physical, solution.paths.failed))
    })?;
    let Some(rows) = rows else { return Ok(()) };
    let count = keys.len();
    if count == 0 {
        return Err(Failure::Unusable("--instances must be at least 1".into()));
    }
    common.write("histogram.csv", &bins(&rows, count))?;
    common.write("counts.svg", &figure(&rows, count))?;
    let summary = summary(&rows, count);
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}

fn summary(rows: &Rows, count: usize) -> String {
    let odd = rows.numbers("positive_definite", 0..count).iter().filter(|c| **c % 2.0 == 1.0).count();
    let lost = rows.numbers("failed", 0..count).iter().filter(|c| **c > 0.0).count();
    let mut text = "count,instances,min,max,mean,standard_deviation,odd,with_lost_paths\n".to_string();
    for (column, _) in KINDS {
        let [least, largest, mean, deviation] = moments(&rows.numbers(column, 0..count));
        let odd = if column == "positive_definite" { odd.to_string() } else { String::new() };
        // Writing to a string does not fail.
        let _ = writeln!(text, "{column},{count},{least},{largest},{},{},{odd},{lost}", short(mean), short(deviation));
    }
    text
}

/// How many instances have how many solutions.
fn tally(rows: &Rows, column: &str, count: usize) -> Vec<usize> {
    let mut tally = vec![0; 181];
    for solutions in rows.numbers(column, 0..count) {
        tally[(solutions as usize).min(180)] += 1;
    }
    tally
}

fn bins(rows: &Rows, count: usize) -> String {
    let all = KINDS.map(|(column, _)| tally(rows, column, count));
    let last = (0..181).rev().find(|&k| all.iter().any(|tally| tally[k] > 0)).unwrap_or(0);
    let lines = (0..=last).map(|k| format!("{k},{},{},{}\n", all[0][k], all[1][k], all[2][k]));
    format!("solutions,real,positive_definite,physical\n{}", lines.collect::<String>())
}

fn figure(rows: &Rows, count: usize) -> String {
    // Real solutions without H > 0 are no networks; the paper counts those with it.
    let series: Vec<Series> = KINDS[1..]
        .iter()
        .map(|(column, name)| {
            let tally = tally(rows, column, count);
            let points = tally.iter().enumerate().map(|(k, &n)| (k as f64, n as f64 / count as f64)).collect();
            Series { name: (*name).to_string(), points }
        })
        .collect();
    let labels = Labels {
        title: format!("Solutions of {count} clean random 6r/3s networks"),
        x: "number of solutions".into(),
        y: "share of the networks".into(),
    };
    histogram(&labels, 1.0, &series)
}
