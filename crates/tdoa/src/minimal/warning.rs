//! What makes the networks of a minimal solver doubtful.

use super::node_kind::NodeKind;
use crate::degeneracy::list;
use crate::quantity::length;
use hc::poly::{counted, one_or};
use serde::{Serialize, Serializer};
use thiserror::Error;

/// Why the networks of a [`MinimalSolution`](super::MinimalSolution) may be incomplete, or cannot
/// be told apart. In JSON a warning is its text.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MinimalWarning {
    /// Some paths were lost.
    #[error(
        "{lost} of {} {} lost: the list of networks may not be whole; nodes may lie in one line or plane, nearly coincide or be placed \
         symmetrically",
        counted(*.tracked, "path"),
        one_or(*.lost, "was", "were")
    )]
    PathsLost {
        /// Number of lost paths.
        lost: usize,
        /// Number of tracked paths.
        tracked: usize,
    },
    /// Solutions in space that generic data have are at infinity here.
    #[error(
        "{diverged} of {} {} to infinity: four transmitters or all receivers may lie in one plane, and the network be none of these",
        counted(*.tracked, "path"),
        one_or(*.diverged, "goes", "go")
    )]
    PathsDiverge {
        /// Number of paths that diverge.
        diverged: usize,
        /// Number of tracked paths.
        tracked: usize,
    },
    /// The data fit networks with all nodes of one kind exactly in one line; each node of the other
    /// kind may then be its mirror image.
    #[error(
        "the {kind} {} lie exactly in one line: every {} may be its mirror image{}; move some {kind} off the line",
        list(names), kind.others(), if *listed { ", and all these networks are among those found" } else { ", more than are listed" }
    )]
    InOneLine {
        /// The kind of these nodes.
        kind: NodeKind,
        /// Their names.
        names: Vec<String>,
        /// Whether all mirror images are among the candidates; for many nodes there would be too
        /// many.
        listed: bool,
    },
    /// The nodes of one kind lie in one line in a physical candidate, as far as the data tell.
    #[error(
        "in a network that fits, the {kind} {} lie in one line: the data cannot tell on which side of it the other nodes lie; move some \
         {kind} off the line",
        list(names)
    )]
    NearlyInOneLine {
        /// The kind of these nodes.
        kind: NodeKind,
        /// Their names.
        names: Vec<String>,
    },
    /// The nodes of one kind lie in one plane in the network in space, as far as the data tell.
    #[error(
        "in the network that fits, the {kind} {} lie in one plane: the data cannot tell on which side of it the other nodes lie; move some \
         {kind} off the plane or, if all nodes lie in one, solve in the plane",
        list(names)
    )]
    NearlyInOnePlane {
        /// The kind of these nodes.
        kind: NodeKind,
        /// Their names.
        names: Vec<String>,
    },
    /// More measurements than unknowns contradict each other.
    #[error(
        "the best network leaves residuals of {} (root mean square), and the tolerance is {}: some measurements are wrong, or the nodes do \
         not lie as the solver needs them; use `calibrate`, or give the noise as the tolerance",
        length(*residual),
        length(*tolerance)
    )]
    NotExplained {
        /// Root mean square of the residuals, metres.
        residual: f64,
        /// What [`MinimalOptions::tolerance`](super::MinimalOptions::tolerance) allows, metres.
        tolerance: f64,
    },
}

impl Serialize for MinimalWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
