//! Text as records of cells, and cells as numbers.

use super::error::ReadError;

/// One line of a table that is not empty.
pub(super) struct Record {
    pub(super) line: u64,
    pub(super) cells: Vec<String>,
}

impl Record {
    /// Whether no cell holds anything, as in the last lines that spreadsheets write.
    pub(super) fn is_blank(&self) -> bool {
        self.cells.iter().all(String::is_empty)
    }
}

/// Splits text into records, lazily: a bad line is reported before the rest is looked at.
pub(super) fn records<'a>(text: &'a str, file: &'a str) -> impl Iterator<Item = Result<Record, ReadError>> + 'a {
    let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or("");
    let separator = Separator::of(first);
    let reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator.delimiter())
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let records = reader.into_records().map(move |record| {
        let record = record.map_err(|error| ReadError::Line {
            file: file.to_string(),
            line: error.position().map_or(1, |position| line_at(text, position)),
            problem: format!("cannot be read as CSV ({error})"),
        })?;
        let line = record.position().map_or(1, |position| line_at(text, position));
        let cells = record.iter().filter(|cell| separator != Separator::Blanks || !cell.is_empty());
        Ok(Record { line, cells: cells.map(|cell| unquoted(cell).to_string()).collect() })
    });
    // A line of blanks is an empty line.
    records.filter(|record| record.as_ref().map_or(true, |record| record.cells.len() > 1 || !record.is_blank()))
}

/// The line of a record. Its position is that of the empty lines and comments before it.
fn line_at(text: &str, position: &csv::Position) -> u64 {
    let rest = usize::try_from(position.byte()).ok().and_then(|byte| text.get(byte..)).unwrap_or("");
    let skipped = rest.lines().take_while(|line| line.is_empty() || line.starts_with('#')).count();
    position.line() + skipped as u64
}

/// A cell without quotes that have a blank before them.
fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')).map_or(cell, str::trim)
}

/// What stands between cells.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Separator {
    Comma,
    Semicolon,
    Tab,
    /// Any number of spaces, as numpy.savetxt writes them.
    Blanks,
}

impl Separator {
    /// The separator of a table with this first line.
    fn of(line: &str) -> Separator {
        // What stands in quotes separates nothing.
        let bare: String = line.split('"').step_by(2).collect();
        let decimal = has_decimal_commas(&bare);
        if bare.contains(';') {
            Separator::Semicolon
        } else if bare.contains('\t') && (decimal || !pads_commas(&bare)) {
            Separator::Tab
        } else if bare.contains(',') && !(decimal && bare.split_whitespace().count() > 1) {
            Separator::Comma
        } else if bare.split_whitespace().count() > 1 && line == bare {
            Separator::Blanks
        } else {
            Separator::Comma
        }
    }

    fn delimiter(self) -> u8 {
        match self {
            Separator::Comma => b',',
            Separator::Semicolon => b';',
            Separator::Tab => b'\t',
            Separator::Blanks => b' ',
        }
    }
}

/// Whether there are commas, each between two digits.
fn has_decimal_commas(line: &str) -> bool {
    let bytes = line.as_bytes();
    let digit = |k: Option<usize>| k.and_then(|k| bytes.get(k)).is_some_and(u8::is_ascii_digit);
    let mut commas = (0..bytes.len()).filter(|&k| bytes[k] == b',').peekable();
    commas.peek().is_some() && commas.all(|k| digit(k.checked_sub(1)) && digit(Some(k + 1)))
}

/// Whether every tab stands beside a comma.
fn pads_commas(line: &str) -> bool {
    let pieces: Vec<&str> = line.split('\t').map(|piece| piece.trim_matches(' ')).collect();
    line.contains(',') && pieces.windows(2).all(|pair| pair[0].ends_with(',') || pair[1].starts_with(','))
}

/// The decimal mark of one file: that of the first number that has one.
#[derive(Default)]
pub(super) struct Decimals {
    mark: Option<char>,
}

impl Decimals {
    /// The number in a cell, NaN for what was not measured.
    ///
    /// # Errors
    /// What to do, for a cell that holds no number or one with another decimal mark than the
    /// file's.
    pub(super) fn number(&mut self, cell: &str) -> Result<f64, String> {
        let Some(value) = number(cell) else {
            return Err(remedy(cell));
        };
        let mark = cell.chars().find(|&c| matches!(c, '.' | ',')).filter(|_| !value.is_nan());
        self.mark = self.mark.or(mark);
        match (mark, self.mark) {
            (Some(mark), Some(known)) if mark != known => {
                Err(format!("numbers before it have the decimal mark {known:?}; write all of them with one"))
            }
            _ => Ok(value),
        }
    }
}

/// A number with a decimal point or comma, NaN for an empty cell and the usual words for a missing
/// one.
pub(super) fn number(cell: &str) -> Option<f64> {
    const MISSING: [&str; 6] = ["", "nan", "na", "n/a", "null", "-"];
    if MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word)) {
        return Some(f64::NAN);
    }
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

/// What to do with a cell that holds no number.
fn remedy(cell: &str) -> String {
    let grouped =
        cell.chars().all(|c| c.is_ascii_digit() || "+-., '".contains(c)) && cell.chars().any(|c| c.is_ascii_digit());
    let with_unit = cell
        .split_once(' ')
        .is_some_and(|(value, unit)| number(value).is_some() && unit.chars().all(char::is_alphabetic));
    if grouped {
        "write it without marks between thousands".to_string()
    } else if with_unit {
        "write the number without its unit, and give that as --units".to_string()
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
    fn separators() {
        for (line, separator) in [
            ("1,2,3", Separator::Comma),
            ("1;2", Separator::Semicolon),
            ("0,1;0,2", Separator::Semicolon),
            ("1\t2", Separator::Tab),
            ("0,1\t0,2", Separator::Tab),
            ("1,\t2,\t3", Separator::Comma),
            ("mic, left\tevent", Separator::Tab),
            ("1.0e+00 2.5e+00", Separator::Blanks),
            ("0,1 0,2", Separator::Blanks),
            ("1, 2, 3", Separator::Comma),
            ("\"a;b\",c", Separator::Comma),
            ("alone", Separator::Comma),
            ("", Separator::Comma),
        ] {
            assert_eq!(Separator::of(line), separator, "{line:?}");
        }
    }

    #[test]
    fn numbers_with_point_and_comma() {
        assert_eq!(
            [number("1,5"), number("-1.5e3"), number("7"), number("1.234,5"), number("1,234,567")],
            [Some(1.5), Some(-1500.0), Some(7.0), None, None]
        );
        let mut decimals = Decimals::default();
        assert_eq!([decimals.number("3"), decimals.number("1,5"), decimals.number("2,5")], [Ok(3.0), Ok(1.5), Ok(2.5)]);
        assert!(decimals.number("1.5").unwrap_err().contains("','"));
        assert!(decimals.number("1.234,5").unwrap_err().contains("thousands"));
        assert!(decimals.number("3 ms").unwrap_err().contains("--units"));
        assert!(decimals.number("x").unwrap_err().contains("leave the cell empty"));
        assert!(decimals.number("n/a").unwrap().is_nan());
    }
}
