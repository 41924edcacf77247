//! The CSV matrix: receivers in rows, transmitters in columns, with or without names.

use super::cells::{Decimals, Record, number, records, shorten};
use super::error::{ACCEPTED, ReadError};
use super::heading::{Heading, check_matrix, list_columns};
use super::list::list;
use super::units::Units;
use crate::pseudoranges::{MAX_CELLS, Pseudoranges};

/// Reads a matrix, or a list if the first line is that of one.
pub(super) fn parse(text: &str, file: &str, units: Option<Units>) -> Result<Pseudoranges, ReadError> {
    let factor = units.unwrap_or_default().factor()?;
    let mut records = records(text, file);
    let empty = || ReadError::Empty { file: file.to_string() };
    let first = records.next().ok_or_else(empty)??;
    if only_names(&first.cells)
        && let Some(columns) = list_columns(&first.cells, file, first.line, units)?
    {
        return list(records, &columns, file, factor);
    }
    let second = records.next().transpose()?;
    let shape = Shape::of(&first.cells, second.as_ref().map(|record| record.cells.as_slice()));
    let header = first.line;
    let has_corner = shape.corner;
    let (above, first) = if shape.transmitters.is_some() { (first.cells, None) } else { (Vec::new(), Some(Ok(first))) };
    let rows = first.into_iter().chain(second.map(Ok)).chain(records);
    let measured = matrix(rows, shape, header, file, factor)?;
    let names = if measured.receivers_named() { measured.receiver_names() } else { &[] };
    check_matrix(&above, has_corner, names, file, header, units)?;
    Ok(measured)
}

/// A line without any number is a header; one with both numbers and text may be a row with a
/// mistake in it.
fn only_names(cells: &[String]) -> bool {
    cells.iter().all(|c| number(c).is_none_or(f64::is_nan)) && cells.iter().any(|c| number(c).is_none())
}

/// What the first two lines say of a matrix.
struct Shape {
    /// Names of the transmitters, if the first line has them.
    transmitters: Option<Vec<String>>,
    /// Whether rows begin with names.
    named: bool,
    /// Whether the first line has a cell above these.
    corner: bool,
}

impl Shape {
    fn of(first: &[String], second: Option<&[String]>) -> Shape {
        let begins_with_name = |cells: &[String]| match cells {
            [name, values @ ..] => {
                number(name).is_none() && !values.is_empty() && values.iter().all(|cell| number(cell).is_some())
            }
            [] => false,
        };
        let is_header = only_names(first) || (counts(first) && is_row_of_counted(first, second));
        if !is_header {
            let named = begins_with_name(first) && second.is_none_or(begins_with_name);
            return Shape { transmitters: None, named, corner: false };
        }
        let mut names = first.to_vec();
        // What follows a comma at the end of each line is no column.
        while names.len() > 1 && names.last().is_some_and(String::is_empty) {
            names.pop();
        }
        // Rows may have one cell more than the first line, their name.
        let corner = second.is_none_or(|cells| !begins_with_name(cells) || cells.len() != first.len() + 1);
        let heading = Heading::new(&first[0]);
        let named = !corner || (names.len() > 1 && (heading.heads_receivers() || second.is_some_and(begins_with_name)));
        let skip = usize::from(named && corner);
        let numbered = |(k, name): (usize, &String)| if name.is_empty() { format!("s{}", k + 1) } else { name.clone() };
        let transmitters = names[skip..].iter().enumerate().map(numbered).collect();
        Shape { transmitters: Some(transmitters), named, corner: named && corner }
    }
}

/// Whether a line is a corner and the numbers 0, 1, 2, ... or 1, 2, 3, ... of columns.
fn counts(cells: &[String]) -> bool {
    let [corner, numbers @ ..] = cells else { return false };
    let counted = |first: usize| numbers.iter().enumerate().all(|(k, cell)| *cell == (first + k).to_string());
    let heading = Heading::new(corner);
    let heads_rows = heading.heads_receivers() || heading.heads_transmitters();
    let is_corner = corner.is_empty() || (number(corner).is_none() && heads_rows);
    is_corner && numbers.len() > 1 && (counted(0) || counted(1))
}

/// Whether numbers of columns and the next line belong together: below an empty corner stands a
/// name, or the first of the numbers.
fn is_row_of_counted(first: &[String], second: Option<&[String]>) -> bool {
    let below = second.and_then(<[String]>::first);
    !first[0].is_empty() || below.is_some_and(|cell| number(cell).is_none() || Some(cell) == first.get(1))
}

fn matrix(
    rows: impl Iterator<Item = Result<Record, ReadError>>,
    shape: Shape,
    header: u64,
    file: &str,
    factor: f64,
) -> Result<Pseudoranges, ReadError> {
    let Shape { transmitters, named, .. } = shape;
    let skip = usize::from(named);
    let mut receivers: Vec<String> = Vec::new();
    let mut values = Vec::new();
    let mut width = transmitters.as_ref().map(Vec::len);
    let mut decimals = Decimals::default();
    for record in rows {
        let record = record?;
        if named && record.is_blank() {
            continue;
        }
        let Record { line, cells } = record;
        let counted = format!("r{}", receivers.len() + 1);
        let receiver = if named { cells.first().cloned().unwrap_or_default() } else { counted };
        if receiver.is_empty() {
            let problem =
                "the row has no name, but other rows begin with the name of a receiver; give it one".to_string();
            return Err(ReadError::Line { file: file.to_string(), line, problem });
        }
        let mut cells = &cells[skip.min(cells.len())..];
        let expected = *width.get_or_insert(cells.len());
        if transmitters.is_some() && cells.len() > expected && cells[expected..].iter().all(String::is_empty) {
            cells = &cells[..expected];
        }
        if cells.len() != expected {
            return Err(ReadError::Ragged { file: file.to_string(), line, receiver, expected, found: cells.len() });
        }
        if values.len() + cells.len() > MAX_CELLS {
            return Err(ReadError::TooManyCells { file: file.to_string(), line });
        }
        for (j, cell) in cells.iter().enumerate() {
            let value = decimals.number(cell).map_err(|remedy| {
                let transmitter = transmitters.as_ref().map_or_else(|| format!("s{}", j + 1), |names| names[j].clone());
                let is_list = receivers.is_empty() && transmitters.is_some();
                ReadError::NotANumber {
                    file: file.to_string(),
                    line,
                    column: j + 1 + skip,
                    place: format!("receiver {receiver}, transmitter {transmitter}"),
                    text: shorten(cell),
                    remedy: if is_list {
                        format!("{remedy}; line {header} was taken for names: {ACCEPTED}")
                    } else {
                        remedy
                    },
                }
            })?;
            values.push(value * factor);
        }
        receivers.push(receiver);
    }
    if values.is_empty() {
        return Err(ReadError::Empty { file: file.to_string() });
    }
    let wrap = |source| ReadError::Matrix { file: file.to_string(), source };
    let mut measured = Pseudoranges::new(receivers.len(), width.unwrap_or(0), values).map_err(wrap)?;
    if let Some(names) = transmitters {
        measured = measured.with_transmitter_names(names).map_err(wrap)?;
    }
    if named {
        measured = measured.with_receiver_names(receivers).map_err(wrap)?;
    }
    Ok(measured)
}
