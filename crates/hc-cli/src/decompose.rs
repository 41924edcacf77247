//! `hc decompose`.

use crate::{input, watch};
use cli::{Failure, output};
use hc::poly::counted;
use hc::witness::{Decomposition, decompose};
use hc::{SolveOptions, coordinates};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

/// Points of each component, and isolated solutions, that a summary shows.
const LISTED: usize = 10;

/// All solutions of a system, isolated ones and components of positive dimension with their degrees,
/// multiplicities and witness points.
///
/// Ten points of a component are shown; --json has all. Exit status 1 if something may be missing.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The system: plain text with one equation a line, PHCpack's format, or TOML; - for standard
    /// input.
    file: PathBuf,
    /// Write the result as JSON to this file, `-` for standard output.
    #[arg(long, value_name = "OUT")]
    json: Option<PathBuf>,
    /// Paths at most in all dimensions together; those that need more are not searched.
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    max_paths: u64,
    /// Seed of the hyperplanes and of the generic coefficients.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all processors by default. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
}

#[derive(Serialize)]
struct Output<'a> {
    variables: &'a [String],
    seed: u64,
    seconds: f64,
    #[serde(flatten)]
    found: &'a Decomposition,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let begun = Instant::now();
    let system = input::system(&arguments.file)?;
    let monitor = watch::interruptible()?;
    let options = SolveOptions::new().seed(arguments.seed).max_paths(arguments.max_paths);
    let found = watch::watched(arguments.threads, &monitor, watch::stages, || decompose(&system, &options, &monitor))?;
    let found = found.map_err(|error| Failure::in_file(&arguments.file, error))?;
    let seconds = begun.elapsed().as_secs_f64();
    output::summary(arguments.json.as_deref(), || summary(&found, system.variables(), seconds))?;
    if let Some(out) = &arguments.json {
        output::json(out, &Output { variables: system.variables(), seed: arguments.seed, seconds, found: &found })?;
    }
    if found.partial {
        return Err(Failure::Interrupted);
    }
    if found.failed > 0 {
        return Err(Failure::Undetermined(format!(
            "not accounted for: {} in number, of paths, witness points and dimensions",
            found.failed
        )));
    }
    if found.components.iter().any(|c| !c.irreducible) {
        return Err(Failure::Undetermined("some components are not shown to be irreducible".to_owned()));
    }
    Ok(())
}

/// In words: a line for each component, with its witness points below, and the isolated solutions.
fn summary(found: &Decomposition, unknowns: &[String], seconds: f64) -> String {
    let mut text = format!(
        "{} of positive dimension, {}, {seconds:.3} s\n",
        counted(found.components.len(), "component"),
        counted(found.isolated.len(), "isolated solution")
    );
    for component in &found.components {
        text += &format!("  dimension {}, degree {}", component.dimension, component.degree);
        if component.multiplicity > 1 {
            text += &format!(", multiplicity {}", component.multiplicity);
        }
        text += if component.irreducible { "\n" } else { ", perhaps several together\n" };
        text += &list(component.witness_points.iter().map(|point| coordinates(unknowns, point)), "witness point");
    }
    if !found.isolated.is_empty() {
        text += "  isolated\n";
        text += &list(found.isolated.iter().map(|solution| solution.row(unknowns)), "isolated solution");
    }
    for dimension in &found.unsearched {
        text +=
            &format!("dimension {dimension} was not searched: that takes more paths than are left of --max-paths\n");
    }
    let mut reasons: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for end in &found.unresolved {
        let (ends, paths) = reasons.entry(&end.reason).or_default();
        (*ends, *paths) = (*ends + 1, *paths + end.paths);
    }
    for (reason, (ends, paths)) in reasons {
        text += &format!("unresolved: {} of {}: {reason}\n", counted(ends, "end"), counted(paths, "path"));
    }
    text
}

/// The first of some rows, and how many more there are.
fn list(rows: impl ExactSizeIterator<Item = String>, noun: &str) -> String {
    let more = rows.len().saturating_sub(LISTED);
    let mut text: String = rows.take(LISTED).map(|row| format!("    {row}\n")).collect();
    if more > 0 {
        text += &format!("    and {} (--json has all)\n", counted(more, &format!("more {noun}")));
    }
    text
}
