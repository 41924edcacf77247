//! What `hc monodromy` and `hc track` read: families, and their fibres.

use crate::input;
use cli::Failure;
use hc::family::StartFile;
use hc::{Family, FamilyError, Fibre};
use std::path::Path;

/// Reads a family in plain text or TOML.
pub(crate) fn read(path: &Path) -> Result<Family, Failure> {
    input::text(path)?.parse().map_err(|e| Failure::in_file(path, e))
}

/// Why the work on a family of this file failed.
pub(crate) fn failure(file: &Path, error: FamilyError) -> Failure {
    match error {
        FamilyError::Checkpoint(error) => Failure::unusable(error),
        FamilyError::Ranks(error) => Failure::unusable(error),
        error => Failure::in_file(file, error),
    }
}

/// Reads a stored fibre, or a first pair, of a family.
pub(crate) fn fibre(family: &Family, path: &Path) -> Result<Fibre, Failure> {
    let file = StartFile::from_json(&input::text(path)?).map_err(|e| Failure::in_file(path, e))?;
    let fibre = file.fibre().map_err(|e| Failure::in_file(path, e))?;
    family.check(&fibre).map_err(|e| Failure::in_file(path, e))?;
    Ok(family.folded(fibre))
}
