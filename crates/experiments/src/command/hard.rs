//! `tdoa experiment hard`.

use super::common::Size;
use crate::trials::hard::{Case, HardSummary, hard_trials};
use cli::bar::Bar;
use cli::files::check_directory;
use cli::{Failure, output};
use rayon::prelude::{IntoParallelIterator, ParallelIterator};
use std::fmt::Write;
use std::path::PathBuf;
use tdoa::minimal::Solver;
use tdoa::{Layout, SimulateOptions, simulate};

/// Solves networks next to degenerate ones, degenerate ones, and ones of extreme scales, without
/// noise.
#[derive(clap::Args)]
pub(super) struct Arguments {
    /// The configurations.
    #[arg(long, default_value = "6r/3s,5r/4s,4r/5s", value_delimiter = ',')]
    configuration: Vec<Size>,
    /// Number of networks a case.
    #[arg(long, default_value_t = 20)]
    instances: u64,
    /// First seed.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Directory for summary.md; made if it is not there.
    #[arg(long)]
    output: PathBuf,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    check_directory(&arguments.output, &["summary.md"], true)?;
    let mut text = format!(
        "# Hard networks\n\n`tdoa experiment hard --instances {} --seed {} --output DIR`: positions and offsets standard normal, then made \
         hard as stated; no noise. \"found\": the true network is among the physical candidates, to 1e-3 of its size. \"refused\": an error \
         names the nodes. \"warned\": not found, but a warning says that the list may not be whole or that nodes lie in one line.\n",
        arguments.instances, arguments.seed
    );
    for &Size { receivers, transmitters } in &arguments.configuration {
        let networks = (arguments.seed..arguments.seed.saturating_add(arguments.instances))
            .map(|seed| {
                let mut options = SimulateOptions::default();
                (options.receivers, options.transmitters) = (receivers, transmitters);
                options.layout = Layout::Normal;
                options.noise = 0.0;
                options.seed = seed;
                simulate(&options).map(|s| s.network).map_err(Failure::unusable)
            })
            .collect::<Result<Vec<_>, _>>()?;
        let bar = Bar::counted(Case::ALL.len() as u64);
        let summaries: Vec<HardSummary> = cli::on_threads(arguments.threads, || {
            Case::ALL
                .into_par_iter()
                .map_init(Solver::new, |solver, case| {
                    let summary = hard_trials(solver, case, networks.iter().cloned());
                    bar.inc(1);
                    summary
                })
                .collect()
        })?;
        bar.finish_and_clear();
        let _ = write!(
            text,
            "\n## {receivers}r/{transmitters}s\n\n| network | found | refused | warned | wrong without a word | paths lost | largest position error |\n\
             |---|---|---|---|---|---|---|\n"
        );
        for (case, s) in Case::ALL.into_iter().zip(&summaries) {
            let error = if s.found > 0 { format!("{:.1e}", s.position_error) } else { "-".into() };
            let _ = writeln!(
                text,
                "| {} | {} of {} | {} | {} | {} | {} | {error} |",
                case.name(),
                s.found,
                s.instances,
                s.refused,
                s.warned,
                s.silent,
                s.paths_lost
            );
        }
    }
    let directory = &arguments.output;
    std::fs::create_dir_all(directory)
        .map_err(|error| Failure::Unusable(format!("{}: cannot be made ({error})", directory.display())))?;
    output::write(&directory.join("summary.md"), text.as_bytes())?;
    output::print(&text)
}
