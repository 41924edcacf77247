//! What tables, pictures and JSON are made of.

use hc::Family;
use hc::sweep::{Grid, Sweep};

/// What is swept, and what was found.
pub(super) struct Swept<'a> {
    pub(super) family: &'a Family,
    pub(super) grid: &'a Grid,
    pub(super) sweep: &'a Sweep,
    /// Multiplicities of solutions that are multiple for all parameters, to which no path leads.
    pub(super) untracked: &'a [usize],
}
