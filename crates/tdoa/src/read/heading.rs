//! The first lines of tables: which column is which, and in what unit.

use super::error::ReadError;
use super::units::Units;

const RECEIVER: &[&str] = &["receiver", "mic", "microphone", "anchor", "sensor", "station", "rx"];
const TRANSMITTER: &[&str] = &["transmitter", "event", "source", "emitter", "sound", "tag", "tx"];
const LENGTH: &[&str] = &["value", "pseudorange", "range", "distance", "measurement"];
const TIME: &[&str] =
    &["time", "toa", "tdoa", "arrival", "arrival_time", "time_of_arrival", "timestamp", "sample", "seconds"];
const SIGMA: &[&str] = &["sigma", "std", "stddev", "std_dev", "standard_deviation"];
/// Columns that name nodes of either kind.
const NODE: &[&str] = &["name", "id", "node", "label"];

/// Spellings of units, and the unit they stand for.
const UNITS: &[(&str, &str)] = &[
    ("m", "m"),
    ("metre", "m"),
    ("metres", "m"),
    ("meter", "m"),
    ("meters", "m"),
    ("s", "s"),
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("ms", "ms"),
    ("msec", "ms"),
    ("milliseconds", "ms"),
    ("us", "us"),
    ("µs", "us"),
    ("μs", "us"),
    ("usec", "us"),
    ("microseconds", "us"),
    ("samples", "samples"),
    ("ns", "ns"),
    ("mm", "mm"),
    ("cm", "cm"),
    ("km", "km"),
];

/// A column's name in lower case, with single underscores between its words, and the unit behind
/// it, such as that of `Time (ms)` and `time_ms`.
pub(super) struct Heading {
    pub(super) name: String,
    pub(super) unit: Option<&'static str>,
}

impl Heading {
    pub(super) fn new(cell: &str) -> Heading {
        let lower = cell.to_lowercase();
        let words: Vec<&str> = lower.split(|c: char| !(c.is_alphanumeric())).filter(|word| !word.is_empty()).collect();
        let unit_of = |word: &str| UNITS.iter().find(|(spelling, _)| *spelling == word).map(|(_, unit)| *unit);
        let (words, unit) = match words.as_slice() {
            [before @ .., last] if !before.is_empty() => match unit_of(last) {
                Some(unit) => (before, Some(unit)),
                None => (words.as_slice(), None),
            },
            // Columns that are headed by a unit alone hold times.
            [only] if TIME.contains(only) || only.starts_with("sample") => (words.as_slice(), unit_of(only)),
            _ => (words.as_slice(), None),
        };
        Heading { name: words.join("_"), unit }
    }

    /// Whether this is one of some names, in the singular or plural, or the name or number of one.
    fn is(&self, names: &[&str]) -> bool {
        let name = self.name.as_str();
        let forms = ["_id", "_name", "_number", "_index", "s", "id", ""];
        forms.iter().filter_map(|form| name.strip_suffix(form)).any(|stem| names.contains(&stem))
    }

    /// Whether rows of a matrix begin with names below this.
    pub(super) fn heads_receivers(&self) -> bool {
        self.name.is_empty() || self.is(RECEIVER) || self.is(NODE)
    }

    /// Whether names of receivers stand below this in a table of positions.
    pub(super) fn heads_nodes(&self) -> bool {
        self.is(RECEIVER) || self.is(NODE)
    }

    /// Which coordinate stands below this, if one does: 0 for x, 1 for y, 2 for z.
    pub(super) fn coordinate(&self) -> Option<usize> {
        const NAMES: [&[&str]; 3] = [
            &["x", "pos_x", "x_pos", "position_x"],
            &["y", "pos_y", "y_pos", "position_y"],
            &["z", "pos_z", "z_pos", "position_z", "height", "altitude"],
        ];
        NAMES.iter().position(|names| names.contains(&self.name.as_str()))
    }
}

/// Where a list has its columns: receiver, transmitter, value, and sigma if there is one.
pub(super) struct Columns {
    pub(super) receiver: usize,
    pub(super) transmitter: usize,
    pub(super) value: usize,
    pub(super) sigma: Option<usize>,
    pub(super) count: usize,
}

/// The columns of a list; `None` if the first line is not that of a list.
pub(super) fn list_columns(
    cells: &[String],
    file: &str,
    line: u64,
    units: Option<Units>,
) -> Result<Option<Columns>, ReadError> {
    let headings: Vec<Heading> = cells.iter().map(|cell| Heading::new(cell)).collect();
    let roles = [RECEIVER, TRANSMITTER, LENGTH, TIME, SIGMA];
    let found = roles.map(|names| -> Vec<usize> { (0..cells.len()).filter(|&k| headings[k].is(names)).collect() });
    let [receivers, transmitters, lengths, times, sigmas] = found;
    let values = [lengths, times.clone()].concat();
    let bad = |problem: String| ReadError::Heading { file: file.to_string(), line, problem };
    let needed = [("receiver", &receivers), ("transmitter", &transmitters), ("value", &values)];
    if needed.iter().filter(|(_, found)| !found.is_empty()).count() < 2 {
        return Ok(None);
    }
    for (role, found) in needed.iter().chain(&[("sigma", &sigmas)]) {
        if let [a, b, ..] = found.as_slice() {
            return Err(bad(format!(
                "the columns {:?} and {:?} may both be the {role}; rename one",
                cells[*a], cells[*b]
            )));
        }
    }
    let ([receiver], [transmitter], [value]) = (receivers.as_slice(), transmitters.as_slice(), values.as_slice())
    else {
        let missing: Vec<&str> = needed.iter().filter(|(_, found)| found.is_empty()).map(|(role, _)| *role).collect();
        return Err(bad(format!("no column is the {}", missing.join(" or the "))));
    };
    let sigma = sigmas.first().copied();
    let wrong = |problem: String| ReadError::Unit { file: file.to_string(), line, problem };
    let is_time = times.contains(value);
    check_unit(&cells[*value], headings[*value].unit, is_time, units).map_err(wrong)?;
    if let Some(k) = sigma
        && let (Some(unit), Some(other)) = (headings[k].unit, headings[*value].unit)
        && unit != other
    {
        return Err(wrong(format!(
            "{:?} and {:?} are in different units; give both in {other}",
            cells[*value], cells[k]
        )));
    }
    Ok(Some(Columns { receiver: *receiver, transmitter: *transmitter, value: *value, sigma, count: cells.len() }))
}

/// What is wrong with reading a column headed so as numbers of these units.
fn check_unit(cell: &str, unit: Option<&str>, is_time: bool, units: Option<Units>) -> Result<(), String> {
    let option = |unit: &str| match unit {
        "m" => "leave out --units".to_string(),
        "samples" => "give --units samples --rate HZ --speed V (metres a second; sound in air: 343)".to_string(),
        "s" | "ms" | "us" => format!("give --units {unit} --speed V (metres a second; sound in air: 343)"),
        _ => format!("{unit} are not read: convert the numbers to m, s, ms, us or samples"),
    };
    match (unit, units) {
        (Some(unit), _) if unit == units.unwrap_or_default().name() => Ok(()),
        (Some(unit), None) => Err(format!("the column {cell:?} is in {unit}; {}", option(unit))),
        (Some(unit), Some(given)) => {
            let given = given.name();
            Err(format!(
                "the column {cell:?} is in {unit}, but --units {given} is asked for; {}, or rename the column",
                option(unit)
            ))
        }
        (None, None) if is_time => Err(format!(
            "the column {cell:?} holds times, and their unit is not said; give --units s --speed V (metres a second; sound in air: \
             343), or ms, us, or samples with --rate; --units m if they are multiplied by the speed already"
        )),
        (None, _) => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_units_of_columns() {
        for (cell, name, unit) in [
            ("Time (ms)", "time", Some("ms")),
            ("time_ms", "time", Some("ms")),
            ("arrival time [µs]", "arrival_time", Some("us")),
            ("TOA", "toa", None),
            ("x_m", "x", Some("m")),
            ("samples", "samples", Some("samples")),
            ("s", "s", None),
            ("", "", None),
        ] {
            let heading = Heading::new(cell);
            assert_eq!((heading.name.as_str(), heading.unit), (name, unit), "{cell}");
        }
        for cell in ["Microphone", "mic_id", "Mics", "receiver", "anchorid"] {
            assert!(Heading::new(cell).is(RECEIVER), "{cell}");
        }
        assert!(!Heading::new("s1").is(TRANSMITTER) && !Heading::new("mic1").is(RECEIVER));
    }
}
