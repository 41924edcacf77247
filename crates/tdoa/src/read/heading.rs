//! The first lines of tables: which column is which, and in what unit.

use super::error::ReadError;
use super::units::Units;

const RECEIVER: &[&str] = &["receiver", "mic", "microphone", "anchor", "sensor", "station", "channel", "rx"];
const TRANSMITTER: &[&str] = &["transmitter", "event", "source", "emitter", "sound", "shot", "tag", "beacon", "tx"];
const LENGTH: &[&str] = &["value", "pseudorange", "range", "distance", "measurement"];
const TIME: &[&str] =
    &["time", "toa", "tdoa", "arrival", "arrival_time", "time_of_arrival", "timestamp", "sample", "seconds"];
const SIGMA: &[&str] = &["sigma", "std", "stddev", "std_dev", "standard_deviation"];
/// Columns that name nodes of either kind.
const NODE: &[&str] = &["name", "id", "node", "label"];
/// Stands for receivers in a list without a column that says so more clearly.
const SENSOR_NODE: &[&str] = &["node"];

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
    ("nsec", "ns"),
    ("nanoseconds", "ns"),
    ("mm", "mm"),
    ("millimetres", "mm"),
    ("millimeters", "mm"),
    ("cm", "cm"),
    ("centimetres", "cm"),
    ("centimeters", "cm"),
    ("km", "km"),
    ("kilometres", "km"),
    ("kilometers", "km"),
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

    /// Whether this is one of some names with a number behind it, such as `mic1` and `Receiver 2`.
    fn is_numbered(&self, names: &[&str]) -> bool {
        let stem = self.name.trim_end_matches(|c: char| c.is_ascii_digit());
        stem.len() < self.name.len() && names.contains(&stem.trim_end_matches('_'))
    }

    /// Whether rows of a matrix begin with names below this.
    pub(super) fn heads_receivers(&self) -> bool {
        self.name.is_empty() || self.is(RECEIVER) || self.is(NODE)
    }

    /// Whether this says that transmitters are the rows below it.
    pub(super) fn heads_transmitters(&self) -> bool {
        self.is(TRANSMITTER)
    }

    /// Whether names of receivers stand below this in a table of positions.
    pub(super) fn heads_nodes(&self) -> bool {
        self.is(RECEIVER) || self.is(NODE)
    }

    /// Whether standard deviations stand below this.
    pub(super) fn heads_sigmas(&self) -> bool {
        self.is(SIGMA)
    }

    /// Of which coordinate standard deviations stand below this, if of one: 0 for x, 1 for y, 2
    /// for z.
    pub(super) fn coordinate_of_sigma(&self) -> Option<usize> {
        let of = |axis: &str| {
            let name = self.name.as_str();
            let stem = name.strip_suffix(axis).and_then(|stem| stem.strip_suffix('_'));
            stem.or_else(|| name.strip_prefix(axis)?.strip_prefix('_')).is_some_and(|stem| SIGMA.contains(&stem))
        };
        ["x", "y", "z"].iter().position(|axis| of(axis))
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

/// Columns by what their headings say that they hold.
struct Roles {
    receivers: Vec<usize>,
    transmitters: Vec<usize>,
    /// Measurements of either kind.
    values: Vec<usize>,
    times: Vec<usize>,
    sigmas: Vec<usize>,
}

impl Roles {
    fn of(headings: &[Heading]) -> Roles {
        let under = |names| -> Vec<usize> { (0..headings.len()).filter(|&k| headings[k].is(names)).collect() };
        let (receivers, times) = (under(RECEIVER), under(TIME));
        Roles {
            receivers: if receivers.is_empty() { under(SENSOR_NODE) } else { receivers },
            transmitters: under(TRANSMITTER),
            values: [under(LENGTH), times.clone()].concat(),
            times,
            sigmas: under(SIGMA),
        }
    }
}

/// Whether a table with these headings is a list of one measurement a line, as [`read`](super::read) takes it: two of
/// receiver, transmitter and value are there, so that the third is asked for.
pub fn heads_list<S: AsRef<str>>(headings: &[S]) -> bool {
    let headings: Vec<Heading> = headings.iter().map(|cell| Heading::new(cell.as_ref())).collect();
    let Roles { receivers, transmitters, values, .. } = Roles::of(&headings);
    [receivers, transmitters, values].iter().filter(|found| !found.is_empty()).count() >= 2
}

/// The columns of a list; `None` if the first line is not that of a list.
pub(super) fn list_columns(
    cells: &[String],
    file: &str,
    line: u64,
    units: Option<Units>,
) -> Result<Option<Columns>, ReadError> {
    let headings: Vec<Heading> = cells.iter().map(|cell| Heading::new(cell)).collect();
    let Roles { receivers, transmitters, values, times, sigmas } = Roles::of(&headings);
    let bad = |problem: String| ReadError::Heading { file: file.to_string(), line, problem };
    let needed = [("receiver", &receivers), ("transmitter", &transmitters), ("value", &values)];
    if !heads_list(cells) {
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
    check_unit("column", &cells[*value], headings[*value].unit, is_time, units).map_err(wrong)?;
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

/// Checks what the first line of a matrix, if it has one, and the names of its rows, if they have any,
/// say of it: units in the corner or in all names, and which nodes are the rows.
pub(super) fn check_matrix(
    first: &[String],
    has_corner: bool,
    rows: &[String],
    file: &str,
    line: u64,
    units: Option<Units>,
) -> Result<(), ReadError> {
    let wrong = |problem: String| ReadError::Unit { file: file.to_string(), line, problem };
    let headings: Vec<Heading> = first.iter().map(|cell| Heading::new(cell)).collect();
    let (corner, names) = headings.split_at(usize::from(has_corner && !headings.is_empty()));
    let transposed = |what: &str, name: &str| ReadError::Line {
        file: file.to_string(),
        line,
        problem: format!(
            "{what} {name:?} says that receivers are the columns, but they must be the rows, and transmitters the columns; transpose \
             the table, or rename it if it is right"
        ),
    };
    if corner.iter().any(Heading::heads_transmitters) {
        return Err(transposed("the corner cell", &first[0]));
    }
    let all_numbered =
        |headings: &[Heading], kind| !headings.is_empty() && headings.iter().all(|h| h.is_numbered(kind));
    if all_numbered(names, RECEIVER) {
        return Err(transposed("the name of a column", &first[corner.len()]));
    }
    let named: Vec<Heading> = rows.iter().map(|name| Heading::new(name)).collect();
    if all_numbered(&named, TRANSMITTER) {
        return Err(transposed("the name of a row", &rows[0]));
    }
    // A transmitter may be called almost anything, a corner tells what the table holds.
    if let Some(heading) = headings.first() {
        let is_time = heading.is(TIME);
        if is_time || heading.is(LENGTH) || (has_corner && heading.unit.is_some()) {
            check_unit("corner cell", &first[0], heading.unit, is_time, units).map_err(wrong)?;
        }
    }
    // `clap_s` and `clap_m` may be names.
    let of_all = names.first().and_then(|heading| heading.unit).filter(|unit| unit.len() > 1);
    if of_all.is_some() && names.iter().all(|heading| heading.unit == of_all) {
        check_unit("column", &first[corner.len()], of_all, false, units).map_err(wrong)?;
    }
    Ok(())
}

/// What is wrong with reading numbers under such a heading, that of a `what`, as of these units.
fn check_unit(what: &str, cell: &str, unit: Option<&str>, is_time: bool, units: Option<Units>) -> Result<(), String> {
    let option = |unit: &str| match unit {
        "m" => "leave out --units".to_string(),
        "samples" => "give --units samples --rate HZ --speed V (metres a second; sound in air: 343)".to_string(),
        "cm" | "km" => format!("give --units {unit}"),
        "s" | "ms" | "us" => format!("give --units {unit} --speed V (metres a second; sound in air: 343)"),
        "ns" => "give --units ns --speed V (metres a second; radio: 299792458)".to_string(),
        _ => format!("{unit} are not read: convert the numbers to m, cm or km"),
    };
    match (unit, units) {
        (Some(unit), _) if unit == units.unwrap_or_default().name() => Ok(()),
        (Some(unit), None) => Err(format!("the {what} {cell:?} is in {unit}; {}", option(unit))),
        (Some(unit), Some(given)) => {
            let given = given.name();
            Err(format!(
                "the {what} {cell:?} is in {unit}, but --units {given} is asked for; {}, or rename the {what}",
                option(unit)
            ))
        }
        (None, None) if is_time => Err(format!(
            "the {what} {cell:?} holds times, and their unit is not said; give --units s --speed V (metres a second; sound in air: \
             343), or ms, us, ns, or samples with --rate; --units m if they are multiplied by the speed already"
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
            ("Arrival time (ms)", "arrival_time", Some("ms")),
            ("range (cm)", "range", Some("cm")),
            ("time of arrival (nanoseconds)", "time_of_arrival", Some("ns")),
            ("TOA", "toa", None),
            ("x_m", "x", Some("m")),
            ("samples", "samples", Some("samples")),
            ("s", "s", None),
            ("", "", None),
        ] {
            let heading = Heading::new(cell);
            assert_eq!((heading.name.as_str(), heading.unit), (name, unit), "{cell}");
        }
        for cell in ["Microphone", "mic_id", "Mics", "receiver", "anchorid", "Channel", "channel_number"] {
            assert!(Heading::new(cell).is(RECEIVER), "{cell}");
        }
        for cell in ["Shot", "shot_number", "beacon", "Beacon id"] {
            assert!(Heading::new(cell).is(TRANSMITTER), "{cell}");
        }
        assert!(!Heading::new("s1").is(TRANSMITTER) && !Heading::new("mic1").is(RECEIVER));
        assert!(["mic1", "Mic 2", "receiver_03"].iter().all(|cell| Heading::new(cell).is_numbered(RECEIVER)));
        assert!(["mic", "r1", "1", "mica1"].iter().all(|cell| !Heading::new(cell).is_numbered(RECEIVER)));
    }
}
