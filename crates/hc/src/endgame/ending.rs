//! How paths end.

use num_complex::Complex64;

/// How a path ends, after its endgame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub(crate) enum EndKind {
    /// At a point; after `winding` turns round zero the path returns to its beginning.
    Finite {
        /// Winding number.
        winding: usize,
        /// Error of the point, relative to the path's size on the last loop.
        error: f64,
    },
    /// At a point to which the path could be tracked like a regular one.
    Reached,
    /// At infinity: coordinate `j` is of order `t^(valuations[j] / winding)`, and at least one
    /// valuation is negative.
    Infinite {
        /// Winding number; if no loop was clear, the least for which the valuations are integers.
        winding: usize,
        /// The direction: valuations times the winding number.
        valuations: Vec<i64>,
    },
    /// Unknown: the path could not be tracked, or no loop closed and showed a decaying series.
    Lost,
}

/// A path and its end.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ending {
    /// Index of the path, as given.
    pub(crate) path: usize,
    /// How it ends.
    pub(crate) kind: EndKind,
    /// The end if it is finite, otherwise the last point.
    pub(crate) point: Vec<Complex64>,
    /// The point at the first radius, common to all paths: two that coincide here have crossed.
    /// Empty if not reached.
    pub(crate) middle: Vec<Complex64>,
    /// Radius of the last loop.
    pub(crate) radius: f64,
}

/// A path that goes to the endgame: its index, its `t > 0` and its point there.
pub(crate) type Handed<'a> = (usize, f64, &'a [Complex64]);
