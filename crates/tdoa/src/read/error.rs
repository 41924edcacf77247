//! Why a file cannot be used.

use hc::poly::counted;
use thiserror::Error;

use crate::pseudoranges::{MAX_CELLS, PseudorangeError};

/// Largest file that is read: 512 MB, enough for [`MAX_CELLS`] cells of 20 characters.
pub const MAX_BYTES: u64 = 512_000_000;

/// What a first line may say, for messages.
pub(super) const ACCEPTED: &str = "a list of measurements has the columns receiver (or mic, microphone, channel, anchor, \
     sensor, station, node), transmitter (or event, shot, source, emitter, sound, tag, beacon), value (or pseudorange, range, distance, time, toa, \
     arrival) and, if wanted, sigma (or std), in any order; a matrix has the names of the transmitters in its first line, \
     after an empty cell or the word receiver where the rows begin with names; --columns receiver=...,transmitter=...,value=... says \
     which column is which";

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
    /// A ZIP archive or an old spreadsheet in the place of text.
    #[error(
        "{file}: is a spreadsheet (.xlsx, .ods, .xls) or an archive (.npz), not text; export the sheet as CSV, or save the \
         array with numpy.save"
    )]
    Packed {
        /// The file.
        file: String,
    },
    /// Not a text file.
    #[error(
        "{file}, line {line}: is no text (UTF-8, UTF-16 with a byte order mark, or Latin-1) from there on; give a CSV file, or \
         .npy or .mat with that extension"
    )]
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
    #[error("{file}, line {line}, column {column} ({place}): {text:?} is not a number; {remedy}")]
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
        /// What to do.
        remedy: String,
    },
    /// Rows of different lengths.
    #[error(
        "{file}, line {line} (receiver {receiver}): has {} in place of {expected}; every receiver needs a cell for every \
         transmitter, empty or nan if it was not measured",
        counted(*.found, "cell")
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
    /// A first line whose columns cannot be told apart.
    #[error("{file}, line {line}: {problem}; {}", ACCEPTED)]
    Heading {
        /// The file.
        file: String,
        /// The line.
        line: u64,
        /// What is wrong and what to do.
        problem: String,
    },
    /// Columns that are not what is needed, or of which it cannot be told what they hold.
    #[error("{file}, line {line}: {problem}")]
    Columns {
        /// The file.
        file: String,
        /// The line of the headings.
        line: u64,
        /// What is wrong and what to do.
        problem: String,
    },
    /// Numbers that may have marks between thousands.
    #[error("{file}: {problem}")]
    Thousands {
        /// The file.
        file: String,
        /// What is doubtful and what to do.
        problem: String,
    },
    /// Differences of times that do not give times.
    #[error("{file}: {problem}")]
    Pairs {
        /// The file.
        file: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// An option for tables of text, with another file.
    #[error("{file}: {option} is for tables of text")]
    TextAlone {
        /// The file.
        file: String,
        /// The option.
        option: &'static str,
    },
    /// A first line that names another unit than the one the numbers are taken to have.
    #[error("{file}, line {line}: {problem}")]
    Unit {
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
    /// A .mat file without the variable that is looked for, or a variable asked for of another kind
    /// of file.
    #[error("{file}: {problem}")]
    Variable {
        /// The file.
        file: String,
        /// What is wrong, which variables there are, and what to do.
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
    /// A sampling rate that is not positive.
    #[error("the sampling rate must be positive and finite, not {0} Hz; sound cards: 44100 or 48000")]
    Rate(f64),
}
