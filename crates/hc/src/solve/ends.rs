//! How the paths of the coefficient stage end.

use super::record::SingularEnd;
use crate::refine::Refined;
use crate::store::Records;
use std::collections::BTreeMap;

/// How a path ends, in four bytes, because there is one for each path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct End(u32);

impl End {
    /// Not known.
    pub(super) const LOST: End = End(0);
    /// At a regular solution.
    pub(super) const REGULAR: End = End(1);
    /// At a solution at which the Jacobian is singular.
    pub(super) const SINGULAR: End = End(2);
    /// No longer sought, because all solutions are known ([`SolveOptions::known`](crate::SolveOptions::known)).
    pub(super) const DROPPED: End = End(3);

    /// At infinity, in the direction of this number.
    pub(super) fn infinite(direction: u32) -> End {
        End(direction.saturating_add(4))
    }

    /// The number of the direction, if the path ends at infinity.
    pub(super) fn direction(self) -> Option<usize> {
        self.0.checked_sub(4).map(|direction| direction as usize)
    }
}

/// The ends of all paths by their numbers.
pub(super) struct EndList {
    pub(super) count: usize,
    records: Records,
}

impl EndList {
    /// A list in which no end is known.
    pub(super) fn new(count: usize) -> Self {
        EndList { count, records: Records::new(4) }
    }

    pub(super) fn get(&mut self, path: usize) -> End {
        End(self.records.get(path).iter().fold(0, |end, &byte| end << 8 | u32::from(byte)))
    }

    pub(super) fn set(&mut self, path: usize, end: End) {
        self.records.set(path, &end.0.to_be_bytes());
    }
}

/// How all paths end. No points are kept for paths to infinity.
pub(super) struct Ends {
    /// Number of paths whose end is not known.
    pub(super) lost: usize,
    /// Number of paths whose end is no longer sought.
    pub(super) dropped: usize,
    /// The regular ends by the numbers of their paths.
    pub(super) regular: BTreeMap<usize, Refined>,
    /// The singular ends likewise.
    pub(super) singular: BTreeMap<usize, SingularEnd>,
    /// Directions of paths to infinity, in order: valuations in units of the reciprocal winding
    /// number, that number, and the number of paths.
    pub(super) directions: Vec<(Vec<i64>, usize, usize)>,
    /// How often a path was tracked again.
    pub(super) retracked: usize,
    /// Whether the paths were given up on trial; the ends are then not a result.
    pub(super) abandoned: bool,
}
