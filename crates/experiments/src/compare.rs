//! `cargo xtask compare`: this project beside the peers that are installed, in one run.

mod curves;
// The families of systems are those of the tests.
#[path = "../../hc/tests/all/common/generators.rs"]
mod generators;
mod large;
mod networks;
mod program;
mod solving;
mod volumes;
mod written;

use crate::workspace;
use anyhow::Result;
use clap::{Args, ValueEnum};
use program::{Plan, Tools};
use std::path::PathBuf;
use std::process::Command;

/// Measures `hc` and `tdoa` beside PHCpack, Macaulay2 and gfan, and writes docs/compare.md.
#[derive(Args)]
pub struct CompareArguments {
    /// One repeat of a few small cases, for two minutes or so.
    #[arg(long)]
    quick: bool,
    /// The tables; all if not given.
    #[arg(long, value_enum)]
    table: Vec<Table>,
    /// How often each pair of programs runs.
    #[arg(long, default_value_t = 3)]
    repeats: u32,
    /// Instances of each network.
    #[arg(long, default_value_t = 2)]
    instances: u64,
    /// Processor seconds after which a run of a peer is stopped.
    #[arg(long, default_value_t = 600)]
    limit: u32,
    /// The folder of systems.
    #[arg(long, default_value_os_t = workspace::root().join("examples/systems"), hide_default_value = true)]
    systems: PathBuf,
    /// A folder with the programs hc and tdoa; they are built in the release profile if not given.
    #[arg(long)]
    programs: Option<PathBuf>,
    /// Markdown file for the tables, - for standard output; docs/compare.md if not given, standard
    /// output if --quick.
    #[arg(long)]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Table {
    Phcpack,
    Macaulay2,
    Gfan,
    Networks,
    /// Formulas as written beside the same rewritten by hand.
    Written,
    /// Large systems, beside published figures.
    Large,
}

/// Runs the tables that are asked for and writes the page.
///
/// # Errors
/// If a program cannot be built, started or understood, or the page cannot be written.
pub fn run(arguments: &CompareArguments) -> Result<()> {
    let plan = Plan {
        quick: arguments.quick,
        repeats: if arguments.quick { 1 } else { arguments.repeats.max(1) },
        instances: if arguments.quick { 1 } else { arguments.instances },
        limit: if arguments.quick { arguments.limit.min(60) } else { arguments.limit },
        systems: arguments.systems.clone(),
    };
    let folder = match &arguments.programs {
        Some(folder) => folder.clone(),
        None => workspace::build(&["hc-cli", "tdoa-cli"])?,
    };
    let tools = Tools {
        hc: workspace::program(&folder, "hc"),
        tdoa: workspace::program(&folder, "tdoa"),
        phc: program::is_installed("phc"),
        macaulay2: program::is_installed("M2"),
        gfan: program::is_installed("gfan"),
    };
    let default = workspace::root().join("docs/compare.md");
    let whole = !plan.quick && arguments.table.is_empty();
    let output = arguments.output.as_deref().or_else(|| whole.then_some(default.as_path()));
    let output = output.filter(|path| path.as_os_str() != "-");
    let mut text = introduction(&plan, &tools);
    let wanted = |table: &&Table| arguments.table.is_empty() || arguments.table.contains(table);
    let tables: Vec<&Table> = Table::value_variants().iter().filter(wanted).collect();
    for (k, table) in tables.iter().enumerate() {
        match table {
            Table::Phcpack => {
                solving::beside_phcpack(&tools, &plan, &mut text)?;
                solving::small(&tools, &plan, &mut text)?;
            }
            Table::Macaulay2 => solving::beside_macaulay2(&tools, &plan, &mut text)?,
            Table::Gfan => volumes::beside_gfan(&tools, &plan, &mut text)?,
            Table::Networks => networks::beside_phcpack(&tools, &plan, &mut text)?,
            Table::Written => written::beside_rewritten(&plan, &mut text)?,
            Table::Large => large::table(&tools, &plan, &mut text)?,
        }
        // The tables so far, for a run that is ended early, and what is then missing.
        if let Some(path) = output {
            let missing: Vec<String> =
                tables[k + 1..].iter().map(|table| format!("{table:?}").to_lowercase()).collect();
            let rest = match missing.join(", ") {
                none if none.is_empty() => String::new(),
                some => format!("\nThe run was ended before these tables: {some} (`--table`).\n"),
            };
            workspace::write(path, &(text.clone() + &rest))?;
        }
    }
    if output.is_none() {
        print!("{text}");
    }
    Ok(())
}

fn introduction(plan: &Plan, tools: &Tools) -> String {
    let mut peers = Vec::new();
    let mut absent = Vec::new();
    // Program, how it is asked for its version, and Debian's package.
    for (there, name, command, arguments, package) in [
        (tools.phc, "PHCpack", "phc", &["--version"][..], "phcpack"),
        (tools.macaulay2, "Macaulay2", "M2", &["--version"], "macaulay2"),
        (tools.gfan, "gfan", "gfan", &["_version"], "gfan"),
    ] {
        if there {
            peers.push(format!("{name} {}", version(command, arguments)));
        } else {
            absent.push(format!("{name} (Debian: {package})"));
        }
    }
    let peers = if peers.is_empty() { "none".to_owned() } else { peers.join(", ") };
    let absent = if absent.is_empty() { String::new() } else { format!(" Absent: {}.", absent.join(", ")) };
    let times = if plan.repeats == 1 { "once".to_owned() } else { format!("{} times", plan.repeats) };
    format!(
        "# Beside other programs\n\n\
         Written by `cargo xtask compare`{}. Every case runs first here, then in the peer; the pair runs {times} (once if the peer takes over a \
         minute). Peers are stopped after {} processor seconds. Seconds are processor seconds of the whole process, so that other work on the machine \
         matters little. The table shows the run of median time. A ratio is the median of the pairs' ratios; it is above one where this project is \
         faster. Memory is the peak of the process from its fork on: less than about 13 MB cannot be seen.\n\n\
         Peers: {peers}.{absent} Machine: {}. Commit {}. [features.md](features.md) says what each program can do.\n\n",
        if plan.quick { " --quick" } else { "" },
        plan.limit,
        machine(),
        workspace::commit(7)
    )
}

/// The number in what a program says of its version.
fn version(command: &str, arguments: &[&str]) -> String {
    let Ok(output) = Command::new(command).args(arguments).output() else { return String::new() };
    let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    let is_number = |word: &&str| word.contains('.') && word.chars().all(|c| c.is_ascii_digit() || c == '.');
    let words = text.split_whitespace().map(|w| w.trim_start_matches(|c: char| !c.is_ascii_digit()).trim_matches('.'));
    words.clone().find(is_number).unwrap_or_default().to_owned()
}

/// Model and number of processors.
fn machine() -> String {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    format!("{}, {threads} processors", workspace::processor())
}
