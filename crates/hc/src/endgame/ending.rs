//! How paths end: plain data, which may come from another thread or another machine.

use crate::refine::Refined;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// How a path ends, or how far it has come.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum Ending {
    /// Unknown: the path could not be tracked, or no loop closed and showed a decaying series.
    Lost,
    /// At a regular solution.
    Regular(Refined),
    /// Not known yet. At `t > 0` the path awaits the endgame; at zero it has come there, and could be tracked
    /// to its point like a regular path.
    Open {
        /// Where it is.
        t: f64,
        /// Its point there.
        point: Vec<Complex64>,
    },
    /// Not known yet: the path came to the target without the endgame, but not to a regular solution, and is to
    /// be tracked again up to the endgame.
    Undecided {
        /// Where it begins.
        start: Vec<Complex64>,
    },
    /// At a solution at which the Jacobian is singular, unless the winding number is one.
    Singular(SingularEnd),
    /// At infinity: coordinate `j` is of order `t^(valuations[j] / winding)`, and at least one valuation is
    /// negative.
    Infinite {
        /// Valuations times the winding number.
        valuations: Vec<i64>,
        /// Winding number; if no loop was clear, the least for which the valuations are integers.
        winding: usize,
    },
}

/// The end of a path at a point; after `winding` turns round `t = 0` the path returns to its beginning.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct SingularEnd {
    pub(crate) point: Vec<Complex64>,
    pub(crate) winding: usize,
    /// Error of the point, relative to the size of the path.
    pub(crate) error: f64,
}
