//! Tables of a sweep, as CSV.

use super::swept::Swept;
use std::fmt::Write;

/// A line for each cell.
pub(super) fn cells(swept: &Swept<'_>) -> String {
    let Swept { grid, sweep, .. } = swept;
    let mut text = heading(swept, &["real", "positive", "complex", "at_infinity", "standing", "reason"]);
    for (k, cell) in sweep.cells.iter().enumerate() {
        values(&mut text, &grid.values(k));
        let doubt = cell.standing.doubt().map(|doubt| field(&doubt.to_string())).unwrap_or_default();
        let (real, positive, name) = (cell.real(), cell.positive(), cell.standing.name());
        // Writing to a string does not fail.
        let _ = writeln!(text, "{real},{positive},{},{},{name},{doubt}", cell.complex, cell.at_infinity);
    }
    text
}

/// A line for each real solution of each cell; the branch of a multiple solution is empty.
pub(super) fn branches(swept: &Swept<'_>) -> String {
    let Swept { family, grid, sweep, .. } = swept;
    let unknowns: Vec<&str> = family.system().variables().iter().map(String::as_str).collect();
    let mut text = heading(swept, &[&["branch", "multiplicity"], &unknowns[..]].concat());
    for (k, cell) in sweep.cells.iter().enumerate() {
        let at = grid.values(k);
        for solution in &cell.solutions {
            values(&mut text, &at);
            let branch = solution.branch.map(|branch| branch.to_string()).unwrap_or_default();
            let _ = write!(text, "{branch},{}", solution.multiplicity);
            for x in &solution.value {
                let _ = write!(text, ",{x}");
            }
            text.push('\n');
        }
    }
    text
}

/// The names of the columns: those of the axes, and these.
fn heading(swept: &Swept<'_>, more: &[&str]) -> String {
    let axes = swept.grid.axes().iter().map(|axis| axis.parameter.as_str());
    axes.chain(more.iter().copied()).map(field).collect::<Vec<_>>().join(",") + "\n"
}

fn values(text: &mut String, values: &[f64]) {
    for value in values {
        let _ = write!(text, "{value},");
    }
}

/// A field, in quotes where it has a comma or a quote.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}
