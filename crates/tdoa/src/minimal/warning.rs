//! What makes the networks of a minimal solver doubtful.

use super::collinear::Collinear;
use crate::degeneracy::list;
use crate::network::{Candidate, Network, PathCounts};
use crate::plane::flatness;
use crate::pseudoranges::Pseudoranges;
use serde::{Serialize, Serializer};
use std::fmt::{self, Display, Formatter};
use thiserror::Error;

/// The one kind of nodes or the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Nodes {
    /// Receivers.
    Receivers,
    /// Transmitters.
    Transmitters,
}

impl Display for Nodes {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Nodes::Receivers => "receivers",
            Nodes::Transmitters => "transmitters",
        })
    }
}

impl Nodes {
    /// Where they are.
    pub(crate) fn positions(self, network: &Network) -> &[[f64; 2]] {
        match self {
            Nodes::Receivers => &network.receivers,
            Nodes::Transmitters => &network.transmitters,
        }
    }

    fn names(self, measured: &Pseudoranges) -> Vec<String> {
        match self {
            Nodes::Receivers => measured.receiver_names().to_vec(),
            Nodes::Transmitters => measured.transmitter_names().to_vec(),
        }
    }

    fn others(self) -> &'static str {
        match self {
            Nodes::Receivers => "transmitter",
            Nodes::Transmitters => "receiver",
        }
    }
}

/// Why the networks of a [`MinimalSolution`](crate::network::MinimalSolution) may not be all there are, or cannot be told apart. In JSON
/// it is its text.
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
    /// The data fit networks with all nodes of a kind exactly in one line, so that each node of the other kind may be its mirror image.
    #[error(
        "the {kind} {} lie exactly in one line: every {} may be its mirror image{}; move some {kind} off the line",
        list(names), kind.others(), if *listed { ", and all these networks are among those found" } else { ", more than are listed" }
    )]
    InOneLine {
        /// Which nodes.
        kind: Nodes,
        /// Their names.
        names: Vec<String>,
        /// Whether all mirror images are among the candidates; of many nodes there would be too many.
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

/// Physical candidates flatter than this are said to lie in one line; exact data tell no more of them.
const FLAT: f64 = 1e-4;

/// What there is to say of the candidates; `line` is what the data show to lie exactly in one line.
pub(super) fn warnings(
    measured: &Pseudoranges,
    paths: &PathCounts,
    candidates: &[Candidate],
    line: Option<&Collinear>,
) -> Vec<SolveWarning> {
    let mut warnings = Vec::new();
    if paths.failed > 0 {
        warnings.push(SolveWarning::PathsLost { lost: paths.failed, tracked: paths.tracked });
    }
    for kind in [Nodes::Receivers, Nodes::Transmitters] {
        let flat = |c: &Candidate| c.physical && flatness(kind.positions(&c.network)) < FLAT;
        if let Some(line) = line.filter(|line| line.kind == kind) {
            warnings.push(SolveWarning::InOneLine { kind, names: kind.names(measured), listed: line.all_listed() });
        } else if candidates.iter().any(flat) {
            warnings.push(SolveWarning::NearlyInOneLine { kind, names: kind.names(measured) });
        }
    }
    warnings
}
