//! What `hc monodromy` and `hc track` read: families, and their fibres.

use crate::input;
use cli::Failure;
use hc::family::{Multiple, StartFile};
use hc::poly::counted;
use hc::{Family, FamilyError, Fibre};
use std::path::Path;

/// Multiplicities that a summary lists.
const LISTED: usize = 20;

/// Reads a family in plain text or TOML.
pub(crate) fn read(path: &Path) -> Result<Family, Failure> {
    input::text(path)?.parse().map_err(|e| Failure::in_file(path, e))
}

/// Why the work on a family of this file failed.
pub(crate) fn failure(file: &Path, error: FamilyError) -> Failure {
    match error {
        FamilyError::Checkpoint(error) => Failure::unusable(error),
        FamilyError::Ranks(error) => Failure::unusable(error),
        error @ FamilyError::Special { .. } => Failure::Undetermined(error.to_string()),
        error => Failure::in_file(file, error),
    }
}

/// Reads a stored fibre, or a first pair, of a family, and the solutions that are multiple for all parameters.
pub(crate) fn fibre(family: &Family, path: &Path) -> Result<(Fibre, Vec<Multiple>), Failure> {
    let file = StartFile::from_json(&input::text(path)?).map_err(|e| Failure::in_file(path, e))?;
    let fibre = family.stored(&file).map_err(|e| Failure::in_file(path, e))?;
    Ok((fibre, file.multiple))
}

/// What a summary says of solutions that are multiple for all parameters; empty if there are none.
pub(crate) fn besides(multiple: &[Multiple]) -> String {
    if multiple.is_empty() {
        return String::new();
    }
    let multiplicities: Vec<String> = multiple.iter().take(LISTED).map(|m| m.multiplicity.to_string()).collect();
    format!(
        "besides, for all parameters: {} of multiplicity {}{}, to which no path leads\n",
        counted(multiple.len(), "solution"),
        multiplicities.join(", "),
        if multiple.len() > LISTED { ", ..." } else { "" }
    )
}
