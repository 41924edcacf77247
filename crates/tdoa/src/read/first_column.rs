//! What the first column of a matrix holds, names of the rows or measurements, and whether a table is
//! a matrix at all.

use std::collections::HashSet;

use super::grid::Grid;
use super::heading::Heading;
use super::heading::quoted;
use super::numbers::{is_value, number};

/// What the first column holds.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Meaning {
    /// Names, or numbers that stand for names.
    Names,
    /// Measurements.
    Values,
}

/// Fewer rows than this are no network, and say nothing.
const FEW: usize = 4;

/// What the first column holds.
///
/// # Errors
/// What to do where this cannot be told.
pub(super) fn meaning(grid: &Grid) -> Result<Meaning, String> {
    if grid.width == 1 {
        return Ok(Meaning::Values);
    }
    let filled: Vec<&String> = grid.first.iter().filter(|cell| !cell.is_empty()).collect();
    let column = Column::of(&filled);
    let rows = filled.len();
    let has_decimals = grid.rest.iter().any(|value| !value.is_nan() && value.fract() != 0.0);
    let Some(header) = &grid.header else {
        let are_names = !filled.is_empty() && filled.iter().all(|cell| !is_value(cell));
        let are_ids = column.is_whole && rows >= FEW && (has_decimals || column.counts);
        return Ok(if are_names || are_ids { Meaning::Names } else { Meaning::Values });
    };
    let heading = Heading::new(&header[0]);
    if grid.is_short || filled.iter().any(|cell| !is_value(cell)) || heading.heads_receivers() {
        return Ok(Meaning::Names);
    }
    // `clap1` before `clap2` is a transmitter.
    if !column.is_whole || is_series(&header.iter().collect::<Vec<_>>()) {
        return Ok(Meaning::Values);
    }
    let others: Vec<&String> = header[1..].iter().filter(|cell| !cell.is_empty()).collect();
    let is_sure = (rows >= 3 && (has_decimals || column.is_run)) || (others.len() > 1 && is_series(&others));
    let (name, said) = (&header[0], quoted(&header[0]));
    if heading.heads_measurements() {
        return if is_sure && rows >= FEW {
            Err(format!(
                "the column {name:?} has different whole numbers, as rows are numbered, but is headed like measurements; leave it out \
                 (--columns ignore={said}), or say that it names the receivers (--columns receiver={said})"
            ))
        } else {
            Ok(Meaning::Values)
        };
    }
    if is_sure {
        return Ok(Meaning::Names);
    }
    if rows < FEW {
        return Ok(Meaning::Values);
    }
    Err(format!(
        "the first column, {name:?}, may name the receivers or be a transmitter, since all numbers are whole; give --columns \
         receiver={said} if it names them, otherwise put a column with their names before it, headed \"receiver\""
    ))
}

/// What the numbers of a column are.
struct Column {
    /// Whether they are whole, not negative and different.
    is_whole: bool,
    /// Whether they are, in some order, one after the other.
    is_run: bool,
    /// Whether they are 0, 1, 2, ... or 1, 2, 3, ...
    counts: bool,
}

impl Column {
    fn of(cells: &[&String]) -> Column {
        let values: Vec<f64> = cells.iter().filter_map(|cell| number(cell)).collect();
        let whole = |value: &f64| *value >= 0.0 && value.fract() == 0.0;
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let is_whole = values.len() == cells.len()
            && values.len() > 1
            && values.iter().all(whole)
            && sorted.windows(2).all(|pair| pair[0] < pair[1]);
        let is_run = is_whole && sorted.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
        let counts = is_run && values == sorted && values[0] <= 1.0;
        Column { is_whole, is_run, counts }
    }
}

/// Whether headings are one word with numbers behind it, or numbers alone.
fn is_series(cells: &[&String]) -> bool {
    let stem = |cell: &&String| {
        let stem = cell.trim_end_matches(|c: char| c.is_ascii_digit());
        (stem.len() < cell.len()).then(|| stem.to_string())
    };
    let stems: Option<HashSet<String>> = cells.iter().map(stem).collect();
    stems.is_some_and(|stems| stems.len() == 1)
}

/// What to do where a table seems to be a list of one measurement a line whose first line does not say
/// so: two columns of labels that come again and again, but no two of them together, and many rows.
pub(super) fn list_in(grid: &Grid) -> Option<String> {
    let (rows, width) = (grid.rows(), grid.width);
    if !(3..=8).contains(&width) || rows < 12 || rows < 3 * width {
        return None;
    }
    let label = |i: usize, k: usize| -> Option<String> {
        if k == 0 {
            let cell = &grid.first[i];
            let is_label = number(cell).is_none_or(|value| value.fract() == 0.0);
            return (is_label && !cell.is_empty()).then(|| cell.clone());
        }
        let value = grid.rest[i * (width - 1) + k - 1];
        (value >= 0.0 && value.fract() == 0.0).then(|| value.to_string())
    };
    let labels: Vec<(usize, Vec<String>)> = (0..width)
        .filter_map(|k| Some((k, (0..rows).map(|i| label(i, k)).collect::<Option<Vec<String>>>()?)))
        .filter(|(_, all)| {
            let different = all.iter().collect::<HashSet<_>>().len();
            different > 1 && 2 * different <= rows
        })
        .collect();
    for (a, first) in &labels {
        for (b, second) in labels.iter().filter(|(b, _)| b > a) {
            let pairs: HashSet<(&String, &String)> = first.iter().zip(second).collect();
            let value = (0..width).find(|k| k != a && k != b && labels.iter().all(|(label, _)| label != k));
            let (true, Some(value)) = (pairs.len() == rows, value) else { continue };
            let problem = "the table seems to be a list of measurements, one a line, not a matrix";
            return Some(match &grid.header {
                Some(header) => format!(
                    "{problem}; say which columns hold what, such as --columns receiver={},transmitter={},value={} (or time=...)",
                    quoted(&header[*a]),
                    quoted(&header[*b]),
                    quoted(&header[value])
                ),
                None => format!(
                    "{problem}; give it a first line that says what its columns hold, such as receiver,transmitter,value"
                ),
            });
        }
    }
    None
}
