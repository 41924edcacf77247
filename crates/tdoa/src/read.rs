//! Pseudoranges from files: a CSV matrix, a CSV list with one measurement a line, NumPy's .npy, or MATLAB's .mat.

mod distances;
mod mat;
mod nodes;
mod npy;
mod table;

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use thiserror::Error;

pub use distances::{read_distances, read_distances_from};
pub use nodes::{Nodes, read_mat_nodes, read_mat_transmitters, read_nodes, read_nodes_from};

use crate::pseudoranges::{MAX_CELLS, PseudorangeError, Pseudoranges};

/// Largest file that is read: 256 MB, enough for [`MAX_CELLS`] cells of 64 characters.
pub const MAX_BYTES: u64 = 64 * MAX_CELLS as u64;

/// How the numbers of a file become metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Units {
    /// They are metres. The default.
    #[default]
    Metres,
    /// They are seconds.
    Seconds {
        /// Propagation speed in metres a second.
        speed: f64,
    },
}

impl Units {
    fn factor(self) -> f64 {
        match self {
            Units::Metres => 1.0,
            Units::Seconds { speed } => speed,
        }
    }
}

/// Why a file cannot be used. Lines and columns count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be opened or read.
    #[error("{file}: {source}; check the path and its permissions")]
    Io {
        /// The file.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// A directory was given.
    #[error("{file}: is a directory; give a file in it, such as pseudoranges.csv")]
    Directory {
        /// The path.
        file: String,
    },
    /// More than [`MAX_BYTES`].
    #[error("{file}: is larger than {} MB, more than any usable table of pseudoranges; is it the right file?", MAX_BYTES / 1_000_000)]
    TooLarge {
        /// The file.
        file: String,
    },
    /// More than [`MAX_CELLS`] cells.
    #[error("{file}, line {line}: more than {MAX_CELLS} cells; split the recording")]
    TooManyCells {
        /// The file.
        file: String,
        /// Line at which the limit is passed.
        line: u64,
    },
    /// Not a text file.
    #[error("{file}, line {line}: is not UTF-8 text; give a CSV file (or .npy with that extension)")]
    NotText {
        /// The file.
        file: String,
        /// Line of the first bad byte.
        line: u64,
    },
    /// No measurement in it.
    #[error("{file}: has no measurements; expected a row of comma-separated pseudoranges for each receiver")]
    Empty {
        /// The file.
        file: String,
    },
    /// A cell that is no number.
    #[error(
        "{file}, line {line}, column {column} ({place}): {text:?} is not a number; leave the cell empty or write nan if it was \
         not measured"
    )]
    NotANumber {
        /// The file.
        file: String,
        /// Line of the cell.
        line: u64,
        /// Column of the cell.
        column: usize,
        /// Receiver and transmitter.
        place: String,
        /// What stands there.
        text: String,
    },
    /// Rows of different lengths.
    #[error(
        "{file}, line {line} (receiver {receiver}): has {found} cells where {expected} are expected; every receiver needs a \
         cell for every transmitter, empty or nan if it was not measured"
    )]
    Ragged {
        /// The file.
        file: String,
        /// Line of the row.
        line: u64,
        /// Name of the receiver.
        receiver: String,
        /// Cells of the first row.
        expected: usize,
        /// Cells of this row.
        found: usize,
    },
    /// A line of a list with the wrong number of cells, or an empty name.
    #[error("{file}, line {line}: {problem}")]
    Line {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A .npy file that is none, or of an unusable kind.
    #[error("{file}: {problem}; save a two-dimensional array of floats with numpy.save")]
    Npy {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// A .mat file that is none, or without what is looked for.
    #[error("{file}: {problem}; save the matrix z with save('-v7') or scipy.io.savemat")]
    Mat {
        /// The file.
        file: String,
        /// What is wrong.
        problem: String,
    },
    /// Numbers that form no matrix of pseudoranges.
    #[error("{file}: {source}")]
    Matrix {
        /// The file.
        file: String,
        /// What is wrong.
        source: PseudorangeError,
    },
    /// A propagation speed that is not positive.
    #[error("the propagation speed must be positive and finite, not {0} m/s; sound in air: 343, radio: 299792458")]
    Speed(f64),
}

/// Reads pseudoranges from a file: `.npy` and `.mat` (the variable z) by their extension, else CSV.
///
/// The CSV is a matrix, receivers in rows and transmitters in columns, empty or `nan` where nothing was measured, with an
/// optional first line that names the transmitters (then a first column headed `receiver`, `id`, `name` or nothing names
/// the receivers); or a list with the header `receiver,transmitter,value` and optionally `sigma`, a standard deviation
/// for each measurement. Cells are separated by commas, semicolons or tabs, whichever the first line has.
///
/// # Errors
/// With file, line, column and the names of the nodes, and what to do.
pub fn read(path: &Path, units: Units) -> Result<Pseudoranges, ReadError> {
    let file = path.display().to_string();
    let source = open(path, &file)?;
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
        read_npy(source, &file, units)
    } else if is_mat(path) {
        read_mat(source, &file, units)
    } else {
        read_csv(source, &file, units)
    }
}

/// Reads CSV as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// As [`read`].
pub fn read_csv(source: impl Read, file: &str, units: Units) -> Result<Pseudoranges, ReadError> {
    let factor = factor(units)?;
    let text = text(source, file)?;
    table::parse(&text, file, factor)
}

/// Reads a .npy array as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// As [`read`].
pub fn read_npy(source: impl Read, file: &str, units: Units) -> Result<Pseudoranges, ReadError> {
    let factor = factor(units)?;
    npy::parse(source.take(MAX_BYTES), file, factor)
}

/// Reads the variable z (receivers in rows) of a .mat file as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// As [`read`].
pub fn read_mat(source: impl Read, file: &str, units: Units) -> Result<Pseudoranges, ReadError> {
    let factor = factor(units)?;
    mat::parse(source, file, factor)
}

/// Whether a file is read as a .mat file, by its name.
pub fn is_mat(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("mat"))
}

fn factor(units: Units) -> Result<f64, ReadError> {
    let factor = units.factor();
    if factor > 0.0 && factor.is_finite() { Ok(factor) } else { Err(ReadError::Speed(factor)) }
}

fn open(path: &Path, file: &str) -> Result<BufReader<File>, ReadError> {
    let io = |source| ReadError::Io { file: file.to_string(), source };
    let meta = std::fs::metadata(path).map_err(io)?;
    if meta.is_dir() {
        return Err(ReadError::Directory { file: file.to_string() });
    }
    // Said before a byte is read.
    if meta.len() > MAX_BYTES {
        return Err(ReadError::TooLarge { file: file.to_string() });
    }
    Ok(BufReader::new(File::open(path).map_err(io)?))
}

/// The whole text. A file that is no text is refused at its first bad block, so that garbage is not read to its end.
fn text(mut source: impl Read, file: &str) -> Result<String, ReadError> {
    let mut bytes = Vec::new();
    let mut checked = 0;
    let mut block = vec![0u8; 1 << 16];
    loop {
        let count = match source.read(&mut block) {
            Ok(count) => count,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(source) => return Err(ReadError::Io { file: file.to_string(), source }),
        };
        if bytes.len() as u64 + count as u64 > MAX_BYTES {
            return Err(ReadError::TooLarge { file: file.to_string() });
        }
        bytes.extend_from_slice(&block[..count]);
        let not_text = |upto: usize, bytes: &[u8]| ReadError::NotText {
            file: file.to_string(),
            line: 1 + bytes[..upto].iter().filter(|&&b| b == b'\n').count() as u64,
        };
        match std::str::from_utf8(&bytes[checked..]) {
            Ok(part) => {
                if let Some(at) = part.find('\0') {
                    return Err(not_text(checked + at, &bytes));
                }
                checked = bytes.len();
            }
            Err(error) => {
                checked += error.valid_up_to();
                // A character cut off at the end of a block is completed by the next.
                if error.error_len().is_some() || count == 0 {
                    return Err(not_text(checked, &bytes));
                }
            }
        }
        if count == 0 {
            break;
        }
    }
    let text = String::from_utf8(bytes).map_err(|_| ReadError::NotText { file: file.to_string(), line: 1 })?;
    // Spreadsheets write a byte order mark.
    Ok(text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text))
}

#[cfg(test)]
mod tests;
