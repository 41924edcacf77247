//! The file of a table, to which rows are added.

use cli::bar::Bar;
use cli::{Failure, output};
use std::collections::{HashMap, HashSet};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;

/// The finished table: names of the columns, and cells as text.
pub(super) struct Rows {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Rows {
    /// The numbers of a column in some rows: `true` is 1, `false` 0, an empty cell not a number.
    ///
    /// # Panics
    /// If there is no such column.
    pub(super) fn numbers(&self, column: &str, rows: std::ops::Range<usize>) -> Vec<f64> {
        let at = self.columns.iter().position(|name| name == column).expect("a column of the table's header");
        let number = |cell: &str| match cell {
            "true" => 1.0,
            "false" => 0.0,
            other => other.parse().unwrap_or(f64::NAN),
        };
        self.rows[rows].iter().map(|row| number(&row[at])).collect()
    }
}

/// The file of a table while rows are added.
pub(super) struct Book<'a> {
    path: &'a Path,
    header: &'a str,
    keys: &'a [String],
    /// Whole lines that were in the file before.
    known: Vec<String>,
    file: File,
    /// Rows that were added, by the number of their key.
    fresh: HashMap<usize, String>,
    /// Why no more are added.
    failure: Option<Failure>,
    bar: Bar,
}

impl<'a> Book<'a> {
    /// Opens the file of the table with these columns and keys, or begins it.
    ///
    /// # Errors
    /// If it is another table, or cannot be read or written.
    pub(super) fn open(path: &'a Path, header: &'a str, keys: &'a [String]) -> Result<Book<'a>, Failure> {
        let failed = |error: std::io::Error| Failure::Unusable(format!("{}: {error}", path.display()));
        let known = match std::fs::read_to_string(path) {
            Ok(text) => parse(&text, header, path)?,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(failed(error)),
        };
        // Dropping half a line is all that a stopped run needs; writing the whole table anew does it.
        output::write(path, join(header, known.iter().map(String::as_str)).as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(failed)?;
        let (fresh, failure, bar) = (HashMap::new(), None, Bar::counted(0));
        let mut book = Book { path, header, keys, known, file, fresh, failure, bar };
        book.bar = Bar::counted(book.missing().len() as u64);
        Ok(book)
    }

    /// The rows that were in the file, by their keys.
    fn done(&self) -> HashMap<&str, &str> {
        let width = self.width();
        self.known.iter().map(|line| (key_of(line, width), line.as_str())).collect()
    }

    /// Columns of a key.
    fn width(&self) -> usize {
        self.keys.first().map_or(0, |key| key.split(',').count())
    }

    /// Numbers of the rows that were not in the file.
    pub(super) fn missing(&self) -> Vec<usize> {
        let (done, keys) = (self.done(), self.keys);
        (0..keys.len()).filter(|&k| !done.contains_key(keys[k].as_str())).collect()
    }

    /// Adds a row, or notes why there can be no more.
    pub(super) fn enter(&mut self, k: usize, row: Result<String, Failure>) -> ControlFlow<()> {
        let entered = row.and_then(|row| {
            let line = format!("{},{row}", self.keys[k]);
            // One call, so that a stop leaves whole lines or the beginning of one.
            let written = self.file.write_all(format!("{line}\n").as_bytes());
            written.map_err(|error| Failure::Unusable(format!("{}: {error}", self.path.display())))?;
            Ok(line)
        });
        match entered {
            Ok(line) => {
                self.fresh.insert(k, line);
                self.bar.inc(1);
                ControlFlow::Continue(())
            }
            Err(failure) => {
                self.failure.get_or_insert(failure);
                ControlFlow::Break(())
            }
        }
    }

    /// The finished table, whose file is put into the order of the keys.
    pub(super) fn close(mut self) -> Result<Rows, Failure> {
        self.bar.finish_and_clear();
        if let Some(failure) = self.failure.take() {
            return Err(failure);
        }
        let Book { path, header, keys, .. } = self;
        let (done, width) = (self.done(), self.width());
        let row = |k: usize| self.fresh.get(&k).map(String::as_str).or_else(|| done.get(keys[k].as_str()).copied());
        let wanted: Option<Vec<&str>> = (0..keys.len()).map(row).collect();
        let Some(wanted) = wanted else { return Err(Failure::Interrupted) };
        // Rows of other keys, of a run with more networks, stay for another day.
        let asked: HashSet<&str> = keys.iter().map(String::as_str).collect();
        let others = self.known.iter().map(String::as_str).filter(|line| !asked.contains(key_of(line, width)));
        output::write(path, join(header, wanted.iter().copied().chain(others)).as_bytes())?;
        let cells = |line: &str| line.split(',').map(str::to_owned).collect();
        Ok(Rows { columns: cells(header), rows: wanted.into_iter().map(cells).collect() })
    }
}

/// The whole lines of a table below its header.
fn parse(text: &str, header: &str, path: &Path) -> Result<Vec<String>, Failure> {
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let mut lines = whole.lines();
    match lines.next() {
        None => Ok(Vec::new()),
        Some(first) if first == header => {
            let columns = header.split(',').count();
            Ok(lines.filter(|line| line.split(',').count() == columns).map(str::to_owned).collect())
        }
        Some(_) => Err(Failure::Unusable(format!(
            "{}: has other columns than this experiment; remove it or choose another --output",
            path.display()
        ))),
    }
}

/// The first columns of a line.
fn key_of(line: &str, width: usize) -> &str {
    let end = line.match_indices(',').nth(width.saturating_sub(1)).map_or(line.len(), |(at, _)| at);
    &line[..end]
}

fn join<'a>(header: &str, lines: impl Iterator<Item = &'a str>) -> String {
    let mut text = format!("{header}\n");
    for line in lines {
        text += line;
        text.push('\n');
    }
    text
}
