//! Pieces of the page.

use super::super::table::Table;
use anyhow::Result;
use std::path::Path;

/// The sums of an experiment.
pub(super) fn summary(results: &Path, name: &str) -> Result<Table> {
    Table::read(&results.join(name).join("summary.csv"))
}

/// A line of a Markdown table.
pub(super) fn line(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

/// The head of a Markdown table.
pub(super) fn head(names: &[&str]) -> String {
    format!("| {} |\n|{}\n", names.join(" | "), "---|".repeat(names.len()))
}
