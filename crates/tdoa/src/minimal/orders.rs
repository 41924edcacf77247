//! Orders of nodes.

use smallvec::SmallVec;

/// An order of nodes: `order[k]` is the data's node in place `k`.
pub(crate) type Order = SmallVec<[usize; 16]>;

/// Orders of the data's nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Orders {
    pub(crate) receivers: Order,
    pub(crate) transmitters: Order,
}

impl Orders {
    /// The order of the data.
    pub(crate) fn of_data(receivers: usize, transmitters: usize) -> Self {
        Orders { receivers: (0..receivers).collect(), transmitters: (0..transmitters).collect() }
    }
}
