//! Settings of sweeps.

use crate::family::TargetLimits;
use crate::setters::setters;
use crate::solve::SolveOptions;

/// Settings of a [sweep](crate::Family::sweep).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SweepOptions {
    /// Whether the solutions of every cell are certified. Default false: only those of cells in which pairs of
    /// conjugates do not show which solutions are real.
    pub certify: bool,
    /// Whether the solutions of neighbouring cells are joined to branches. Default true.
    pub join: bool,
    /// Settings of the paths to the cells. Start systems are not used, nor is [`SolveOptions::certify`]. Default
    /// [`SolveOptions::default`].
    pub solve: SolveOptions,
    /// Limits of the work on each cell. Default [`TargetLimits::default`].
    pub limits: TargetLimits,
}

impl Default for SweepOptions {
    fn default() -> Self {
        SweepOptions { certify: false, join: true, solve: SolveOptions::default(), limits: TargetLimits::default() }
    }
}

impl SweepOptions {
    /// The defaults.
    pub fn new() -> SweepOptions {
        SweepOptions::default()
    }
}

setters!(SweepOptions { certify: bool, join: bool, solve: SolveOptions, limits: TargetLimits });
