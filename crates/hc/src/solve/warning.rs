//! What a reader of a list of solutions must know.

/// A way in which a list of solutions may be incomplete.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// The work was cancelled.
    #[error("interrupted: this is a partial result")]
    Partial,
    /// There are solutions that are not isolated.
    #[error("there are solution sets of positive dimension: {paths} paths end on them, at {points} points")]
    Components {
        /// Number of paths that end on them.
        paths: usize,
        /// Number of points at which these paths end.
        points: usize,
    },
    /// Finite ends that are not solutions.
    #[error("{paths} finite ends are left out: they do not solve all equations, or lie outside the torus")]
    Excess {
        /// Number of paths that end there.
        paths: usize,
    },
    /// Paths were lost from the first start system.
    #[error("{start_systems} start systems were used, since paths were lost")]
    Restarted {
        /// Number of start systems that were used.
        start_systems: u32,
    },
    /// Paths whose ends are not known.
    #[error("the list may be incomplete: it is not known where {paths} paths end")]
    Lost {
        /// Number of paths.
        paths: usize,
    },
    /// Ends at which the equations nearly vanish, but whose nature is not known.
    #[error("{ends} ends could not be judged; they are listed as unresolved")]
    Unresolved {
        /// Number of ends.
        ends: usize,
    },
    /// Regular solutions that could not be certified.
    #[error("{solutions} regular solutions are not certified")]
    Uncertified {
        /// Number of solutions.
        solutions: usize,
    },
}
