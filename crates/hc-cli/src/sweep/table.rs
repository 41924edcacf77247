//! Tables of a sweep, as CSV.

use super::swept::Swept;

/// A line for each cell.
pub(super) fn cells(swept: &Swept<'_>) -> String {
    let Swept { grid, sweep, .. } = swept;
    let mut table = Table::new(swept, &["real", "positive", "complex", "at_infinity", "standing", "reason"]);
    for (k, cell) in sweep.cells.iter().enumerate() {
        let counts = [cell.real(), cell.positive(), cell.complex, cell.at_infinity].map(|count| count.to_string());
        let doubt = cell.standing.doubt().map(ToString::to_string).unwrap_or_default();
        let standing = [cell.standing.name().to_owned(), doubt];
        table.row(&grid.values(k), counts.into_iter().chain(standing));
    }
    table.finish()
}

/// A line for each real solution of each cell; the branch of a multiple solution is empty.
pub(super) fn branches(swept: &Swept<'_>) -> String {
    let Swept { family, grid, sweep, .. } = swept;
    let unknowns: Vec<&str> = family.system().variables().iter().map(String::as_str).collect();
    let mut table = Table::new(swept, &[&["branch", "multiplicity"], &unknowns[..]].concat());
    for (k, cell) in sweep.cells.iter().enumerate() {
        let at = grid.values(k);
        for solution in &cell.solutions {
            let branch = solution.branch.map(|branch| branch.to_string()).unwrap_or_default();
            let numbers = [branch, solution.multiplicity.to_string()];
            table.row(&at, numbers.into_iter().chain(solution.value.iter().map(f64::to_string)));
        }
    }
    table.finish()
}

/// A table whose first columns are the values on the axes.
struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn new(swept: &Swept<'_>, more: &[&str]) -> Table {
        let mut table = csv::Writer::from_writer(Vec::new());
        let axes = swept.grid.axes().iter().map(|axis| axis.parameter.as_str());
        // Writing to memory does not fail, and all rows are of one length.
        let _ = table.write_record(axes.chain(more.iter().copied()));
        Table(table)
    }

    fn row(&mut self, at: &[f64], cells: impl Iterator<Item = String>) {
        let _ = self.0.write_record(at.iter().map(f64::to_string).chain(cells));
    }

    fn finish(self) -> String {
        let bytes = self.0.into_inner().unwrap_or_default();
        // All that was written was text.
        String::from_utf8(bytes).unwrap_or_default()
    }
}
