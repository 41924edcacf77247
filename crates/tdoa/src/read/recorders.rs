//! Recorders of receivers: `receiver,recorder`, with or without a header.

use std::io::Read;
use std::path::Path;

use super::cells::Table;
use super::error::ReadError;
use super::numbers::shorten;
use super::source::{open, text};
use crate::pseudoranges::Pseudoranges;

/// Reads the recorder of each receiver of a table. Receivers that the file does not name keep theirs.
///
/// # Errors
/// A file that cannot be read, lines without two entries, a receiver that is given twice or is none of the table's.
pub fn read_recorders(path: &Path, measured: &Pseudoranges) -> Result<Vec<String>, ReadError> {
    let file = path.display().to_string();
    read_recorders_from(open(path, &file)?, &file, measured)
}

/// Reads recorders as [`read_recorders`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read_recorders`].
pub fn read_recorders_from(source: impl Read, file: &str, measured: &Pseudoranges) -> Result<Vec<String>, ReadError> {
    let text = text(source, file)?;
    let names = measured.receiver_names();
    let mut all: Vec<String> = (0..names.len()).map(|i| measured.recorder_name(i).to_string()).collect();
    let mut told = vec![false; names.len()];
    for (index, record) in Table::new(&text, file).records().enumerate() {
        let record = record?;
        if record.is_blank() {
            continue;
        }
        let bad = |problem: String| ReadError::Line { file: file.to_string(), line: record.line, problem };
        let [receiver, recorder, ..] = record.cells.as_slice() else {
            return Err(bad("needs the names of a receiver and of its recorder".to_string()));
        };
        match names.iter().position(|name| name == receiver) {
            Some(i) if told[i] => return Err(bad(format!("{:?} is there twice", shorten(receiver)))),
            Some(i) => (all[i], told[i]) = (recorder.to_string(), true),
            None if index == 0 => {}
            None => {
                return Err(bad(format!(
                    "no receiver is named {:?}; the first is {:?}",
                    shorten(receiver),
                    names.first()
                )));
            }
        }
    }
    if !told.contains(&true) {
        return Err(ReadError::Line {
            file: file.to_string(),
            line: 1,
            problem: "has no recorders; expected lines receiver,recorder".to_string(),
        });
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::read_recorders_from;
    use crate::pseudoranges::Pseudoranges;

    #[test]
    fn recorders_are_those_of_the_table_or_of_names() {
        let names = ["a:1", "a:2", "b", "c:x"].map(str::to_string).to_vec();
        let measured = Pseudoranges::new(4, 1, vec![1.0; 4]).unwrap().with_receiver_names(names).unwrap();
        assert_eq!(measured.recorders(), [0, 0, 1, 2]);
        let read = |text: &str| read_recorders_from(text.as_bytes(), "r.csv", &measured);
        let recorders = read("receiver,recorder\nb,a\na:2,second\n").unwrap();
        assert_eq!(recorders, ["a", "second", "a", "c:x"]);
        assert_eq!(measured.clone().with_recorders(recorders).unwrap().recorders(), [0, 1, 0, 2]);
        for (text, part) in [
            ("b,a\nb,c\n", "line 2: \"b\" is there twice"),
            ("receiver,recorder\nd,a\n", "no receiver is named \"d\""),
            ("b\n", "needs the names"),
            ("receiver,recorder\n", "has no recorders"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        assert!(measured.with_recorders(vec![String::new()]).is_err());
    }
}
