//! Text as records of cells.

use std::borrow::Cow;

use super::error::ReadError;
use super::words::MISSING;

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

/// The records of a text, read lazily: a bad line is reported before the rest is looked at.
pub(super) struct Table<'a> {
    text: Cow<'a, str>,
    file: &'a str,
    /// What stands between its cells.
    pub(super) separator: Separator,
    /// Lines before the text.
    skipped: u64,
}

impl<'a> Table<'a> {
    pub(super) fn new(text: &'a str, file: &'a str) -> Table<'a> {
        let (said, text, skipped) = said_separator(text);
        let first = text.lines().find(|line| !line.trim().is_empty() && !is_comment(line)).unwrap_or("");
        let separator = said.unwrap_or_else(|| Separator::of(first));
        // Comments are emptied where a cell for something missing begins like one.
        let text = if text.lines().any(|line| line.starts_with('#') && !is_comment(line)) {
            text.split_inclusive('\n').map(|line| if is_comment(line) { "\n" } else { line }).collect::<String>().into()
        } else {
            Cow::Borrowed(text)
        };
        Table { text, file, separator, skipped }
    }

    /// The lines that are not empty.
    pub(super) fn records(&self) -> impl Iterator<Item = Result<Record, ReadError>> + '_ {
        let (text, separator) = (&*self.text, self.separator);
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(separator.delimiter())
            .trim(csv::Trim::All)
            .comment(matches!(self.text, Cow::Borrowed(_)).then_some(b'#'))
            .from_reader(text.as_bytes());
        let records = reader.into_records().map(move |record| {
            let record = record.map_err(|error| ReadError::Line {
                file: self.file.to_string(),
                line: self.skipped + error.position().map_or(1, |position| line_at(text, position)),
                problem: format!("cannot be read as CSV ({error})"),
            })?;
            let line = self.skipped + record.position().map_or(1, |position| line_at(text, position));
            let cells = record.iter().filter(|cell| separator != Separator::Blanks || !cell.is_empty());
            Ok(Record { line, cells: cells.map(|cell| unquoted(cell).to_string()).collect() })
        });
        // A line of blanks is an empty line.
        records.filter(|record| record.as_ref().map_or(true, |record| record.cells.len() > 1 || !record.is_blank()))
    }
}

/// The separator that a first line `sep=;` says, as Excel writes and reads it, the text below that
/// line, and the number of lines before that.
fn said_separator(text: &str) -> (Option<Separator>, &str, u64) {
    let (line, rest) = text.split_once('\n').unwrap_or((text, ""));
    let said = line.trim_matches(['\r', ' ', '"']);
    let word = said.get(..4).filter(|word| word.eq_ignore_ascii_case("sep="));
    let separator = match word.and_then(|_| said.get(4..)) {
        Some(",") => Separator::Comma,
        Some(";") => Separator::Semicolon,
        Some("\t") => Separator::Tab,
        Some("") if line.contains("= ") => Separator::Blanks,
        _ => return (None, text, 0),
    };
    (Some(separator), rest, 1)
}

/// Whether a line is a comment, and does not begin with a cell such as `#N/A`.
fn is_comment(line: &str) -> bool {
    line.starts_with('#') && {
        let cell = line.split([',', ';', '\t', ' ', '\r', '\n']).next().unwrap_or_default();
        cell.len() < 2 || !MISSING.iter().any(|word| cell.eq_ignore_ascii_case(word))
    }
}

/// The line of a record. Its position is that of the empty lines and comments before it.
fn line_at(text: &str, position: &csv::Position) -> u64 {
    let rest = usize::try_from(position.byte()).ok().and_then(|byte| text.get(byte..)).unwrap_or("");
    let skipped = rest.lines().take_while(|line| line.is_empty() || is_comment(line)).count();
    position.line() + skipped as u64
}

/// A cell without quotes that have a blank before them.
fn unquoted(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|cell| cell.strip_suffix('"')).map_or(cell, str::trim)
}

/// What stands between cells.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Separator {
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
        // Of a date and a time, separated by a blank, come two before and after a comma.
        let decimal = has_decimal_commas(&bare) && !bare.contains(':');
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
            ("2024-05-12 05:30:35,2024-05-12 05:30:37", Separator::Comma),
            ("\"a;b\",c", Separator::Comma),
            ("alone", Separator::Comma),
            ("", Separator::Comma),
        ] {
            assert_eq!(Separator::of(line), separator, "{line:?}");
        }
    }

    #[test]
    fn comments_and_cells_for_what_is_missing() {
        let cells = |text: &str| -> Vec<(u64, String)> {
            let table = Table::new(text, "f");
            table.records().map(|record| record.unwrap()).map(|record| (record.line, record.cells.join("|"))).collect()
        };
        let line = |line: u64, cells: &str| (line, cells.to_string());
        assert_eq!(cells("# one\n1,2\n#N/A,4\n# two\n\n5,6\n"), [line(2, "1|2"), line(3, "#N/A|4"), line(6, "5|6")]);
        assert_eq!(cells("sep=;\r\na;1,5\r\n\r\nb;2\r\n"), [line(2, "a|1,5"), line(4, "b|2")]);
        assert_eq!(cells("\"sep=,\"\n1,5\n"), [line(2, "1|5")]);
        assert_eq!(cells("SEP=\t\n1\t2\n"), [line(2, "1|2")]);
        assert_eq!(cells("sep,a\n1,2\n"), [line(1, "sep|a"), line(2, "1|2")]);
    }
}
