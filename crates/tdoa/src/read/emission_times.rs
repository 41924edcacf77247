//! Times at which transmitters send: `transmitter,time`, with or without a header.

use std::io::Read;
use std::path::Path;

use super::cells::Table;
use super::error::ReadError;
use super::numbers::{Numbers, number, shorten};
use super::source::{open, text};
use super::times::Moment;
use super::units::Units;
use crate::clocks::Emissions;
use crate::degeneracy::list;
use crate::pseudoranges::Pseudoranges;

/// Reads when each of the transmitters of a table sends, in these units, as metres: numbers, or moments as ISO 8601 writes them.
/// Where [`Emissions::Known`] says that they are times by the receivers' clock, moments count from where those of the table do.
///
/// # Errors
/// A file that cannot be read, lines without a name and a time, a transmitter that is given twice or is none of these,
/// transmitters that are not there, and moments beside numbers of a table whose clock is theirs.
pub fn read_emission_times(
    path: &Path,
    measured: &Pseudoranges,
    units: Units,
    emissions: Emissions,
) -> Result<Vec<f64>, ReadError> {
    let file = path.display().to_string();
    read_emission_times_from(open(path, &file)?, &file, measured, units, emissions)
}

/// Reads times as [`read_emission_times`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read_emission_times`].
pub fn read_emission_times_from(
    source: impl Read,
    file: &str,
    measured: &Pseudoranges,
    units: Units,
    emissions: Emissions,
) -> Result<Vec<f64>, ReadError> {
    let text = text(source, file)?;
    let (names, factor) = (measured.transmitter_names(), units.factor()?);
    let mut times = vec![None; names.len()];
    let is_one_clock = emissions == Emissions::Known;
    let mut numbers = if is_one_clock { Numbers::since(measured.origin()) } else { Numbers::default() };
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
        if index == 0 && number(time).is_none() && Moment::parse(time).is_none() {
            continue;
        }
        let Some(place) = names.iter().position(|other| other == name) else {
            return Err(bad(format!("no transmitter is named {:?}; the first is {:?}", shorten(name), names.first())));
        };
        let no_time = |remedy: String| bad(format!("{:?} is not a time; {remedy}", shorten(time)));
        let time = factor * numbers.measurement(time, units).map_err(no_time)?;
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
    use crate::read::{Units, read_from};
    use crate::{Emissions, Pseudoranges};
    use std::path::Path;

    #[test]
    fn times_are_in_the_order_of_the_transmitters() {
        let measured = Pseudoranges::new(1, 2, vec![0.0; 2]).unwrap();
        let read = |text: &str| {
            let units = Units::Milliseconds { speed: 340.0 };
            read_emission_times_from(text.as_bytes(), "t.csv", &measured, units, Emissions::Known)
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

    #[test]
    fn moments_count_from_where_those_of_the_table_do() {
        let seconds = Units::Seconds { speed: 343.0 };
        let table = |text: &str| read_from(text.as_bytes(), Path::new("t.csv"), seconds).unwrap();
        let moments = table("receiver,s1,s2\nA,2024-05-12T05:30:35.5Z,2024-05-12T05:31:00Z\n");
        let numbers = table("receiver,s1,s2\nA,0.5,25\n");
        let read = |text: &str, measured, emissions| {
            let read = read_emission_times_from(text.as_bytes(), "t.csv", measured, seconds, emissions);
            read.map_err(|error| error.to_string())
        };
        // Sent half a second before they arrive, each.
        let sent = "s1,2024-05-12T07:30:35+02:00\ns2,2024-05-12T05:30:59.5Z\n";
        for (j, time) in read(sent, &moments, Emissions::Known).unwrap().into_iter().enumerate() {
            assert!((moments.get(0, j).unwrap() - time - 0.5 * 343.0).abs() < 1e-9);
        }
        // By a clock of their own they may be written otherwise.
        assert_eq!(read(sent, &numbers, Emissions::Constant).unwrap(), [0.0, 24.5 * 343.0]);
        assert_eq!(read("s1,0\ns2,24.5\n", &moments, Emissions::Constant).unwrap(), [0.0, 24.5 * 343.0]);
        for (text, measured) in
            [(sent, &numbers), ("s1,0\ns2,24.5\n", &moments), ("s1,05:30:35\ns2,05:30:36\n", &moments)]
        {
            let said = read(text, measured, Emissions::Known).unwrap_err();
            assert!(said.contains("write all in one form"), "{said}");
        }
    }
}
