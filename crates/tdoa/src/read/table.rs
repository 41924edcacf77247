//! The two CSV forms.

use std::collections::HashMap;

use super::ReadError;
use crate::pseudoranges::{MAX_CELLS, Pseudoranges};

/// One line of a table that is not empty.
pub(super) struct Record {
    pub(super) line: u64,
    pub(super) cells: Vec<String>,
}

/// Splits text into records, lazily: a bad line is reported before the rest is looked at.
pub(super) fn records<'a>(text: &'a str, file: &'a str) -> impl Iterator<Item = Result<Record, ReadError>> + 'a {
    let first = text.lines().find(|line| !line.trim().is_empty()).unwrap_or("");
    let delimiter = [b',', b';', b'\t'].into_iter().find(|&d| first.contains(d as char)).unwrap_or(b',');
    let reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    reader.into_records().map(move |record| {
        let record = record.map_err(|error| ReadError::Line {
            file: file.to_string(),
            line: error.position().map_or(1, csv::Position::line),
            problem: format!("cannot be read as CSV ({error})"),
        })?;
        let line = record.position().map_or(1, csv::Position::line);
        Ok(Record { line, cells: record.iter().map(str::to_string).collect() })
    })
}

/// A number, NaN for an empty cell or `nan`.
pub(super) fn number(cell: &str) -> Option<f64> {
    if cell.is_empty() || cell.eq_ignore_ascii_case("nan") || cell.eq_ignore_ascii_case("na") {
        return Some(f64::NAN);
    }
    cell.parse::<f64>().ok()
}

pub(super) fn parse(text: &str, file: &str, factor: f64) -> Result<Pseudoranges, ReadError> {
    let empty = || ReadError::Empty { file: file.to_string() };
    let mut records = records(text, file).peekable();
    let first = match records.peek() {
        None => return Err(empty()),
        Some(Ok(record)) => record,
        Some(Err(_)) => return records.next().map_or(Err(empty()), |r| r.and(Err(empty()))),
    };
    // A line without any number is a header; one with both numbers and text is a matrix row with a mistake in it.
    let is_header = first.cells.iter().all(|c| number(c).is_none_or(f64::is_nan))
        && first.cells.iter().any(|c| number(c).is_none());
    if !is_header {
        return matrix(records, None, file, factor);
    }
    let header: Vec<String> = first.cells.clone();
    records.next();
    match list_columns(&header) {
        Some(columns) => list(records, &columns, file, factor),
        None => matrix(records, Some(header), file, factor),
    }
}

fn matrix(
    records: impl Iterator<Item = Result<Record, ReadError>>,
    header: Option<Vec<String>>,
    file: &str,
    factor: f64,
) -> Result<Pseudoranges, ReadError> {
    let heads_names = |cell: &str| ["", "receiver", "receivers", "id", "name"].contains(&cell.to_lowercase().as_str());
    let named = header.as_ref().is_some_and(|h| h.len() > 1 && heads_names(&h[0]));
    let skip = usize::from(named);
    let transmitters = header.map(|h| h[skip..].to_vec());
    let mut receivers: Vec<String> = Vec::new();
    let mut values = Vec::new();
    let mut width = transmitters.as_ref().map(Vec::len);
    for record in records {
        let Record { line, cells } = record?;
        let counted = format!("r{}", receivers.len() + 1);
        let receiver = if named { cells.first().cloned().unwrap_or_default() } else { counted };
        let cells = &cells[skip.min(cells.len())..];
        let expected = *width.get_or_insert(cells.len());
        if cells.len() != expected {
            return Err(ReadError::Ragged { file: file.to_string(), line, receiver, expected, found: cells.len() });
        }
        if values.len() + cells.len() > MAX_CELLS {
            return Err(ReadError::TooManyCells { file: file.to_string(), line });
        }
        for (j, cell) in cells.iter().enumerate() {
            let transmitter = transmitters.as_ref().map_or_else(|| format!("s{}", j + 1), |names| names[j].clone());
            let value = number(cell).ok_or_else(|| ReadError::NotANumber {
                file: file.to_string(),
                line,
                column: j + 1 + skip,
                place: format!("receiver {receiver}, transmitter {transmitter}"),
                text: shorten(cell),
            })?;
            values.push(value * factor);
        }
        receivers.push(receiver);
    }
    if values.is_empty() {
        return Err(ReadError::Empty { file: file.to_string() });
    }
    let wrap = |source| ReadError::Matrix { file: file.to_string(), source };
    let measured = Pseudoranges::new(receivers.len(), width.unwrap_or(0), values).map_err(wrap)?;
    let transmitters = transmitters.unwrap_or_else(|| measured.transmitter_names().to_vec());
    measured.with_names(receivers, transmitters).map_err(wrap)
}

/// Where a list has its columns: receiver, transmitter, value, and sigma if there is one.
struct Columns {
    receiver: usize,
    transmitter: usize,
    value: usize,
    sigma: Option<usize>,
    count: usize,
}

fn list_columns(header: &[String]) -> Option<Columns> {
    let find = |names: &[&str]| header.iter().position(|cell| names.contains(&cell.to_lowercase().as_str()));
    Some(Columns {
        receiver: find(&["receiver"])?,
        transmitter: find(&["transmitter", "event"])?,
        value: find(&["value", "pseudorange", "time", "toa"])?,
        sigma: find(&["sigma", "std"]),
        count: header.len(),
    })
}

fn list(
    records: impl Iterator<Item = Result<Record, ReadError>>,
    columns: &Columns,
    file: &str,
    factor: f64,
) -> Result<Pseudoranges, ReadError> {
    let mut receivers = Names::default();
    let mut transmitters = Names::default();
    let mut entries: HashMap<(usize, usize), (f64, f64)> = HashMap::new();
    for record in records {
        let Record { line, cells } = record?;
        let bad = |problem: String| ReadError::Line { file: file.to_string(), line, problem };
        if cells.len() != columns.count {
            return Err(bad(format!("has {} cells where the header has {}", cells.len(), columns.count)));
        }
        let (receiver, transmitter) = (&cells[columns.receiver], &cells[columns.transmitter]);
        if receiver.is_empty() || transmitter.is_empty() {
            return Err(bad("names no receiver or no transmitter; both are needed".to_string()));
        }
        let read = |column: usize| {
            number(&cells[column]).ok_or_else(|| ReadError::NotANumber {
                file: file.to_string(),
                line,
                column: column + 1,
                place: format!("receiver {receiver}, transmitter {transmitter}"),
                text: shorten(&cells[column]),
            })
        };
        let value = read(columns.value)? * factor;
        let sigma = columns.sigma.map(read).transpose()?.map_or(1.0, |sigma| sigma * factor);
        let at = (receivers.index(receiver), transmitters.index(transmitter));
        if value.is_nan() {
            continue;
        }
        if entries.len() >= MAX_CELLS {
            return Err(ReadError::TooManyCells { file: file.to_string(), line });
        }
        if entries.insert(at, (value, sigma)).is_some() {
            return Err(bad(format!(
                "receiver {receiver}, transmitter {transmitter} is there twice; keep one measurement of each pair"
            )));
        }
    }
    if receivers.names.is_empty() {
        return Err(ReadError::Empty { file: file.to_string() });
    }
    let (m, n) = (receivers.names.len(), transmitters.names.len());
    let wrap = |source| ReadError::Matrix { file: file.to_string(), source };
    if m.checked_mul(n).is_none_or(|cells| cells > MAX_CELLS) {
        return Err(wrap(crate::PseudorangeError::TooLarge { receivers: m, transmitters: n }));
    }
    let (mut values, mut sigmas) = (vec![f64::NAN; m * n], vec![f64::NAN; m * n]);
    for ((i, j), (value, sigma)) in entries {
        values[i * n + j] = value;
        sigmas[i * n + j] = sigma;
    }
    let measured = Pseudoranges::new(m, n, values).map_err(wrap)?;
    let measured = measured.with_names(receivers.names, transmitters.names).map_err(wrap)?;
    if columns.sigma.is_some() { measured.with_sigmas(sigmas).map_err(wrap) } else { Ok(measured) }
}

/// Names in the order of their first appearance.
#[derive(Default)]
struct Names {
    names: Vec<String>,
    places: HashMap<String, usize>,
}

impl Names {
    fn index(&mut self, name: &str) -> usize {
        if let Some(&place) = self.places.get(name) {
            return place;
        }
        self.names.push(name.to_string());
        self.places.insert(name.to_string(), self.names.len() - 1);
        self.names.len() - 1
    }
}

/// The start of a cell, for messages.
pub(super) fn shorten(cell: &str) -> String {
    if cell.chars().count() <= 40 { cell.to_string() } else { cell.chars().take(40).chain("...".chars()).collect() }
}
