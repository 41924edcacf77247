//! How paths end: plain records, which may come from another thread or another machine.

use super::fingerprints::Fingerprint;
use crate::refine::Refined;
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
    pub(crate) end: RecordEnd,
}

/// How a path ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum RecordEnd {
    /// Not known.
    Lost,
    /// At a regular solution.
    Regular(Refined),
    /// Not yet: it awaits the endgame at this `t`.
    Open {
        /// Where it is.
        t: f64,
        /// Its point there.
        point: Vec<Complex64>,
    },
    /// Not yet: it came to the target, but not to a regular solution, and is to be tracked again up
    /// to the endgame.
    Undecided {
        /// Where it begins.
        start: Vec<Complex64>,
    },
    /// At a solution at which the Jacobian is singular.
    Singular(SingularEnd),
    /// At infinity.
    Infinite {
        /// Valuations times the winding number.
        valuations: Vec<i64>,
        /// The winding number.
        winding: usize,
    },
}

/// The end of a path at a solution at which the Jacobian is singular.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SingularEnd {
    pub(crate) point: Vec<Complex64>,
    pub(crate) winding: usize,
    /// Error of the point, relative to the size of the path.
    pub(crate) error: f64,
}

impl Record {
    /// The record of a path about which nothing is known.
    pub(crate) fn lost(path: usize) -> Record {
        Record { path, begun: None, middle: None, end: RecordEnd::Lost }
    }

    /// Whether all points have so many coordinates.
    pub(super) fn fits(&self, unknowns: usize) -> bool {
        let fits = |point: &[Complex64]| point.len() == unknowns;
        let fingerprints = self.begun.iter().chain(&self.middle);
        fingerprints.filter_map(Fingerprint::point).all(fits)
            && match &self.end {
                RecordEnd::Lost => true,
                RecordEnd::Regular(end) => fits(&end.point),
                RecordEnd::Open { point, .. } => fits(point),
                RecordEnd::Undecided { start } => fits(start),
                RecordEnd::Singular(end) => fits(&end.point) && end.winding > 0,
                RecordEnd::Infinite { valuations, winding } => valuations.len() == unknowns && *winding > 0,
            }
    }

    /// Whether the path has not ended yet.
    pub(crate) fn is_open(&self) -> bool {
        matches!(self.end, RecordEnd::Open { .. } | RecordEnd::Undecided { .. })
    }
}
