//! `cargo xtask counts`: systems with verified counts, solved and certified for many seeds.

use crate::workspace;
use anyhow::{Context, Result, ensure};
use clap::Args;
use hc::certify::{CertifyOptions, certify};
use hc::poly::{Complex64, System, parse::phcpack};
use hc::{Solutions, SolveOptions, solve};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Solves every system with verified counts for many seeds, certifies what it finds, and compares.
#[derive(Args)]
pub struct CountsArguments {
    /// Seeds of each system: 0, 1, ...
    #[arg(long, default_value_t = 20)]
    seeds: u64,
    /// Seeds of katsura8, reimer5 and caprasse, if more.
    #[arg(long, default_value_t = 100)]
    more: u64,
    /// Only these systems.
    #[arg(long)]
    only: Vec<String>,
    /// The folder of systems, with expected.csv.
    #[arg(long, default_value_os_t = workspace::root().join("examples/systems"), hide_default_value = true)]
    systems: PathBuf,
    /// Directory for counts.csv, whose rows are kept and continued, and counts.md; results if not
    /// given.
    #[arg(long, default_value_os_t = workspace::root().join("results"), hide_default_value = true)]
    output: PathBuf,
}

/// Systems that get more seeds.
const LONG: [&str; 3] = ["katsura8", "reimer5", "caprasse"];

/// What is known of a system.
struct Expected {
    name: String,
    distinct: usize,
    /// Such as `24x1 8x4`; empty where not known.
    structure: String,
    real: Option<usize>,
    component: bool,
}

/// What one seed gave.
struct Row {
    name: String,
    seed: u64,
    distinct: usize,
    structure: String,
    real: usize,
    on_components: usize,
    lost: usize,
    retracked: usize,
    start_systems: u32,
    regular: usize,
    certified: usize,
    seconds: f64,
}

const HEADER: &str = "system,seed,distinct,multiplicity_structure,real_distinct,on_components,lost,retracked,start_systems,\
                      regular,certified,seconds";

impl Row {
    fn line(&self) -> String {
        format!(
            "{},{},{},{},{},{},{},{},{},{},{},{:.4}",
            self.name,
            self.seed,
            self.distinct,
            self.structure,
            self.real,
            self.on_components,
            self.lost,
            self.retracked,
            self.start_systems,
            self.regular,
            self.certified,
            self.seconds
        )
    }

    fn parse(line: &str) -> Option<Row> {
        let fields: Vec<&str> = line.split(',').collect();
        let [
            name,
            seed,
            distinct,
            structure,
            real,
            on_components,
            lost,
            retracked,
            start_systems,
            regular,
            certified,
            seconds,
        ] = fields[..]
        else {
            return None;
        };
        Some(Row {
            name: name.to_owned(),
            seed: seed.parse().ok()?,
            distinct: distinct.parse().ok()?,
            structure: structure.to_owned(),
            real: real.parse().ok()?,
            on_components: on_components.parse().ok()?,
            lost: lost.parse().ok()?,
            retracked: retracked.parse().ok()?,
            start_systems: start_systems.parse().ok()?,
            regular: regular.parse().ok()?,
            certified: certified.parse().ok()?,
            seconds: seconds.parse().ok()?,
        })
    }

    fn agrees(&self, expected: &Expected) -> bool {
        self.distinct == expected.distinct
            && (expected.structure.is_empty() || self.structure == expected.structure)
            && expected.real.is_none_or(|n| n == self.real)
            && (self.on_components > 0) == expected.component
            && self.lost == 0
    }
}

/// Solves what is not in counts.csv yet and writes the page of counts.
///
/// # Errors
/// If a system cannot be read or solved, or a file cannot be written.
pub fn run(arguments: &CountsArguments) -> Result<()> {
    let systems = read(&arguments.systems.join("expected.csv"))?;
    let known = |name: &String| systems.iter().any(|s| s.name == *name);
    ensure!(arguments.only.iter().all(known), "--only names systems of expected.csv");
    std::fs::create_dir_all(&arguments.output)?;
    let file = arguments.output.join("counts.csv");
    let mut rows = stored(&file)?;
    for expected in &systems {
        if !arguments.only.is_empty() && !arguments.only.contains(&expected.name) {
            continue;
        }
        let many = LONG.contains(&expected.name.as_str());
        let seeds = if many { arguments.more.max(arguments.seeds) } else { arguments.seeds };
        let system = phcpack(&workspace::read(&arguments.systems.join(format!("{}.phc", expected.name)))?)?;
        for seed in 0..seeds {
            if rows.iter().any(|row| row.name == expected.name && row.seed == seed) {
                continue;
            }
            let row = one(&expected.name, &system, seed)?;
            if !row.agrees(expected) {
                eprintln!("off: {}", row.line());
            }
            rows.push(row);
            store(&file, &rows)?;
        }
        eprintln!("{}: {seeds} seeds", expected.name);
    }
    workspace::write(&arguments.output.join("counts.md"), &page(&systems, &rows)?)
}

/// The rows of an earlier run.
fn stored(file: &Path) -> Result<Vec<Row>> {
    if !file.exists() {
        return Ok(Vec::new());
    }
    let row = |line: &str| Row::parse(line).with_context(|| format!("{}: cannot read {line:?}", file.display()));
    workspace::read(file)?.lines().skip(1).map(row).collect()
}

/// Writes the rows so far.
fn store(file: &Path, rows: &[Row]) -> Result<()> {
    let lines: String = rows.iter().map(|row| row.line() + "\n").collect();
    workspace::write(file, &format!("{HEADER}\n{lines}"))
}

/// The table in words.
fn page(systems: &[Expected], rows: &[Row]) -> Result<String> {
    let mut text = String::from(
        "# Systems with verified counts\n\n\
         Written by `cargo xtask counts`, from counts.csv: each system of [examples/systems](../examples/systems) solved from the front door for \
         the seeds 0, 1, ..., and every regular solution certified. \"agreeing\": number of distinct solutions, their multiplicities, \
         the number of real ones (where it is known) and whether there is a component, all as in expected.csv, and no path lost.\n\n\
         | system | solutions | multiplicities | real | seeds | agreeing | paths lost | tracked again | seeds with other start systems | certified of regular |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut off = String::new();
    for expected in systems {
        let rows: Vec<&Row> = rows.iter().filter(|row| row.name == expected.name).collect();
        let sum = |number: fn(&Row) -> usize| rows.iter().map(|row| number(row)).sum::<usize>();
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} of {} |",
            expected.name,
            expected.distinct,
            expected.structure,
            expected.real.map_or_else(String::new, |n| n.to_string()),
            rows.len(),
            rows.iter().filter(|row| row.agrees(expected)).count(),
            sum(|row| row.lost),
            sum(|row| row.retracked),
            rows.iter().filter(|row| row.start_systems > 1).count(),
            sum(|row| row.certified),
            sum(|row| row.regular)
        )?;
        for row in rows.iter().filter(|row| !row.agrees(expected)) {
            writeln!(
                off,
                "* {}, seed {}: {} solutions ({}), {} real, {} paths lost, {} on components",
                row.name, row.seed, row.distinct, row.structure, row.real, row.lost, row.on_components
            )?;
        }
    }
    text += if off.is_empty() { "\nNo count is off for any seed.\n" } else { "\nOff:\n\n" };
    Ok(text + &off)
}

fn read(path: &Path) -> Result<Vec<Expected>> {
    let table = workspace::read(path)?;
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        ensure!(fields.len() > 8, "{}: too few columns in {line:?}", path.display());
        Ok(Expected {
            name: fields[0].to_owned(),
            distinct: fields[5].parse().with_context(|| format!("distinct of {}", fields[0]))?,
            structure: fields[6].to_owned(),
            real: fields[8].parse().ok(),
            component: fields[7] != "0",
        })
    };
    table.lines().skip(1).map(row).collect()
}

fn one(name: &str, system: &System, seed: u64) -> Result<Row> {
    let mut options = SolveOptions::default();
    options.seed = seed;
    let started = Instant::now();
    let found = solve(system, &options)?;
    let seconds = started.elapsed().as_secs_f64();
    let regular: Vec<Vec<Complex64>> = found.nonsingular().map(|s| s.value.clone()).collect();
    Ok(Row {
        name: name.to_owned(),
        seed,
        distinct: found.solutions.len(),
        structure: structure(&found),
        real: found.n_real(),
        on_components: found.on_components,
        lost: found.paths.failed,
        retracked: found.paths.retracked,
        start_systems: found.start_systems,
        regular: regular.len(),
        certified: certify(system, &[], &regular, &CertifyOptions::default())?.n_distinct(),
        seconds,
    })
}

/// Number of solutions of each multiplicity, such as `16x1 1x11`.
pub(crate) fn structure(found: &Solutions) -> String {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    for solution in &found.solutions {
        *counts.entry(solution.multiplicity).or_default() += 1;
    }
    counts.iter().map(|(m, count)| format!("{count}x{m}")).collect::<Vec<_>>().join(" ")
}
