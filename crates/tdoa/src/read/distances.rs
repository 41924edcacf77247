//! Known distances between receivers: `receiver,receiver,distance[,sigma]`, with or without a header.

use std::io::Read;
use std::path::Path;

use super::cells::Table;
use super::error::ReadError;
use super::numbers::{Numbers, number, shorten};
use super::source::{open, text};
use crate::calibrate::KnownDistance;

/// Reads known distances in metres between receivers of these names, with their standard deviations as far as there is a
/// fourth column.
///
/// # Errors
/// A file that cannot be read, lines without two of the names and a number.
pub fn read_distances(path: &Path, names: &[String]) -> Result<Vec<KnownDistance>, ReadError> {
    let file = path.display().to_string();
    read_distances_from(open(path, &file)?, &file, names)
}

/// Reads distances as [`read_distances`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read_distances`].
pub fn read_distances_from(source: impl Read, file: &str, names: &[String]) -> Result<Vec<KnownDistance>, ReadError> {
    let text = text(source, file)?;
    let mut all = Vec::new();
    let mut numbers = Numbers::default();
    let table = Table::new(&text, file);
    for (index, record) in table.records().enumerate() {
        let record = record?;
        if record.is_blank() {
            continue;
        }
        let bad = |problem: String| ReadError::Line { file: file.to_string(), line: record.line, problem };
        let (a, b, length, sigma) = if let [a, b, length, rest @ ..] = record.cells.as_slice() {
            (a, b, length, rest.first().filter(|cell| !cell.is_empty()))
        } else {
            return Err(bad("needs two names of receivers and their distance in metres".to_string()));
        };
        if index == 0 && number(length).is_none() {
            continue;
        }
        let find = |name: &String| {
            let place = names.iter().position(|other| other == name);
            place.ok_or_else(|| {
                bad(format!("no receiver is named {:?}; the first is {:?}", shorten(name), names.first()))
            })
        };
        let no_distance = |remedy: String| bad(format!("{:?} is not a distance in metres; {remedy}", shorten(length)));
        let distance = numbers.number(length).map_err(no_distance)?;
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(no_distance("give a positive number".to_string()));
        }
        let sigma = sigma.map(|cell| match numbers.number(cell) {
            Ok(sigma) if sigma > 0.0 && sigma.is_finite() => Ok(sigma),
            _ => Err(bad(format!("{:?} is not a standard deviation in metres; give a positive number", shorten(cell)))),
        });
        all.push(KnownDistance { receivers: [find(a)?, find(b)?], distance, sigma: sigma.transpose()? });
    }
    if all.is_empty() {
        return Err(ReadError::Line {
            file: file.to_string(),
            line: 1,
            problem: "has no distances; expected lines receiver,receiver,distance,sigma".to_string(),
        });
    }
    Ok(all)
}
