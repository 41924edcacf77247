//! The two kinds of nodes.

use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display, Formatter};

/// One of the two kinds of nodes; of a single node in JSON, `"receiver"` or `"transmitter"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum NodeKind {
    /// Receivers.
    #[serde(rename = "receiver")]
    Receivers,
    /// Transmitters.
    #[serde(rename = "transmitter")]
    Transmitters,
}

impl Display for NodeKind {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NodeKind::Receivers => "receivers",
            NodeKind::Transmitters => "transmitters",
        })
    }
}

impl NodeKind {
    /// Where they are.
    pub(crate) fn positions<const D: usize>(self, network: &Network<D>) -> &[[f64; D]] {
        match self {
            NodeKind::Receivers => &network.receivers,
            NodeKind::Transmitters => &network.transmitters,
        }
    }

    /// Their names.
    pub(super) fn names(self, measured: &Pseudoranges) -> Vec<String> {
        match self {
            NodeKind::Receivers => measured.receiver_names().to_vec(),
            NodeKind::Transmitters => measured.transmitter_names().to_vec(),
        }
    }

    /// One of the other kind, in words.
    pub(super) fn others(self) -> &'static str {
        match self {
            NodeKind::Receivers => "transmitter",
            NodeKind::Transmitters => "receiver",
        }
    }
}
