//! What makes the networks of a minimal solver doubtful.

use super::nodes::Nodes;
use crate::degeneracy::list;
use serde::{Serialize, Serializer};
use thiserror::Error;

/// Why the networks of a [`MinimalSolution`](super::MinimalSolution) may not be all there are, or
/// cannot be told apart. In JSON it is its text.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SolveWarning {
    /// Some paths have come to no end.
    #[error(
        "{lost} of {tracked} paths were lost: the list of networks may not be whole; nodes may lie in one line, nearly coincide or be \
         placed symmetrically"
    )]
    PathsLost {
        /// Paths lost.
        lost: usize,
        /// Paths tracked.
        tracked: usize,
    },
    /// The data fit networks with all nodes of a kind exactly in one line, so that each node of the
    /// other kind may be its mirror image.
    #[error(
        "the {kind} {} lie exactly in one line: every {} may be its mirror image{}; move some {kind} off the line",
        list(names), kind.others(), if *listed { ", and all these networks are among those found" } else { ", more than are listed" }
    )]
    InOneLine {
        /// Which nodes.
        kind: Nodes,
        /// Their names.
        names: Vec<String>,
        /// Whether all mirror images are among the candidates; of many nodes there would be too
        /// many.
        listed: bool,
    },
    /// In a physical candidate the nodes of a kind lie in one line, as far as the data tell.
    #[error(
        "in a network that fits, the {kind} {} lie in one line: the data cannot tell on which side of it the other nodes lie; move some \
         {kind} off the line",
        list(names)
    )]
    NearlyInOneLine {
        /// Which nodes.
        kind: Nodes,
        /// Their names.
        names: Vec<String>,
    },
}

impl Serialize for SolveWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
