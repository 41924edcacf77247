//! Cells as numbers: decimal points and commas, marks between thousands, moments.

use std::borrow::Cow;

use super::cells::Separator;
use super::times::Moment;
use super::units::Units;
use super::words::MISSING;
use crate::pseudoranges::{TimeOrigin, TimeScale};

/// The numbers of one file: its decimal mark is that of the first number that has one, or the one
/// that is given.
#[derive(Default)]
pub(super) struct Numbers {
    mark: Option<char>,
    is_given: bool,
    /// The first number that may have a mark between thousands in place of a decimal mark.
    doubtful: Option<String>,
    /// Whether some number can only have a decimal mark there.
    is_decimal: bool,
    /// From when on moments count.
    origin: Option<TimeOrigin>,
    /// Whether plain numbers were read.
    has_plain: bool,
    /// The least and the greatest moment.
    moments: Option<[f64; 2]>,
}

/// Sound or radio in a network of this size, metres, is hardly measured: a number with three decimals
/// is rather one with thousands.
const TINY: f64 = 0.05;

/// Times of one recording differ by less than this, seconds; where they do not, midnight has passed.
const HALF_DAY: f64 = 43_200.0;

impl Numbers {
    /// With a decimal mark that is known; the other one may stand between thousands.
    pub(super) fn new(mark: Option<char>) -> Numbers {
        Numbers { mark, is_given: mark.is_some(), ..Numbers::default() }
    }

    /// Whose moments count from the origin of others that were read, or which are no moments where those were none.
    pub(super) fn since(origin: Option<TimeOrigin>) -> Numbers {
        Numbers { origin, has_plain: origin.is_none(), ..Numbers::default() }
    }

    /// From when on moments count, where moments were read.
    pub(super) fn origin(&self) -> Option<TimeOrigin> {
        self.origin
    }

    /// The number in a cell, NaN for what was not measured.
    ///
    /// # Errors
    /// What to do, for a cell that holds no number or one with another decimal mark than the
    /// file's.
    pub(super) fn number(&mut self, cell: &str) -> Result<f64, String> {
        let cell = &*plain(cell);
        if self.is_given {
            let ungrouped = self.mark.and_then(|mark| ungrouped(cell, if mark == '.' { ',' } else { '.' }));
            return number(&ungrouped.unwrap_or_else(|| cell.to_string()))
                .filter(|_| self.fits(cell))
                .ok_or_else(|| remedy(cell));
        }
        let Some(value) = number(cell) else {
            return Err(remedy(cell));
        };
        let mark = cell.chars().find(|&c| matches!(c, '.' | ',')).filter(|_| !value.is_nan());
        self.mark = self.mark.or(mark);
        match (mark, self.mark) {
            (Some(mark), Some(known)) if mark != known => {
                return Err(format!(
                    "numbers before it have the decimal mark {known:?}; write all of them with one, or say which it is \
                     (--decimal-mark), if the other stands between thousands"
                ));
            }
            (Some(_), _) if self.is_decimal => {}
            (Some(mark), _) if ungrouped(cell, mark).is_none() => self.is_decimal = true,
            (Some(_), _) => {
                self.doubtful.get_or_insert_with(|| cell.to_string());
            }
            (None, _) => {}
        }
        Ok(value)
    }

    /// Whether the only decimal mark of a cell is the given one.
    fn fits(&self, cell: &str) -> bool {
        let mark = self.mark.unwrap_or('.');
        let other = if mark == '.' { ',' } else { '.' };
        cell.matches(mark).count() <= 1 && (!cell.contains(other) || ungrouped(cell, other).is_some())
    }

    /// The measurement in a cell: a number, or the seconds of a moment since the whole second of the
    /// first.
    ///
    /// # Errors
    /// What to do, as [`Numbers::number`], and for moments in another unit than seconds.
    pub(super) fn measurement(&mut self, cell: &str, units: Units) -> Result<f64, String> {
        let Some(moment) = Moment::parse(cell) else {
            let value = self.number(cell)?;
            self.has_plain |= !value.is_nan();
            return if self.has_plain && self.origin.is_some() { Err(MIXED.to_string()) } else { Ok(value) };
        };
        if !matches!(units, Units::Seconds { .. }) {
            return Err(
                "it is a time of day, in seconds; give --units s --speed V (metres a second; sound in air: 343)"
                    .to_string(),
            );
        }
        let first = TimeOrigin { seconds: moment.seconds, scale: moment.scale };
        let origin = *self.origin.get_or_insert(first);
        if self.has_plain || origin.scale != moment.scale {
            return Err(MIXED.to_string());
        }
        let value = moment.since(origin.seconds);
        let [least, most] = self.moments.unwrap_or([value; 2]);
        let range = [least.min(value), most.max(value)];
        self.moments = Some(range);
        if origin.scale == TimeScale::OfDay && range[1] - range[0] > HALF_DAY {
            return Err(
                "it is half a day from others: if midnight has passed between them, give the date too".to_string()
            );
        }
        Ok(value)
    }

    /// What to do where the numbers may be a thousand times as large: all that have a mark have three
    /// digits behind it, and as decimals they are hardly what was measured. `spread` is by how much
    /// measurements of one transmitter differ at most then, metres.
    pub(super) fn doubt(&self, separator: Separator, units: Units, spread: f64) -> Option<String> {
        let cell = self.doubtful.as_ref().filter(|_| !self.is_decimal)?;
        let mark = self.mark?;
        // Who separates cells by commas or blanks writes points before decimals.
        let usual = mark == '.' && matches!(separator, Separator::Comma | Separator::Blanks);
        let strange = mark == ',' && separator == Separator::Comma;
        if usual || !(strange || matches!(units, Units::Samples { .. }) || spread < TINY) {
            return None;
        }
        let (word, other) = if mark == ',' { ("comma", "point") } else { ("point", "comma") };
        Some(format!(
            "numbers such as {cell:?} have three digits behind the {word} everywhere, which may stand between thousands; give \
             --decimal-mark {other} if it does, or --decimal-mark {word} if it is the decimal mark"
        ))
    }
}

const MIXED: &str =
    "times of day and numbers, or dates with and without a zone, cannot be read together; write all in one form";

/// A cell with the signs of ASCII, without marks that stand between thousands and nowhere else.
fn plain(cell: &str) -> Cow<'_, str> {
    if cell.is_ascii() && !cell.contains([' ', '\'']) {
        return Cow::Borrowed(cell);
    }
    let minus = |c: char| if matches!(c, '\u{2212}' | '\u{2013}' | '\u{fe63}' | '\u{ff0d}') { '-' } else { c };
    let signed: String = match cell.chars().next() {
        Some(first) if minus(first) != first && cell.chars().nth(1).is_some() => {
            std::iter::once('-').chain(cell.chars().skip(1)).collect()
        }
        _ => cell.to_string(),
    };
    // An exponent may have its sign too.
    let signed: String = if signed.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
        signed.chars().map(minus).collect()
    } else {
        signed
    };
    let grouped =
        [' ', '\'', '\u{2019}', '\u{a0}', '\u{202f}', '\u{2009}'].into_iter().find_map(|mark| ungrouped(&signed, mark));
    Cow::Owned(grouped.unwrap_or(signed))
}

/// A number without this mark between its thousands; `None` if it does not stand there.
fn ungrouped(cell: &str, mark: char) -> Option<String> {
    let unsigned = cell.strip_prefix(['-', '+']).unwrap_or(cell);
    let end = unsigned.find(|c: char| matches!(c, '.' | ',') && c != mark).unwrap_or(unsigned.len());
    let (whole, rest) = unsigned.split_at(end);
    let mut groups = whole.split(mark);
    let first = groups.next()?;
    let is_first =
        (1..=3).contains(&first.len()) && !first.starts_with('0') && first.bytes().all(|b| b.is_ascii_digit());
    let others: Vec<&str> = groups.collect();
    let are_groups = others.iter().all(|group| group.len() == 3 && group.bytes().all(|b| b.is_ascii_digit()));
    let ends_well = rest.get(1..).is_none_or(|rest| rest.bytes().all(|b| b.is_ascii_digit()));
    let sign = &cell[..cell.len() - unsigned.len()];
    (is_first && are_groups && ends_well && !others.is_empty())
        .then(|| format!("{sign}{}{rest}", whole.replace(mark, "")))
}

/// A number with a decimal point or comma, NaN for an empty cell and the usual words for a missing
/// one.
pub(super) fn number(cell: &str) -> Option<f64> {
    if is_missing(cell) {
        return Some(f64::NAN);
    }
    let cell = &*plain(cell);
    if cell.contains(',') {
        // Only one, and no point beside it: anything else groups thousands.
        return if cell.matches(',').count() == 1 && !cell.contains('.') {
            cell.replace(',', ".").parse().ok()
        } else {
            None
        };
    }
    cell.parse().ok()
}

/// Whether a cell says that nothing was measured.
pub(super) fn is_missing(cell: &str) -> bool {
    cell.len() <= 8 && MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word))
}

/// Whether a cell holds what may be a measurement, or that there is none.
pub(super) fn is_value(cell: &str) -> bool {
    number(cell).is_some() || Moment::parse(cell).is_some()
}

/// Whether a cell holds a whole number without a sign.
pub(super) fn is_whole(cell: &str) -> bool {
    (1..=18).contains(&cell.len()) && cell.bytes().all(|b| b.is_ascii_digit())
}

/// What to do with a cell that holds no number.
fn remedy(cell: &str) -> String {
    let grouped =
        cell.chars().all(|c| c.is_ascii_digit() || "+-., '".contains(c)) && cell.chars().any(|c| c.is_ascii_digit());
    let with_unit = cell
        .split_once(' ')
        .is_some_and(|(value, unit)| number(value).is_some() && unit.chars().all(char::is_alphabetic));
    if grouped {
        "write it without marks between thousands, or say which mark stands before decimals (--decimal-mark)"
            .to_string()
    } else if with_unit {
        "write the number without its unit, and give that as --units".to_string()
    } else if cell.starts_with('#') {
        "it is an error of a spreadsheet; mend the formula, or leave the cell empty if it was not measured".to_string()
    } else if cell.contains(':') {
        "write times as ISO 8601 has them (2024-05-12T05:30:35.405921Z, or 05:30:35.405921), or in seconds".to_string()
    } else {
        "leave the cell empty or write nan if it was not measured".to_string()
    }
}

/// The start of a cell, for messages.
pub(super) fn shorten(cell: &str) -> String {
    if cell.chars().count() <= 40 { cell.to_string() } else { cell.chars().take(40).chain("...".chars()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_point_and_comma() {
        assert_eq!(
            [number("1,5"), number("-1.5e3"), number("7"), number("1.234,5"), number("1,234,567")],
            [Some(1.5), Some(-1500.0), Some(7.0), None, None]
        );
        let mut numbers = Numbers::default();
        assert_eq!([numbers.number("3"), numbers.number("1,5"), numbers.number("2,5")], [Ok(3.0), Ok(1.5), Ok(2.5)]);
        assert!(numbers.number("1.5").unwrap_err().contains("','"));
        assert!(numbers.number("1.234,5").unwrap_err().contains("thousands"));
        assert!(numbers.number("3 ms").unwrap_err().contains("--units"));
        assert!(numbers.number("x").unwrap_err().contains("leave the cell empty"));
        assert!(numbers.number("#VALUE!").unwrap_err().contains("error of a spreadsheet"));
        for missing in ["n/a", "#N/A", "#NV", "", "NaN", "<NA>", "\u{2212}", "-"] {
            assert!(numbers.number(missing).unwrap().is_nan(), "{missing}");
        }
    }

    #[test]
    fn signs_and_thousands_of_typesetters() {
        let mut numbers = Numbers::default();
        for (cell, value) in [
            ("\u{2212}1.5", -1.5),
            ("\u{2013}2", -2.0),
            ("1e\u{2212}3", 1e-3),
            ("51 335", 51_335.0),
            ("1'234'567.25", 1_234_567.25),
            ("\u{2212}51\u{202f}335", -51_335.0),
            ("12\u{a0}345.5", 12_345.5),
        ] {
            assert_eq!(numbers.number(cell), Ok(value), "{cell}");
        }
        for cell in ["5 1335", "1 23", "12 3456", "1-2", "\u{2212}"] {
            assert!(numbers.number(cell).is_err() || cell == "\u{2212}", "{cell}");
        }
    }

    #[test]
    fn a_given_mark_tells_thousands() {
        let read = |mark, cell: &str| Numbers::new(Some(mark)).number(cell);
        for (mark, cell, value) in [
            ('.', "51,335", 51_335.0),
            ('.', "1,234,567.5", 1_234_567.5),
            (',', "51.335", 51_335.0),
            (',', "51,335", 51.335),
            ('.', "51.335", 51.335),
            (',', "-1.234,5", -1234.5),
            ('.', "7", 7.0),
            ('.', "1.5e-3", 1.5e-3),
        ] {
            assert_eq!(read(mark, cell), Ok(value), "{cell} {mark}");
        }
        for (mark, cell) in [('.', "51,33"), (',', "5.1335"), ('.', "1,23.4"), (',', "0.335"), ('.', "1,234,5")] {
            assert!(read(mark, cell).is_err(), "{cell} {mark}");
        }
        assert!(read('.', "").unwrap().is_nan());
    }

    #[test]
    fn thousands_are_doubted_where_decimals_make_no_sense() {
        let samples = Units::Samples { speed: 343.0, rate: 48_000.0 };
        let doubt = |cells: &[&str], separator, units, spread| {
            let mut numbers = Numbers::default();
            for cell in cells {
                numbers.number(cell).unwrap();
            }
            numbers.doubt(separator, units, spread)
        };
        let commas = ["51,335", "49,103", "", "998"];
        let said = doubt(&commas, Separator::Comma, Units::Metres, 5.0).unwrap();
        assert!(said.contains("\"51,335\"") && said.contains("--decimal-mark point"), "{said}");
        assert!(doubt(&commas, Separator::Semicolon, samples, 0.01).is_some());
        assert!(doubt(&["51.335"], Separator::Semicolon, samples, 0.01).is_some());
        assert!(doubt(&commas, Separator::Semicolon, Units::Microseconds { speed: 343.0 }, 0.001).is_some());
        for (cells, separator, units, spread) in [
            // Metres to the millimetre, and what has other digits too.
            (&commas[..], Separator::Semicolon, Units::Metres, 5.0),
            (&["51,335", "0,103"], Separator::Comma, samples, 0.01),
            (&["51,335", "49,1"], Separator::Semicolon, samples, 0.01),
            (&["51.335"], Separator::Comma, samples, 0.01),
            (&["51335"], Separator::Semicolon, samples, 0.01),
        ] {
            assert_eq!(doubt(cells, separator, units, spread), None, "{cells:?}");
        }
    }

    #[test]
    fn moments_are_seconds() {
        let seconds = Units::Seconds { speed: 343.0 };
        let mut numbers = Numbers::default();
        assert_eq!(numbers.measurement("2024-05-12T05:30:35.5Z", seconds), Ok(0.5));
        assert_eq!(numbers.measurement("2024-05-12T05:30:34.25Z", seconds), Ok(-0.75));
        assert!(numbers.measurement("", seconds).unwrap().is_nan());
        assert!(numbers.measurement("2024-05-12T05:30:35.5", seconds).unwrap_err().contains("in one form"));
        assert!(numbers.measurement("1.5", seconds).unwrap_err().contains("in one form"));
        let said = Numbers::default().measurement("05:30:35.5", Units::Metres).unwrap_err();
        assert!(said.contains("--units s"), "{said}");
        let mut numbers = Numbers::default();
        assert!(numbers.measurement("23:59:59.5", seconds).is_ok());
        assert!(numbers.measurement("00:00:01.0", seconds).unwrap_err().contains("midnight"));
    }
}
