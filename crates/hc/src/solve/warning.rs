//! What a reader of a list of solutions must know.

use crate::family::Limit;
use poly::{counted, one_or};

/// A way in which a list of solutions may be incomplete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// The work was cancelled.
    #[error("interrupted: this is a partial result")]
    Partial,
    /// There are solutions that are not isolated.
    #[error("there are solution sets of positive dimension: {} {} on them, at {}", counted(*.paths, "path"), one_or(*.paths, "ends", "end"), counted(*.points, "point"))]
    Components {
        /// Number of paths that end on them.
        paths: usize,
        /// Number of points at which these paths end.
        points: usize,
    },
    /// Finite ends that are not solutions.
    #[error("{} discarded: outside the torus, or not a solution of every equation", counted(*.paths, "finite end"))]
    Excess {
        /// Number of paths that end there.
        paths: usize,
    },
    /// Paths were lost from the first start system.
    #[error("{} used, since paths were lost", counted(*.start_systems, "start system"))]
    Restarted {
        /// Number of start systems that were used.
        start_systems: u32,
    },
    /// Paths whose ends are not known.
    #[error("the list may be incomplete: it is not known where {} {}", counted(*.paths, "path"), one_or(*.paths, "ends", "end"))]
    Lost {
        /// Number of paths.
        paths: usize,
    },
    /// Paths that a limit of effort left.
    #[error("{} left: {}", counted(*.paths, "path"), in_words(*.limit))]
    Limited {
        /// Number of paths.
        paths: usize,
        /// The limit.
        limit: Limit,
    },
    /// Ends at which the equations nearly vanish, but whose nature is not known.
    #[error("{} could not be judged, and {} listed as unresolved", counted(*.ends, "end"), one_or(*.ends, "is", "are"))]
    Unresolved {
        /// Number of ends.
        ends: usize,
    },
    /// Regular solutions that could not be certified.
    #[error("{} not certified", counted(*.solutions, "regular solution"))]
    Uncertified {
        /// Number of solutions.
        solutions: usize,
    },
}

fn in_words(limit: Limit) -> &'static str {
    match limit {
        Limit::Again => "no more may be tracked again within the limit of effort",
        Limit::Time => "the time limit was reached, and a slower or faster run may find fewer or more solutions",
    }
}
