//! What the commands read: files, or standard input for `-`.

use std::path::Path;

use cli::input::{is_standard, name, source};
use tdoa::calibrate::KnownDistance;
use tdoa::read::{self, Nodes, ReadOptions, Units};
use tdoa::{Emissions, Pseudoranges};

use crate::Failure;

/// Measurements, in any form that the library reads.
pub(crate) fn measurements(path: &Path, options: ReadOptions) -> Result<Pseudoranges, Failure> {
    let is_turned = options.transpose;
    let read = if is_standard(path) {
        read::read_from(source(path)?, Path::new(&name(path)), options)
    } else {
        read::read(path, options)
    };
    let measured = read.map_err(Failure::unusable)?;
    // Said before the work, which may take long and end in nothing.
    if let Some(doubt) = read::orientation(&measured).filter(|_| !is_turned) {
        eprintln!("note: {}: {doubt}", name(path));
    }
    Ok(measured)
}

/// Known positions.
pub(crate) fn nodes(path: &Path) -> Result<Nodes, Failure> {
    let read =
        if is_standard(path) { read::read_nodes_from(source(path)?, &name(path)) } else { read::read_nodes(path) };
    read.map_err(Failure::unusable)
}

/// Known distances between receivers of these names.
pub(crate) fn distances(path: &Path, names: &[String]) -> Result<Vec<KnownDistance>, Failure> {
    let read = if is_standard(path) {
        read::read_distances_from(source(path)?, &name(path), names)
    } else {
        read::read_distances(path, names)
    };
    read.map_err(Failure::unusable)
}

/// When each transmitter of a table sends, metres, where this is known of it.
pub(crate) fn emission_times(
    path: &Path,
    measured: &Pseudoranges,
    units: Units,
    emissions: Emissions,
) -> Result<Vec<f64>, Failure> {
    let read = if is_standard(path) {
        read::read_emission_times_from(source(path)?, &name(path), measured, units, emissions)
    } else {
        read::read_emission_times(path, measured, units, emissions)
    };
    read.map_err(Failure::unusable)
}

/// The recorder of each receiver of a table.
pub(crate) fn recorders(path: &Path, measured: &Pseudoranges) -> Result<Vec<String>, Failure> {
    let read = if is_standard(path) {
        read::read_recorders_from(source(path)?, &name(path), measured)
    } else {
        read::read_recorders(path, measured)
    };
    read.map_err(Failure::unusable)
}
