//! Times at which transmitters send: `transmitter,time`, with or without a header.

use std::io::Read;
use std::path::Path;

use super::cells::Table;
use super::error::ReadError;
use super::numbers::{Numbers, number, shorten};
use super::source::{open, text};
use super::units::Units;
use crate::degeneracy::list;

/// Reads when each of the transmitters of these names sends, in these units, as metres.
///
/// # Errors
/// A file that cannot be read, lines without a name and a number, a transmitter that is given twice or is none of these, and
/// transmitters that are not there.
pub fn read_emission_times(path: &Path, names: &[String], units: Units) -> Result<Vec<f64>, ReadError> {
    let file = path.display().to_string();
    read_emission_times_from(open(path, &file)?, &file, names, units)
}

/// Reads times as [`read_emission_times`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read_emission_times`].
pub fn read_emission_times_from(
    source: impl Read,
    file: &str,
    names: &[String],
    units: Units,
) -> Result<Vec<f64>, ReadError> {
    let text = text(source, file)?;
    let mut times = vec![None; names.len()];
    let mut numbers = Numbers::default();
    let at = |line: u64, problem: String| ReadError::Line { file: file.to_string(), line, problem };
    let mut lines = 0;
    for (index, record) in Table::new(&text, file).records().enumerate() {
        let record = record?;
        lines = record.line;
        if record.is_blank() {
            continue;
        }
        let bad = |problem: String| at(record.line, problem);
        let [name, time, ..] = record.cells.as_slice() else {
            return Err(bad("needs the name of a transmitter and the time at which it sends".to_string()));
        };
        if index == 0 && number(time).is_none() {
            continue;
        }
        let Some(place) = names.iter().position(|other| other == name) else {
            return Err(bad(format!("no transmitter is named {:?}; the first is {:?}", shorten(name), names.first())));
        };
        let no_time = |remedy: String| bad(format!("{:?} is not a time; {remedy}", shorten(time)));
        let time = units.metres() * numbers.number(time).map_err(no_time)?;
        if !time.is_finite() {
            return Err(no_time("give a finite number".to_string()));
        }
        if times[place].replace(time).is_some() {
            return Err(bad(format!("{:?} is there twice", shorten(name))));
        }
    }
    let missing: Vec<String> =
        names.iter().zip(&times).filter(|(_, time)| time.is_none()).map(|(name, _)| name.clone()).collect();
    if !missing.is_empty() {
        return Err(at(
            lines.max(1),
            format!("has no time of {}; expected a line transmitter,time of each transmitter", list(&missing)),
        ));
    }
    Ok(times.into_iter().flatten().collect())
}

#[cfg(test)]
mod tests {
    use super::read_emission_times_from;
    use crate::read::Units;

    #[test]
    fn times_are_in_the_order_of_the_transmitters() {
        let names = ["s1", "s2"].map(str::to_string);
        let read = |text: &str| {
            read_emission_times_from(text.as_bytes(), "t.csv", &names, Units::Milliseconds { speed: 340.0 })
        };
        assert_eq!(read("transmitter,time\ns2,1e3\ns1,-2000\n").unwrap(), [-680.0, 340.0]);
        assert_eq!(read("s1,0,x\n\ns2,0\n").unwrap(), [0.0, 0.0]);
        for (text, part) in [
            ("s1,0\ns2,1\ns1,0\n", "line 3: \"s1\" is there twice"),
            ("s1,0\n", "has no time of s2"),
            ("s1,0\ns3,0\n", "no transmitter is named \"s3\""),
            ("s1,0\ns2,soon\n", "\"soon\" is not a time"),
            ("s1,0\ns2,inf\n", "is not a time"),
            ("s1\n", "needs the name"),
            ("", "has no time of s1"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
