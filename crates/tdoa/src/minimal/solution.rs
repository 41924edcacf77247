//! The result of a minimal solver.

use super::warning::MinimalWarning;
use crate::clocks::Emissions;
use crate::network::Network;
pub use hc::family::PathCounts;
use serde::Serialize;

/// One network that a minimal solver proposes, in the plane or, with `D` = 3, in space.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct Candidate<const D: usize = 2> {
    /// The network.
    #[serde(flatten)]
    pub network: Network<D>,
    /// Root mean square of the unsquared residuals, in metres.
    pub residual: f64,
    /// Whether every f_ij - o_j is at least minus the tolerance.
    pub physical: bool,
    /// Condition number of the Jacobian at the candidate: how much an error of the data may grow.
    pub condition: f64,
}

/// How many roots pass each condition; each count is a part of the one before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RootCounts {
    /// Complex roots.
    pub complex: usize,
    /// Real roots.
    pub real: usize,
    /// Real roots with positive definite H, that is, with real positions.
    pub positive_definite: usize,
    /// Of these, roots with all f_ij - o_j >= 0 up to the tolerance.
    pub physical: usize,
}

/// Everything that a minimal solver finds for one matrix, in the plane or, with `D` = 3, in space.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(bound = "[f64; D]: Serialize")]
pub struct MinimalSolution<const D: usize = 2> {
    /// What was taken for known of offsets.
    pub emissions: Emissions,
    /// The size of the matrix, such as `6r/3s`.
    pub configuration: String,
    /// The solver that was used, such as `6r/3s` on a larger matrix.
    pub solver: &'static str,
    /// How its paths ended.
    pub paths: PathCounts,
    /// The numbers of roots.
    pub counts: RootCounts,
    /// Whether the search was stopped at the first network that fits
    /// ([`super::MinimalOptions::first_under`]). Other networks may fit as well; `paths` and `counts`
    /// cover the search up to that point.
    pub stopped_early: bool,
    /// What makes the result doubtful: lost paths, networks that the data cannot tell apart.
    pub warnings: Vec<MinimalWarning>,
    /// The candidates, best first.
    #[serde(rename = "solutions")]
    pub candidates: Vec<Candidate<D>>,
}
