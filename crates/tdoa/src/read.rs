//! Pseudoranges from files: a CSV matrix, a CSV list with one measurement a line, NumPy's .npy, or
//! MATLAB's .mat.

mod cells;
mod distances;
mod error;
mod heading;
mod list;
mod mat;
mod nodes;
mod npy;
mod source;
mod table;
mod units;

use std::io::Read;
use std::path::Path;

pub use distances::{read_distances, read_distances_from};
pub use error::{MAX_BYTES, ReadError};
pub use heading::heads_list;
pub use nodes::{Node, Nodes, read_mat_nodes, read_mat_transmitters, read_nodes, read_nodes_from};
pub use source::is_mat;
pub use units::{ReadOptions, Units};

use crate::pseudoranges::Pseudoranges;
use source::{has_extension, open, text};

/// Reads pseudoranges from a file: `.npy` and `.mat` by their extension, else CSV.
///
/// The CSV is a matrix, receivers in rows and transmitters in columns, empty or `nan` where nothing
/// was measured, with an optional first line that names the transmitters and an optional first
/// column that names the receivers (headed by `receiver`, `id`, `name` or nothing, or by any word
/// if names stand below it); or a list of one measurement a line with a first line that names the
/// columns receiver (or mic, microphone, channel, anchor, sensor, station, node), transmitter (or
/// event, shot, source, emitter, sound, tag, beacon), value (or pseudorange, range, distance, time,
/// toa, arrival) and optionally sigma, a standard deviation for each measurement. A unit behind a
/// name, as in `arrival time (ms)`, must be that of the options. Cells are separated by semicolons,
/// tabs, commas or blanks, whichever the first line has; with any but commas, numbers may have
/// decimal commas. The text is UTF-8, or UTF-16 with a byte order mark.
///
/// # Errors
/// With file, line, column and the names of the nodes, and what to do.
pub fn read(path: &Path, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let options = options.into();
    check_variable(path, &options)?;
    read_from(open(path, &path.display().to_string())?, path, options)
}

/// Reads an open source as [`read`] reads a file of this name.
///
/// # Errors
/// Those of [`read`].
pub fn read_from(source: impl Read, name: &Path, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let (file, path, options) = (name.display().to_string(), name, options.into());
    check_variable(path, &options)?;
    if has_extension(path, "npy") {
        read_npy(source, &file, options)
    } else if is_mat(path) {
        read_mat(source, &file, options)
    } else {
        read_csv(source, &file, options)
    }
}

/// Refuses a variable of a file that has none.
fn check_variable(path: &Path, options: &ReadOptions) -> Result<(), ReadError> {
    if options.variable.is_none() || is_mat(path) {
        return Ok(());
    }
    let problem = "has no variables; --variable is for .mat files".to_string();
    Err(ReadError::Variable { file: path.display().to_string(), problem })
}

/// Reads CSV as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read`].
pub fn read_csv(source: impl Read, file: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let units = options.into().units;
    // A wrong speed is said before the file is read.
    units.unwrap_or_default().factor()?;
    let text = text(source, file)?;
    table::parse(&text, file, units)
}

/// Reads a .npy array as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read`].
pub fn read_npy(source: impl Read, file: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let factor = options.into().units.unwrap_or_default().factor()?;
    npy::parse(source.take(MAX_BYTES), file, factor)
}

/// Reads a matrix (receivers in rows) of a .mat file as [`read`] does: the variable that is asked
/// for, else z, else the only matrix there is; `file` names the source in errors.
///
/// # Errors
/// Those of [`read`].
pub fn read_mat(source: impl Read, file: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let options = options.into();
    let factor = options.units.unwrap_or_default().factor()?;
    mat::parse(source, file, options.variable.as_deref(), factor)
}

#[cfg(test)]
mod tests;
