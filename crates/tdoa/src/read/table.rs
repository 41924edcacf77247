//! Tables as text: which form they have, and the matrix with receivers in rows and transmitters in
//! columns, with or without names.

use super::cells::{Separator, Table};
use super::columns::{given, list_columns};
use super::error::ReadError;
use super::first_column::{Meaning, list_in, meaning};
use super::grid::{Grid, has_only_names};
use super::heading::check_matrix;
use super::list::list;
use super::numbers::{Numbers, shorten};
use super::role::Role;
use super::thousands::refuse_thousands;
use super::units::{ReadOptions, Units};
use crate::pseudoranges::Pseudoranges;

/// Reads a matrix, or a list if the first line is that of one.
pub(super) fn parse(text: &str, file: &str, options: &ReadOptions) -> Result<Pseudoranges, ReadError> {
    let units = options.units.unwrap_or_default();
    units.factor()?;
    let table = Table::new(text, file);
    let numbers = Numbers::new(options.decimal_mark);
    let mut records = table.records();
    let first = records.next().ok_or_else(|| ReadError::Empty { file: file.to_string() })??;
    let said = given(&first.cells, options, file, first.line)?;
    if !options.transpose && has_only_names(&first.cells) {
        let columns = list_columns(&first.cells, &said, file, first.line, options)?;
        if let Some(columns) = columns {
            return list(records, &columns, numbers, table.separator, file, units);
        }
    }
    if options.candidates {
        let problem = "--candidates is for a list of one measurement a line; a matrix has one value a cell".to_string();
        return Err(ReadError::Columns { file: file.to_string(), line: first.line, problem });
    }
    // The column of names comes first, what is no measurement goes.
    let names_of = if options.transpose { Role::Transmitter } else { Role::Receiver };
    let named = said.iter().find(|(role, _)| *role == names_of).map(|(_, k)| *k);
    let other = said.iter().find(|(role, _)| *role != Role::Ignore && *role != names_of);
    if let Some((_, k)) = other {
        let problem =
            format!("the column {:?} cannot be chosen in a matrix, of which all columns are alike", first.cells[*k]);
        return Err(ReadError::Columns { file: file.to_string(), line: first.line, problem });
    }
    let is_kept = |k: &usize| Some(*k) != named && !said.contains(&(Role::Ignore, *k));
    let kept: Vec<usize> = named.into_iter().chain((0..first.cells.len()).filter(is_kept)).collect();
    let chosen = if said.is_empty() { None } else { Some(kept.as_slice()) };
    let mut matrix = Matrix { file, options, units, separator: table.separator, numbers, named: named.is_some() };
    let grid = Grid::read(first, records, chosen, file, &mut matrix.numbers, units)?;
    matrix.pseudoranges(grid)
}

/// A matrix that is read.
struct Matrix<'a> {
    file: &'a str,
    options: &'a ReadOptions,
    units: Units,
    separator: Separator,
    numbers: Numbers,
    /// Whether the options say which column has the names of the rows.
    named: bool,
}

impl Matrix<'_> {
    /// The measurements of a grid: its first column is found to be names or measurements, empty columns
    /// go, and what its names say of rows and columns is checked.
    fn pseudoranges(mut self, mut grid: Grid) -> Result<Pseudoranges, ReadError> {
        let (file, line) = (self.file, grid.line);
        if grid.rows() == 0 || grid.width == 0 {
            return Err(ReadError::Empty { file: file.to_string() });
        }
        let refused = |problem: String| ReadError::Columns { file: file.to_string(), line, problem };
        if let Some(problem) = list_in(&grid).filter(|_| !self.options.transpose) {
            return Err(refused(problem));
        }
        let meaning = if self.named { Meaning::Names } else { meaning(&grid).map_err(refused)? };
        let is_named = meaning == Meaning::Names;
        if is_named {
            grid.drop_blank_rows();
        }
        let rows = self.names_of_rows(&grid, is_named)?;
        let columns = Self::columns(&grid, is_named);
        let values = self.values(&grid, is_named, &columns)?;
        if values.is_empty() {
            return Err(ReadError::Empty { file: file.to_string() });
        }
        let wrap = |source| ReadError::Matrix { file: file.to_string(), source };
        let (m, n) = (grid.rows(), columns.len());
        let names = grid.header.as_ref().map(|header| names(header, &columns));
        let measured = if self.options.transpose {
            let cells = values.iter().enumerate().map(|(k, value)| (k % n, k / n, *value));
            let mut measured = Pseudoranges::from_cells(n, m, cells).map_err(wrap)?;
            if let Some(names) = names {
                measured = measured.with_receiver_names(names).map_err(wrap)?;
            }
            if is_named { measured.with_transmitter_names(rows.clone()).map_err(wrap)? } else { measured }
        } else {
            let mut measured = Pseudoranges::new(m, n, values).map_err(wrap)?;
            if let Some(names) = names {
                measured = measured.with_transmitter_names(names).map_err(wrap)?;
            }
            if is_named { measured.with_receiver_names(rows.clone()).map_err(wrap)? } else { measured }
        };
        if let Some(header) = &grid.header {
            let corner = is_named.then(|| header[0].clone());
            let above: Vec<String> = corner.into_iter().chain(columns.iter().map(|&k| header[k].clone())).collect();
            let place = (file, line);
            check_matrix(&above, is_named, &rows, self.options.transpose, place, self.options.units)?;
        } else {
            check_matrix(&[], false, &rows, self.options.transpose, (file, line), self.options.units)?;
        }
        refuse_thousands(&self.numbers, self.separator, self.units, &measured, file)?;
        let measured = measured.with_origin(self.numbers.origin());
        Ok(measured)
    }

    /// The names of the rows; none if they have none.
    fn names_of_rows(&self, grid: &Grid, is_named: bool) -> Result<Vec<String>, ReadError> {
        if !is_named {
            return Ok(Vec::new());
        }
        if let Some(k) = grid.first.iter().position(String::is_empty) {
            let problem =
                "the row has no name, but other rows begin with the name of a receiver; give it one".to_string();
            return Err(ReadError::Line { file: self.file.to_string(), line: grid.lines[k], problem });
        }
        Ok(grid.first.clone())
    }

    /// The columns of measurements: those that have a heading or anything below it.
    fn columns(grid: &Grid, is_named: bool) -> Vec<usize> {
        let is_there = |&k: &usize| grid.header.as_ref().is_none_or(|header| !(header[k].is_empty() && grid.blank[k]));
        (usize::from(is_named)..grid.width).filter(is_there).collect()
    }

    /// The measurements in metres, row by row.
    fn values(&mut self, grid: &Grid, is_named: bool, columns: &[usize]) -> Result<Vec<f64>, ReadError> {
        let factor = self.units.factor()?;
        let mut values = Vec::with_capacity(grid.rows() * columns.len());
        for i in 0..grid.rows() {
            for &k in columns {
                let value = if k == 0 && !is_named {
                    let cell = &grid.first[i];
                    self.numbers.measurement(cell, self.units).map_err(|remedy| ReadError::NotANumber {
                        file: self.file.to_string(),
                        line: grid.lines[i],
                        column: 1,
                        place: format!("receiver r{}, transmitter s1", i + 1),
                        text: shorten(cell),
                        remedy,
                    })?
                } else {
                    grid.rest[i * (grid.width - 1) + k - 1]
                };
                values.push(value * factor);
            }
        }
        Ok(values)
    }
}

/// The names of columns by their headings, or by their places where these are empty.
fn names(header: &[String], columns: &[usize]) -> Vec<String> {
    let name = |(place, &k): (usize, &usize)| {
        let counted = format!("s{}", place + 1);
        if !header[k].is_empty() {
            header[k].clone()
        } else if header.contains(&counted) {
            format!("column {}", k + 1)
        } else {
            counted
        }
    };
    columns.iter().enumerate().map(name).collect()
}
