//! The headings of columns: what stands below them, and in what unit.

use super::error::ReadError;
use super::units::Units;
use super::words::{
    ANGLES, COORDINATES, DEPTHS, INDEX, LENGTH, LETTERS, NODE, OTHER, PAIRS, RECEIVER, SIGMA, TIME, TRANSMITTER, UNITS,
    Words,
};

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
            [only] if TIME.sure.contains(only) || only.starts_with("sample") => (words.as_slice(), unit_of(only)),
            _ => (words.as_slice(), None),
        };
        Heading { name: words.join("_"), unit }
    }

    /// Whether this is one of some names, in the singular or plural, or the name or number of one.
    pub(super) fn is(&self, names: &[&str]) -> bool {
        let name = self.name.as_str();
        let forms = ["_id", "_name", "_number", "_index", "_no", "_nr", "s", "id", ""];
        forms.iter().filter_map(|form| name.strip_suffix(form)).any(|stem| names.contains(&stem))
    }

    /// Whether this may be one of some words.
    pub(super) fn may_be(&self, words: &Words) -> bool {
        self.is(words.sure) || self.is(words.weak)
    }

    /// Whether this is one of some names with a number behind it, such as `mic1` and `Receiver 2`.
    fn is_numbered(&self, names: &[&str]) -> bool {
        let stem = self.name.trim_end_matches(|c: char| c.is_ascii_digit());
        stem.len() < self.name.len() && names.contains(&stem.trim_end_matches('_'))
    }

    /// Which of a pair of receivers this names, such as the second for `mic_b`, and by which marks.
    pub(super) fn of_pair(&self) -> Option<(usize, usize)> {
        let stem_of = |mark: &str| {
            let stem = self.name.strip_suffix(mark)?.trim_end_matches('_');
            (stem.is_empty() || RECEIVER.sure.contains(&stem) || RECEIVER.weak.contains(&stem)).then_some(())
        };
        let place = |marks: &[&str; 2]| marks.iter().position(|mark| stem_of(mark).is_some());
        PAIRS.iter().enumerate().find_map(|(k, marks)| Some((k, place(marks)?)))
    }

    /// Whether this is the mark of one of a pair, without a word.
    pub(super) fn is_mark(&self) -> bool {
        PAIRS.iter().flatten().any(|mark| *mark == self.name)
    }

    /// Whether rows of a matrix begin with names below this.
    pub(super) fn heads_receivers(&self) -> bool {
        self.name.is_empty() || self.may_be(&RECEIVER) || self.is(NODE) || self.heads_index()
    }

    /// Whether rows are numbered below this.
    pub(super) fn heads_index(&self) -> bool {
        INDEX.contains(&self.name.as_str())
    }

    /// Whether this says that transmitters are the rows below it.
    pub(super) fn heads_transmitters(&self) -> bool {
        self.may_be(&TRANSMITTER)
    }

    /// Whether measurements stand below this.
    pub(super) fn heads_measurements(&self) -> bool {
        self.is(TIME.sure) || self.is(LENGTH.sure)
    }

    /// Whether something else than arrival times and names stands below this.
    pub(super) fn heads_other(&self) -> bool {
        OTHER.contains(&self.name.as_str())
    }

    /// Whether names of receivers stand below this in a table of positions.
    pub(super) fn heads_nodes(&self) -> bool {
        self.may_be(&RECEIVER) || self.is(NODE)
    }

    /// Whether standard deviations stand below this.
    pub(super) fn heads_sigmas(&self) -> bool {
        self.is(SIGMA.sure)
    }

    /// Of which coordinate standard deviations stand below this, if of one: 0 for x, 1 for y, 2
    /// for z.
    pub(super) fn coordinate_of_sigma(&self) -> Option<usize> {
        let of = |axis: &str| {
            let name = self.name.as_str();
            let stem = name.strip_suffix(axis).and_then(|stem| stem.strip_suffix('_'));
            stem.or_else(|| name.strip_prefix(axis)?.strip_prefix('_')).is_some_and(|stem| SIGMA.sure.contains(&stem))
        };
        COORDINATES.iter().position(|names| names.iter().any(|axis| of(axis)))
    }

    /// Which coordinate stands below this, if one does: 0 for x, 1 for y, 2 for z.
    pub(super) fn coordinate(&self) -> Option<usize> {
        COORDINATES.iter().position(|names| names.contains(&self.name.as_str()))
    }

    /// Which coordinate the letter e, n or u stands for.
    pub(super) fn letter(&self) -> Option<usize> {
        LETTERS.iter().position(|letter| *letter == self.name)
    }

    /// What is wrong with positions that have this column.
    pub(super) fn is_no_coordinate(&self) -> Option<&'static str> {
        if ANGLES.contains(&self.name.as_str()) {
            Some(
                "is an angle on the earth; convert latitude and longitude to metres, such as UTM's easting and northing",
            )
        } else if DEPTHS.contains(&self.name.as_str()) {
            Some("counts downwards; give z, which counts upwards: minus the depth")
        } else {
            None
        }
    }
}

/// Checks what the first line of a matrix, if it has one, and the names of its rows, if they have any,
/// say of it: units in the corner or in all names, and which nodes are the rows.
pub(super) fn check_matrix(
    first: &[String],
    has_corner: bool,
    rows: &[String],
    transpose: bool,
    (file, line): (&str, u64),
    units: Option<Units>,
) -> Result<(), ReadError> {
    let wrong = |problem: String| ReadError::Unit { file: file.to_string(), line, problem };
    let headings: Vec<Heading> = first.iter().map(|cell| Heading::new(cell)).collect();
    let (corner, names) = headings.split_at(usize::from(has_corner && !headings.is_empty()));
    let transposed = |what: &str, name: &str| ReadError::Line {
        file: file.to_string(),
        line,
        problem: format!(
            "{what} {name:?} says that receivers are the columns, but they must be the rows, and transmitters the columns; give \
             --transpose (or transpose the table), or rename it if it is right"
        ),
    };
    let all_numbered =
        |headings: &[Heading], kind| !headings.is_empty() && headings.iter().all(|h: &Heading| h.is_numbered(kind));
    if !transpose {
        if corner.iter().any(Heading::heads_transmitters) {
            return Err(transposed("the corner cell", &first[0]));
        }
        // `r1`, `r2` are receivers where the rows have no names that say otherwise.
        let are_counted = corner.iter().any(Heading::heads_index) && all_numbered(names, &["r"]);
        if all_numbered(names, RECEIVER.sure) || all_numbered(names, &["ch", "chan", "phone"]) || are_counted {
            return Err(transposed("the name of a column", &first[corner.len()]));
        }
        let named: Vec<Heading> = rows.iter().map(|name| Heading::new(name)).collect();
        if all_numbered(&named, TRANSMITTER.sure) || all_numbered(&named, TRANSMITTER.weak) {
            return Err(transposed("the name of a row", &rows[0]));
        }
    }
    // A transmitter may be called almost anything, a corner tells what the table holds.
    if let Some(heading) = headings.first() {
        let is_time = heading.is(TIME.sure);
        if heading.heads_measurements() || (has_corner && heading.unit.is_some()) {
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
pub(super) fn check_unit(
    what: &str,
    cell: &str,
    unit: Option<&str>,
    is_time: bool,
    units: Option<Units>,
) -> Result<(), String> {
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

/// A heading as an option says it, in quotes where the shell needs them.
pub(super) fn quoted(heading: &str) -> String {
    let is_plain = heading.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c)) && !heading.is_empty();
    if is_plain { heading.to_string() } else { format!("{heading:?}") }
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
        for cell in ["Microphone", "mic_id", "Mics", "receiver", "anchorid", "Channel", "channel_number", "Empfänger"]
        {
            assert!(Heading::new(cell).is(RECEIVER.sure), "{cell}");
        }
        for cell in ["Shot", "shot_number", "beacon", "Beacon id", "Ereignis"] {
            assert!(Heading::new(cell).is(TRANSMITTER.sure), "{cell}");
        }
        for cell in
            ["recorder", "Hydrophone", "phone", "Serial No.", "device", "index", "Unnamed: 0", "ARU", "site", "#"]
        {
            assert!(Heading::new(cell).heads_receivers(), "{cell}");
        }
        assert!(!Heading::new("s1").is(TRANSMITTER.sure) && !Heading::new("mic1").is(RECEIVER.sure));
        assert!(["mic1", "Mic 2", "receiver_03"].iter().all(|cell| Heading::new(cell).is_numbered(RECEIVER.sure)));
        assert!(["mic", "r1", "1", "mica1"].iter().all(|cell| !Heading::new(cell).is_numbered(RECEIVER.sure)));
        for (cell, place) in [("mic_a", 0), ("mic_b", 1), ("Receiver 2", 1), ("rx1", 0), ("from", 0), ("sensor_j", 1)] {
            assert_eq!(Heading::new(cell).of_pair().map(|(_, place)| place), Some(place), "{cell}");
        }
        assert!(["mic", "tag_a", "event1", "s1"].iter().all(|cell| Heading::new(cell).of_pair().is_none()));
    }
}
