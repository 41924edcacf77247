//! The cells of a matrix: its first line, the cells of its first column, and numbers.

use super::cells::Record;
use super::columns::refuse_others;
use super::error::{ACCEPTED, ReadError};
use super::heading::Heading;
use super::numbers::{Numbers, is_missing, is_value, is_whole, number, shorten};
use super::units::Units;
use crate::pseudoranges::MAX_CELLS;

/// A matrix whose first column may be names or measurements.
pub(super) struct Grid {
    /// The first line, if it has names; the first cell is that over the first column.
    pub(super) header: Option<Vec<String>>,
    /// Where the table begins.
    pub(super) line: u64,
    /// The columns.
    pub(super) width: usize,
    /// The first cell of each row.
    pub(super) first: Vec<String>,
    /// The line of each row.
    pub(super) lines: Vec<u64>,
    /// The numbers of the other columns, row by row.
    pub(super) rest: Vec<f64>,
    /// Whether all cells of a column are empty.
    pub(super) blank: Vec<bool>,
    /// Whether the first line has no cell over the first column, which has names then.
    pub(super) is_short: bool,
}

impl Grid {
    /// Reads the rows; of these columns, if some are chosen.
    pub(super) fn read(
        first: Record,
        mut records: impl Iterator<Item = Result<Record, ReadError>>,
        chosen: Option<&[usize]>,
        file: &str,
        numbers: &mut Numbers,
        units: Units,
    ) -> Result<Grid, ReadError> {
        let count = first.cells.len();
        let choose = |record: Record| match chosen {
            // Rows of another length are told by it.
            Some(chosen) if record.cells.len() == count => {
                let cells = chosen.iter().map(|&k| record.cells[k].clone()).collect();
                Record { line: record.line, cells }
            }
            _ => record,
        };
        let first = choose(first);
        let second = records.next().transpose()?.map(choose);
        let below = second.as_ref().map(|record| record.cells.as_slice());
        let header = is_header(&first.cells, below).then(|| first.cells.clone());
        let mut grid = Grid {
            line: first.line,
            width: 0,
            first: Vec::new(),
            lines: Vec::new(),
            rest: Vec::new(),
            blank: Vec::new(),
            is_short: false,
            header: None,
        };
        let leads = header.as_ref().is_some_and(|header| begins_empty(header, below));
        if let Some(mut names) = header {
            // What follows a comma at the end of each line is no column.
            let whole = names.len();
            while names.len() > 1 && names.last().is_some_and(String::is_empty) {
                names.pop();
            }
            grid.is_short = below.is_some_and(|cells| begins_with_name(cells) && cells.len() == whole + 1);
            if grid.is_short {
                names.insert(0, String::new());
            }
            if leads {
                names.remove(0);
            }
            refuse_others(&names, file, grid.line)?;
            grid.width = names.len();
            grid.header = Some(names);
        }
        let above = if grid.header.is_none() { Some(Ok(first)) } else { None };
        for record in above.into_iter().chain(second.map(Ok)).chain(records) {
            let mut record = choose(record?);
            if leads && record.cells.first().is_some_and(String::is_empty) {
                record.cells.remove(0);
            }
            grid.add(record, file, numbers, units)?;
        }
        Ok(grid)
    }

    /// The number of rows.
    pub(super) fn rows(&self) -> usize {
        self.first.len()
    }

    /// Adds a row.
    fn add(&mut self, record: Record, file: &str, numbers: &mut Numbers, units: Units) -> Result<(), ReadError> {
        let Record { line, mut cells } = record;
        if self.header.is_some() && cells.len() > self.width && cells[self.width..].iter().all(String::is_empty) {
            cells.truncate(self.width);
        }
        if self.rows() == 0 && self.header.is_none() {
            self.width = cells.len();
        }
        self.blank.resize(self.width, true);
        let starts = cells.first().is_some_and(|cell| !is_value(cell));
        let heads = self.header.as_ref().is_some_and(|header| Heading::new(&header[0]).heads_receivers());
        let is_named = self.width > 1 && (starts || heads || self.is_short);
        let receiver = match cells.first() {
            Some(name) if is_named => name.clone(),
            _ => format!("r{}", self.rows() + 1),
        };
        if cells.len() != self.width {
            if self.header.is_some() && cells.iter().all(String::is_empty) {
                return Ok(());
            }
            let skip = usize::from(is_named);
            let (expected, found) = (self.width - skip, cells.len().saturating_sub(skip));
            return Err(ReadError::Ragged { file: file.to_string(), line, receiver, expected, found });
        }
        if self.rest.len() + cells.len() > MAX_CELLS {
            return Err(ReadError::TooManyCells { file: file.to_string(), line });
        }
        for (k, cell) in cells.iter().enumerate() {
            self.blank[k] &= cell.is_empty();
            if k == 0 {
                continue;
            }
            let value = numbers.measurement(cell, units).map_err(|remedy| {
                // Where rows have no names, the first cell is the first that is wrong.
                let (k, cell, remedy) = match cells.first() {
                    Some(first) if starts && self.header.is_none() && self.first.iter().all(|cell| is_value(cell)) => {
                        (0, first, Numbers::default().number(first).err().unwrap_or(remedy))
                    }
                    _ => (k, cell, remedy),
                };
                let name = self.header.as_ref().map(|header| header[k].clone()).filter(|name| !name.is_empty());
                let transmitter = name.unwrap_or_else(|| format!("s{}", k + 1 - usize::from(is_named && k > 0)));
                let receiver = if k == 0 { format!("r{}", self.rows() + 1) } else { receiver.clone() };
                let is_list = self.rows() == 0 && self.header.is_some();
                ReadError::NotANumber {
                    file: file.to_string(),
                    line,
                    column: k + 1,
                    place: format!("receiver {receiver}, transmitter {transmitter}"),
                    text: shorten(cell),
                    remedy: if is_list {
                        format!("{remedy}; line {} was taken for names: {ACCEPTED}", self.line)
                    } else {
                        remedy
                    },
                }
            })?;
            self.rest.push(value);
        }
        self.first.push(cells.into_iter().next().unwrap_or_default());
        self.lines.push(line);
        Ok(())
    }

    /// Leaves out rows of nothing, as spreadsheets write them at the end.
    pub(super) fn drop_blank_rows(&mut self) {
        let width = self.width - 1;
        let is_blank =
            |i: usize| self.first[i].is_empty() && self.rest[i * width..(i + 1) * width].iter().all(|v| v.is_nan());
        let kept: Vec<usize> = (0..self.rows()).filter(|&i| !is_blank(i)).collect();
        if kept.len() == self.rows() {
            return;
        }
        self.rest = kept.iter().flat_map(|&i| self.rest[i * width..(i + 1) * width].to_vec()).collect();
        self.lines = kept.iter().map(|&i| self.lines[i]).collect();
        self.first = kept.iter().map(|&i| std::mem::take(&mut self.first[i])).collect();
    }
}

/// A line without any measurement is a header; one with both measurements and text may be a row with a
/// mistake in it.
pub(super) fn has_only_names(cells: &[String]) -> bool {
    cells.iter().all(|c| is_missing(c) || !is_value(c)) && cells.iter().any(|c| !is_value(c))
}

/// A name and measurements.
fn begins_with_name(cells: &[String]) -> bool {
    match cells {
        [name, values @ ..] => !is_value(name) && !values.is_empty() && values.iter().all(|cell| is_value(cell)),
        [] => false,
    }
}

/// Whether a first line has names, by what stands below it.
fn is_header(first: &[String], second: Option<&[String]>) -> bool {
    has_only_names(first) || (counts(first) && is_row_of_counted(first, second)) || numbers_columns(first, second)
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

/// Whether a line is a word and different whole numbers, and all numbers of the next line have
/// decimals.
fn numbers_columns(first: &[String], second: Option<&[String]>) -> bool {
    let (Some([word, numbers @ ..]), Some([_, below @ ..])) = (Some(first), second) else { return false };
    let mut sorted: Vec<&String> = numbers.iter().collect();
    sorted.sort();
    let different = sorted.windows(2).all(|pair| pair[0] != pair[1]);
    let has_decimals = |cell: &String| number(cell).is_some_and(|value| value.is_nan() || value.fract() != 0.0);
    let is_word = !word.is_empty() && !is_value(word);
    is_word
        && numbers.len() > 1
        && numbers.iter().all(|cell| is_whole(cell))
        && different
        && below.len() == numbers.len()
        && below.iter().all(has_decimals)
        && below.iter().any(|cell| !is_missing(cell))
}

/// Whether an empty column stands before that of the names.
fn begins_empty(header: &[String], second: Option<&[String]>) -> bool {
    let ([corner, next, ..], Some([below, name, ..])) = (header, second) else { return false };
    let heads = Heading::new(next).heads_receivers() && !next.is_empty();
    corner.is_empty() && below.is_empty() && header.len() > 2 && (heads || !is_value(name))
}
