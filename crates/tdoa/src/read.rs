//! Pseudoranges from files: a CSV matrix, a CSV list with one measurement a line, NumPy's .npy, or
//! MATLAB's .mat.

mod candidates;
mod cells;
mod columns;
mod distances;
mod emission_times;
mod error;
mod first_column;
mod grid;
mod heading;
mod latin;
mod list;
mod mat;
mod nodes;
mod npy;
mod numbers;
mod orientation;
mod pairs;
mod recorders;
mod role;
mod source;
mod table;
mod thousands;
mod times;
mod units;
mod words;

use std::io::Read;
use std::path::Path;

pub use columns::heads_list;
pub use distances::{read_distances, read_distances_from};
pub use emission_times::{read_emission_times, read_emission_times_from};
pub use error::{MAX_BYTES, ReadError};
pub use nodes::{Node, Nodes, read_mat_nodes, read_mat_transmitters, read_nodes, read_nodes_from};
pub use orientation::orientation;
pub use recorders::{read_recorders, read_recorders_from};
pub use role::Role;
pub use source::is_mat;
pub use units::{ReadOptions, Units};

use crate::pseudoranges::Pseudoranges;
use source::{Form, form, open, text};

/// Reads pseudoranges from a file: `.npy` and `.mat` by their extension or their first bytes, else CSV.
///
/// The CSV is a matrix, receivers in rows and transmitters in columns, empty or `nan` where nothing
/// was measured, with an optional first line that names the transmitters and an optional first
/// column that names the receivers (headed by `receiver`, `id`, `name`, `serial` or nothing, or by any
/// word if names stand below it, or different whole numbers that are no measurements); or a list of one
/// measurement a line with a first line that names the
/// columns receiver (or mic, microphone, hydrophone, recorder, channel, anchor, sensor, station, node), transmitter (or
/// event, shot, source, call, emitter, sound, tag, beacon), value (or pseudorange, range, distance, time,
/// toa, arrival) and optionally sigma, a standard deviation for each measurement. Columns value2, value3, ... (toa2, and so
/// on) have further candidates for the value, where a detector found several; [`ReadOptions::candidates`] takes several
/// lines of one pair as such. A list with a column reference has
/// differences: the receiver's time minus that of the reference. Selection tables of Raven with a column Event are lists.
/// What headings do not say, [`ReadOptions::columns`] does. A unit behind a
/// name, as in `arrival time (ms)`, must be that of the options. Times may be moments of ISO 8601, which count from the
/// first on. Cells are separated by semicolons,
/// tabs, commas or blanks, whichever the first line has or, as in `sep=;`, says; with any but commas, numbers may have
/// decimal commas. The text is UTF-8, UTF-16 with a byte order mark, or Latin-1.
///
/// # Errors
/// With file, line, column and the names of the nodes, and what to do.
pub fn read(path: &Path, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let options = options.into();
    read_from(open(path, &path.display().to_string())?, path, options)
}

/// Reads an open source as [`read`] reads a file of this name.
///
/// # Errors
/// Those of [`read`].
pub fn read_from(source: impl Read, name: &Path, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let (file, options) = (name.display().to_string(), options.into());
    let (form, source) = form(source, name, &file)?;
    check_variable(form, &file, &options)?;
    match form {
        Form::Npy => read_npy(source, &file, options),
        Form::Mat => read_mat(source, &file, options),
        Form::Text => read_csv(source, &file, options),
    }
}

/// Refuses a variable of a file that has none.
fn check_variable(form: Form, file: &str, options: &ReadOptions) -> Result<(), ReadError> {
    if options.variable.is_none() || form == Form::Mat {
        return Ok(());
    }
    let problem = "has no variables; --variable is for .mat files".to_string();
    Err(ReadError::Variable { file: file.to_string(), problem })
}

/// Reads CSV as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read`].
pub fn read_csv(source: impl Read, file: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let options = options.into();
    // A wrong speed is said before the file is read.
    options.units.unwrap_or_default().factor()?;
    let text = text(source, file)?;
    table::parse(&text, file, &options)
}

/// Reads a .npy array as [`read`] does; `file` names the source in errors.
///
/// # Errors
/// Those of [`read`].
pub fn read_npy(source: impl Read, file: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let options = options.into();
    options.refuse_text(file)?;
    let factor = options.units.unwrap_or_default().factor()?;
    turned(npy::parse(source.take(MAX_BYTES), file, factor)?, &options, file)
}

/// Reads a matrix (receivers in rows) of a .mat file as [`read`] does: the variable that is asked
/// for, else z, else the only matrix there is; `file` names the source in errors.
///
/// # Errors
/// Those of [`read`].
pub fn read_mat(source: impl Read, file: &str, options: impl Into<ReadOptions>) -> Result<Pseudoranges, ReadError> {
    let options = options.into();
    options.refuse_text(file)?;
    let factor = options.units.unwrap_or_default().factor()?;
    turned(mat::parse(source, file, options.variable.as_deref(), factor)?, &options, file)
}

/// A matrix without names, with its rows as columns where the options say so.
fn turned(measured: Pseudoranges, options: &ReadOptions, file: &str) -> Result<Pseudoranges, ReadError> {
    if !options.transpose {
        return Ok(measured);
    }
    let cells = measured.cells().iter().map(|(i, j, value)| (j, i, *value));
    let turned = Pseudoranges::from_cells(measured.transmitters(), measured.receivers(), cells);
    turned.map_err(|source| ReadError::Matrix { file: file.to_string(), source })
}

#[cfg(test)]
mod tests;
