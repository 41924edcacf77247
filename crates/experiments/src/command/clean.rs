//! `tdoa experiment clean`.

use std::fmt::Write;

use crate::trials::clean::{CleanTrial, clean_trial, clean_trial_in_space};
use tdoa::minimal::{MinimalError, MinimalOptions, Solver};

use super::book::Rows;
use super::chart::{Labels, Series, histogram};
use super::common::{Common, Size, normal, thread_seconds};
use super::statistics::{decades, moments, short};
use super::table::Table;
use crate::quantile::quantile;
use cli::{Failure, output};
use hc::ranks::Ranks;

/// Solves clean random networks (positions and offsets standard normal) and counts roots, lost
/// paths and errors (the upper row of the paper's figure 1).
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations, such as 6r/3s, 4r/5s or 9r/4s.
    #[arg(long, default_value = "6r/4s,7r/3s,5r/4s,5r/5s,6r/3s,4r/5s,4r/6s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Coordinates of a position: 2 or 3. Times in space are those of all threads with --threads 1 alone.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    dimensions: u8,
    /// Number of networks a configuration.
    #[arg(long, default_value_t = 1000)]
    instances: u64,
    #[command(flatten)]
    common: Common,
}

const HEADER: &str = "configuration,seed,tracked,finite,at_infinity,failed,retracked,complex,real,positive_definite,physical,found,\
                      position_error,offset_error,steps,rejected,jacobians,milliseconds";

pub(super) fn run(arguments: &Arguments, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    let common = &arguments.common;
    let (trials, keys) = common.trials(&arguments.configuration, arguments.instances);
    let table = Table::new(common, "trials.csv", HEADER, &keys, ranks);
    let rows = table.resume(Solver::new, |solver, k| {
        let (size, seed) = trials[k];
        let options = MinimalOptions::default();
        let started = thread_seconds();
        let t: Result<CleanTrial, MinimalError> = match arguments.dimensions {
            3 => clean_trial_in_space(&normal(size, 0.0, seed)?, &options),
            _ => clean_trial(solver, &normal(size, 0.0, seed)?, &options),
        };
        let t = t.map_err(Failure::unusable)?;
        let milliseconds = 1e3 * (thread_seconds() - started);
        let (p, c) = (&t.paths, &t.counts);
        Ok(format!(
            "{},{},{},{},{},{},{},{},{},{},{:.2e},{:.2e},{},{milliseconds:.2}",
            p.tracked,
            p.finite,
            p.at_infinity,
            p.failed,
            p.retracked,
            c.complex,
            c.real,
            c.positive_definite,
            c.physical,
            t.found,
            t.position_error,
            t.offset_error,
            t.steps
                .map_or(",,".to_owned(), |steps| format!("{},{},{}", steps.accepted, steps.rejected, steps.jacobians))
        ))
    })?;
    let Some(rows) = rows else { return Ok(()) };
    let mut summary = String::from(
        "configuration,instances,paths,paths_lost,at_infinity,retracked,found,position_median,position_90,position_99,offset_median,\
         offset_90,offset_99,steps_a_path,real_min,real_max,real_mean,real_sd,physical_min,physical_max,physical_mean,physical_sd,\
         milliseconds_median,milliseconds_99,odd\n",
    );
    let mut bins = String::from("configuration,log10_from,positions,offsets\n");
    let each = arguments.instances as usize;
    for (g, &size) in arguments.configuration.iter().enumerate() {
        let group = Group { rows: &rows, range: g * each..(g + 1) * each };
        summary += &group.summary(size);
        for ((from, positions), (_, offsets)) in
            decades(&group.numbers("position_error")).into_iter().zip(decades(&group.numbers("offset_error")))
        {
            // Writing to a string does not fail.
            let _ = writeln!(bins, "{size},{from},{},{}", short(positions), short(offsets));
        }
        common.write(&format!("{}.svg", size.file()), &group.figure(size))?;
    }
    common.write("histogram.csv", &bins)?;
    common.write("summary.csv", &summary)?;
    output::print(&summary)
}

/// The trials of one configuration.
struct Group<'a> {
    rows: &'a Rows,
    range: std::ops::Range<usize>,
}

impl Group<'_> {
    fn numbers(&self, column: &str) -> Vec<f64> {
        self.rows.numbers(column, self.range.clone())
    }

    fn summary(&self, size: Size) -> String {
        let sum = |column: &str| self.numbers(column).iter().sum::<f64>();
        let tracked = sum("tracked");
        let mut cells = vec![size.to_string(), self.range.len().to_string(), tracked.to_string()];
        cells.extend(["failed", "at_infinity", "retracked", "found"].map(|column| sum(column).to_string()));
        for column in ["position_error", "offset_error"] {
            let all = self.numbers(column);
            cells.extend([0.5, 0.9, 0.99].map(|share| short(quantile(&all, share))));
        }
        cells.push(if tracked > 0.0 { short(sum("steps") / tracked) } else { String::new() });
        for column in ["positive_definite", "physical"] {
            cells.extend(moments(&self.numbers(column)).map(short));
        }
        let times = self.numbers("milliseconds");
        cells.extend([0.5, 0.99].map(|share| short(quantile(&times, share))));
        // Real networks come in pairs: an odd number tells of a path that was lost or jumped
        // unseen.
        let odd = self.numbers("positive_definite").iter().filter(|&&count| count % 2.0 == 1.0).count();
        cells.push(odd.to_string());
        cells.join(",") + "\n"
    }

    fn figure(&self, size: Size) -> String {
        let series = [("positions", "position_error"), ("offsets", "offset_error")]
            .map(|(name, column)| Series { name: name.into(), points: decades(&self.numbers(column)) });
        let labels = Labels {
            title: format!("{size}, {} clean networks", self.range.len()),
            x: "log10 of the relative error".into(),
            y: "share of the networks".into(),
        };
        histogram(&labels, 0.5, &series)
    }
}
