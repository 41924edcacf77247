//! Recordings with ground truth, read from folders.

use std::path::{Path, PathBuf};

use tdoa::Pseudoranges;
use tdoa::read::{Units, read, read_nodes};

use cli::Failure;

/// A recording and the positions of its receivers.
pub(super) struct Recording<const D: usize> {
    /// For the tables.
    pub(super) name: String,
    pub(super) measured: Pseudoranges,
    /// The positions that were measured by other means; `None` where unknown.
    pub(super) truth: Vec<Option<[f64; D]>>,
}

/// The table of a recording to read.
#[derive(Clone, Copy)]
pub(super) enum Measured {
    /// pseudoranges_m.csv
    Pseudoranges,
    /// ranges_m.csv
    Ranges,
}

impl Measured {
    fn file(self) -> &'static str {
        match self {
            Measured::Pseudoranges => "pseudoranges_m.csv",
            Measured::Ranges => "ranges_m.csv",
        }
    }
}

/// Reads folders with such a table and receivers_gt.csv. They are named by their last part, by their
/// last two where that is the same for several.
pub(super) fn open_all<const D: usize>(folders: &[PathBuf], table: Measured) -> Result<Vec<Recording<D>>, Failure> {
    let last = |folder: &Path| folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut recordings = Vec::new();
    for folder in folders {
        let mut name = last(folder);
        if folders.iter().filter(|other| last(other) == name).count() > 1 {
            name = format!("{}/{name}", folder.parent().map_or_else(String::new, last));
        }
        recordings.push(open(folder, name, table)?);
    }
    Ok(recordings)
}

fn open<const D: usize>(folder: &Path, name: String, table: Measured) -> Result<Recording<D>, Failure> {
    let measured = read(&folder.join(table.file()), Units::Metres).map_err(Failure::unusable)?;
    let nodes = read_nodes(&folder.join("receivers_gt.csv")).map_err(Failure::unusable)?;
    let truth = nodes.in_order(measured.receiver_names()).ok_or_else(|| {
        Failure::Unusable(format!(
            "{}: receivers_gt.csv is not for the receivers of {}",
            folder.display(),
            table.file()
        ))
    })?;
    if name.is_empty() || name.contains(',') {
        return Err(Failure::Unusable(format!("{}: give a folder with a name without commas", folder.display())));
    }
    Ok(Recording { name, measured, truth })
}
