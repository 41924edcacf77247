//! Paths with their ends: plain records, which may come from another thread or another machine.

use super::fingerprints::Fingerprint;
use crate::endgame::Ending;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// A path and its end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// The number of the path.
    pub(crate) path: usize,
    /// Where it began, if it was tracked there.
    pub(crate) begun: Option<Fingerprint>,
    /// Where it was at a common radius, if it went through the endgame.
    pub(crate) middle: Option<Fingerprint>,
    /// How it ends.
    pub(crate) end: Ending,
}

impl Record {
    /// The record of a path about which nothing is known.
    pub(crate) fn lost(path: usize) -> Record {
        Record { path, begun: None, middle: None, end: Ending::Lost }
    }

    /// Whether all points have so many coordinates.
    pub(super) fn fits(&self, unknowns: usize) -> bool {
        let fits = |point: &[Complex64]| point.len() == unknowns;
        let fingerprints = self.begun.iter().chain(&self.middle);
        fingerprints.filter_map(Fingerprint::point).all(fits)
            && match &self.end {
                Ending::Lost => true,
                Ending::Regular(end) => fits(&end.point),
                Ending::Open { point, .. } => fits(point),
                Ending::Undecided { start } => fits(start),
                Ending::Singular(end) => fits(&end.point) && end.winding > 0,
                Ending::Infinite { valuations, winding } => valuations.len() == unknowns && *winding > 0,
            }
    }

    /// Whether the path has not ended yet.
    pub(crate) fn is_open(&self) -> bool {
        matches!(self.end, Ending::Open { .. } | Ending::Undecided { .. })
    }
}
