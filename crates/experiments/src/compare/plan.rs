//! What a comparison measures, and with which programs.

use std::path::PathBuf;

/// What is measured, and how.
pub(super) struct Plan {
    pub(super) quick: bool,
    pub(super) repeats: u32,
    pub(super) instances: u64,
    pub(super) limit: u32,
    pub(super) systems: PathBuf,
}

/// Where the programs of this workspace are, and which peers there are.
pub(super) struct Tools {
    pub(super) hc: PathBuf,
    pub(super) tdoa: PathBuf,
    pub(super) phc: bool,
    pub(super) macaulay2: bool,
    pub(super) gfan: bool,
}
