//! Memory of quick steps.

use super::super::stop::Stops;
use super::super::workspace::Workspace;
use super::attempts::Attempts;
use poly::simd::Isa;
use poly::{Evaluate, Lane, Singles16};

/// Memory of quick steps, beside the tracker's own.
pub(in super::super) struct QuickMemory<'a, E: Evaluate> {
    pub(super) singles: Workspace<'a, E, Singles16>,
    pub(super) lanes: Vec<Attempts>,
    /// Where the paths stopped in single precision.
    pub(super) stops: Stops,
    /// Paths that start again in double precision.
    pub(super) again: Vec<usize>,
}

impl<'a, E: Evaluate> QuickMemory<'a, E> {
    /// For the paths of a square system.
    pub(super) fn new(system: &'a E, isa: Isa) -> Self {
        QuickMemory {
            singles: Workspace::new(system, isa),
            lanes: vec![Attempts::idle(); Singles16::LANES],
            stops: Stops::default(),
            again: Vec::new(),
        }
    }
}
