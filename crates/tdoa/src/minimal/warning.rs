//! What makes the networks of a minimal solver doubtful.

use super::node_kind::NodeKind;
use crate::degeneracy::list;
use hc::poly::{counted, one_or};
use serde::{Serialize, Serializer};
use thiserror::Error;

/// Why the networks of a [`MinimalSolution`](super::MinimalSolution) may be incomplete, or cannot
/// be told apart. In JSON a warning is its text.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MinimalWarning {
    /// Some paths were lost.
    #[error(
        "{lost} of {} {} lost: the list of networks may not be whole; nodes may lie in one line, nearly coincide or be placed \
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
}

impl Serialize for MinimalWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
