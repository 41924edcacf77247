//! `cargo xtask experiments`: everything that docs/results.md shows, from one command.
//!
//! Each experiment is one call of `tdoa experiment`. Its rows, one a network, collect under the
//! target directory, where a stopped run goes on; sums and figures are copied to results/, with a
//! record of how they were made, and the page is written from those alone.

mod page;
mod plan;
mod table;

use crate::workspace;
use anyhow::{Context, Result, ensure};
use clap::Args;
use plan::{Experiment, PLAN};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Repeats the experiments behind docs/results.md.
#[derive(Args)]
pub struct ExperimentsArguments {
    /// A few networks each, under three minutes in all; nothing in results/ changes.
    #[arg(long)]
    quick: bool,
    /// Only write docs/results.md from results/.
    #[arg(long, conflicts_with_all = ["quick", "check"])]
    page: bool,
    /// Only say whether docs/results.md is what results/ gives.
    #[arg(long, conflicts_with = "quick")]
    check: bool,
    /// These experiments only.
    #[arg(long, value_delimiter = ',')]
    only: Vec<String>,
    /// Share of the networks of the full run.
    #[arg(long, default_value_t = 1.0)]
    share: f64,
    /// Threads; all cores if not given.
    #[arg(long)]
    threads: Option<usize>,
    /// Folder of the recordings, with lund_floor_planar and others in it; by default data in the
    /// folder that SHARED_DIR names. Without them the experiments on recordings are left out.
    #[arg(long)]
    recordings: Option<PathBuf>,
}

/// Runs the experiments that are asked for and writes the page, or compares it with the tables.
///
/// # Errors
/// If an experiment fails, a table cannot be read, the page cannot be written, or it is stale.
pub fn run(arguments: &ExperimentsArguments) -> Result<()> {
    let root = workspace::root();
    let page = root.join("docs/results.md");
    if arguments.check {
        ensure!(
            workspace::read(&page)? == page::write(&root.join("results"))?,
            "docs/results.md is stale: cargo xtask experiments --page"
        );
        eprintln!("docs/results.md is up to date");
        return Ok(());
    }
    if !arguments.page {
        run_all(arguments, &root)?;
    }
    if arguments.quick {
        return Ok(());
    }
    workspace::write(&page, &page::write(&root.join("results"))?)
}

fn run_all(arguments: &ExperimentsArguments, root: &Path) -> Result<()> {
    for name in &arguments.only {
        let known: Vec<&str> = PLAN.iter().map(|experiment| experiment.name).collect();
        ensure!(known.contains(&name.as_str()), "no experiment is named {name}; there are {}", known.join(", "));
    }
    ensure!(arguments.share > 0.0 && arguments.share <= 1.0, "--share must be above 0 and at most 1");
    let recordings = arguments.recordings.clone().or_else(|| {
        let shared = std::env::var_os("SHARED_DIR").map_or_else(|| root.join("../shared"), PathBuf::from);
        Some(shared.join("data")).filter(|folder| folder.exists())
    });
    let tdoa = workspace::program(&workspace::build(&["tdoa-cli"])?, "tdoa");
    let work = workspace::target().join(if arguments.quick { "experiments-quick" } else { "experiments" });
    if arguments.quick && work.exists() {
        // Quick runs show that everything runs, so they start anew.
        std::fs::remove_dir_all(&work)?;
    }
    for experiment in PLAN {
        if !arguments.only.is_empty() && !arguments.only.iter().any(|name| name == experiment.name) {
            continue;
        }
        let share = if arguments.quick { None } else { Some(arguments.share) };
        let mut words = experiment.words(share);
        if !experiment.recordings.is_empty() {
            let Some(folder) = &recordings else {
                eprintln!("{}: left out, the recordings are not there (--recordings, SHARED_DIR)", experiment.name);
                continue;
            };
            let folders = experiment.recordings.iter().map(|name| folder.join(name).display().to_string());
            words.extend(["--recordings".to_owned(), folders.collect::<Vec<_>>().join(",")]);
        }
        println!("{}", experiment.name);
        let output = work.join(experiment.name);
        let mut command = Command::new(&tdoa);
        command.arg("experiment").args(&words).arg("--output").arg(&output);
        if let Some(threads) = arguments.threads {
            command.args(["--threads", &threads.to_string()]);
        }
        let status = command.status().with_context(|| format!("{} cannot be started", tdoa.display()))?;
        ensure!(status.success(), "{}: ended with {status}", experiment.name);
        if !arguments.quick {
            keep(experiment, share, &output, root)?;
        }
    }
    Ok(())
}

/// Copies sums and figures to results/ with a record of the run.
fn keep(experiment: &Experiment, share: Option<f64>, output: &Path, root: &Path) -> Result<()> {
    let folder = root.join("results").join(experiment.name);
    std::fs::create_dir_all(&folder)?;
    for entry in std::fs::read_dir(output)? {
        let name = entry?.file_name();
        // The rows of single networks are many; the command makes them again.
        if !matches!(name.to_str(), Some("trials.csv" | "candidates.csv")) {
            std::fs::copy(output.join(&name), folder.join(&name))?;
        }
    }
    let cores = std::thread::available_parallelism().map_or(0, usize::from);
    let record = format!(
        "item,value\ncommand,tdoa experiment {}\nseed,0\ncommit,{}\nprocessor,{}\ncores,{cores}\n",
        experiment.words(share).join(" "),
        workspace::commit(12),
        workspace::processor()
    );
    workspace::write(&folder.join("run.csv"), &record)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_what_the_results_give() {
        let root = workspace::root();
        let page = std::fs::read_to_string(root.join("docs/results.md")).unwrap();
        assert!(page == page::write(&root.join("results")).unwrap(), "stale: cargo xtask experiments --page");
    }
}
