//! The tables in results/: CSV without quotes, read as text so that the page shows the figures as
//! they stand; and the lines of its Markdown tables.

use anyhow::{Context, Result, ensure};
use std::path::Path;

/// A table with a header.
pub(super) struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(super) fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
        let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let columns = lines.next().with_context(|| format!("{} is empty", path.display()))?;
        let rows: Vec<Vec<String>> = lines.collect();
        let whole = rows.iter().all(|row| row.len() == columns.len());
        ensure!(whole, "{}: a row has another number of cells than the header", path.display());
        Ok(Table { columns, rows })
    }

    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|cells| Row { columns: &self.columns, cells })
    }
}

/// A line of a table.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    columns: &'a [String],
    cells: &'a [String],
}

impl<'a> Row<'a> {
    /// The cell in the column of this name.
    pub(super) fn get(&self, column: &str) -> Result<&'a str> {
        let at = self.columns.iter().position(|name| name == column);
        Ok(&self.cells[at.with_context(|| format!("no column {column}"))?])
    }

    pub(super) fn number(&self, column: &str) -> Result<f64> {
        let cell = self.get(column)?;
        cell.parse().with_context(|| format!("{column}: {cell:?} is no number"))
    }

    /// A share as per cent with one digit; a dash for an empty cell.
    pub(super) fn percent(&self, column: &str) -> Result<String> {
        if self.get(column)?.is_empty() {
            return Ok("-".into());
        }
        Ok(format!("{:.1} %", 100.0 * self.number(column)?))
    }

    /// Whether these columns have these cells.
    pub(super) fn is(&self, wanted: &[(&str, &str)]) -> bool {
        wanted.iter().all(|(column, cell)| self.get(column).is_ok_and(|found| found == *cell))
    }
}

/// What run.csv says of a run: item and value, where values may have commas.
pub(super) fn record(path: &Path) -> Result<Vec<(String, String)>> {
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    let pairs = text.lines().skip(1).filter_map(|line| line.split_once(','));
    Ok(pairs.map(|(item, value)| (item.to_owned(), value.to_owned())).collect())
}

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
