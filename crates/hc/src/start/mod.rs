//! Start systems.
//!
//! * Polyhedral: the mixed cells of the supports ([`mixed_volume`], [`mixed_cells`]), and a system
//!   of binomials for each cell.
//! * Multihomogeneous: products of linear forms in groups of unknowns.
//! * Total degree: `x_j^(d_i) - 1` with the degrees `d_i` of the equations.

mod bezout;
mod binomial;
mod multihomogeneous;
mod path_system;
mod polyhedral;
mod reached;
mod toric;
mod total_degree;

pub use crate::mixed::{MixedCell, MixedError, MixedVolume, mixed_cells, mixed_volume};
pub(crate) use bezout::mixed_volume_is_bezout;
pub(crate) use multihomogeneous::{Grouped, Multihomogeneous};
pub(crate) use path_system::PathSystem;
pub(crate) use polyhedral::Polyhedral;
pub(crate) use reached::StartSolutions;
pub(crate) use total_degree::{TotalDegree, bezout_number, degrees, leading_unknowns};

use crate::family::Fibre;
use crate::monitor::Monitor;
use crate::tracker::{TrackerOptions, Trackers};
use num_complex::Complex64;
use poly::Evaluate;

/// A start system whose solutions are made by their numbers, when they are needed.
pub(crate) enum StartSystem {
    Polyhedral(Polyhedral),
    Multihomogeneous(Multihomogeneous),
    TotalDegree(TotalDegree),
}

/// Where the paths of a system `E` begin.
pub(crate) trait Source<E: Evaluate>: Sync {
    /// The parameters at the start.
    fn parameters(&self) -> &[Complex64];
    /// Whether start solutions are themselves ends of paths, which may be lost or jump.
    fn is_tracked(&self) -> bool;
    /// Whether start solutions may be missing, so that the ends of paths do not show which have jumped.
    fn is_partial(&self) -> bool {
        false
    }
    /// The start solutions with these ascending numbers; if they have to be tracked, some may be
    /// missing.
    fn solutions(
        &self,
        trackers: &Trackers<'_, E>,
        numbers: &[usize],
        settings: &TrackerOptions,
        monitor: &Monitor,
    ) -> StartSolutions;
}

impl StartSystem {
    /// With as many further parameters, which are zero.
    pub(crate) fn with_further(mut self, count: usize) -> StartSystem {
        let parameters = match &mut self {
            StartSystem::Polyhedral(start) => &mut start.coefficients,
            StartSystem::Multihomogeneous(start) => &mut start.parameters,
            StartSystem::TotalDegree(start) => &mut start.parameters,
        };
        parameters.resize(parameters.len() + count, Complex64::new(0.0, 0.0));
        self
    }
}

impl Source<PathSystem> for StartSystem {
    fn parameters(&self) -> &[Complex64] {
        match self {
            StartSystem::Polyhedral(start) => &start.coefficients,
            StartSystem::Multihomogeneous(start) => &start.parameters,
            StartSystem::TotalDegree(start) => &start.parameters,
        }
    }

    fn is_tracked(&self) -> bool {
        matches!(self, StartSystem::Polyhedral(_))
    }

    fn solutions(
        &self,
        trackers: &Trackers<'_, PathSystem>,
        numbers: &[usize],
        settings: &TrackerOptions,
        monitor: &Monitor,
    ) -> StartSolutions {
        let made = |solution: &dyn Fn(u64) -> Vec<Complex64>| StartSolutions {
            numbers: numbers.to_vec(),
            points: numbers.iter().flat_map(|&k| solution(k as u64)).collect(),
        };
        match self {
            StartSystem::Polyhedral(start) => start.solutions(trackers, numbers, settings, monitor),
            StartSystem::Multihomogeneous(start) => made(&|k| start.solution(k)),
            StartSystem::TotalDegree(start) => made(&|k| start.solution(k)),
        }
    }
}

/// The solutions that are stored.
impl<E: Evaluate> Source<E> for Fibre {
    fn parameters(&self) -> &[Complex64] {
        &self.parameters
    }

    fn is_tracked(&self) -> bool {
        false
    }

    fn is_partial(&self) -> bool {
        self.is_partial
    }

    fn solutions(&self, _: &Trackers<'_, E>, numbers: &[usize], _: &TrackerOptions, _: &Monitor) -> StartSolutions {
        let points = numbers.iter().flat_map(|&k| self.solution(k).iter().copied()).collect();
        StartSolutions { numbers: numbers.to_vec(), points }
    }
}
