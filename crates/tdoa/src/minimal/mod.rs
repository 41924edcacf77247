//! Solvers for small networks: every network that explains a few arrival times exactly.
//!
//! [`Solver`] picks the method by the size of the matrix. Most work by homotopy continuation from stored solutions of a generic
//! instance; all paths are accounted for in [`MinimalSolution::paths`].
//!
//! | size | method | paths |
//! |---|---|---|
//! | 6r/3s, and more receivers | the dual equations of the paper on three transmitters | 180 |
//! | 4r/5s, and more transmitters | Gram matrix of the receivers | 344 |
//! | 5r/4s, 5r/5s, 6r/4s, 6r/5s | the dual equations and a determinant for the fourth transmitter | 152 |
//! | 5r/6s, and more of both | offsets by rank | 5 |
//! | 7r/4s, and more of both | offsets by rank, linear | 0 |
//!
//! A solver that is used again keeps 0.2 to 0.5 MB, start solutions and workspace, and a solve allocates its result alone, a few kilobytes
//! (`cargo run --release -p tdoa --example memory`), but for the few networks with roots whose Jacobians are singular as far as doubles can tell.

mod chart;
mod collinear;
mod dual;
mod engine;
mod formulation;
mod four_five;
mod larger;
mod linear;
mod nearest;
mod normalised;
mod polish;
mod proofs;
mod rank;
mod real;
mod recover;
mod scratch;
mod solver;
pub(crate) mod subset;
mod three;
mod warning;

pub use proofs::RootProofs;
pub use solver::Solver;
pub use warning::{Nodes, SolveWarning};

use crate::network::MinimalSolution;
use crate::pseudoranges::Pseudoranges;
use hc::fibre::FibreOptions;
use hc::tracker::OptionError;
use thiserror::Error;

/// Settings of the minimal solvers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SolveOptions {
    /// How far below zero a distance f_ij - o_j may lie for a candidate to count as physical, relative to the size of the data
    /// (root mean square of f_ij - f_1j). Default 1e-6; for noisy data take the noise.
    pub tolerance: f64,
    /// Roots whose imaginary parts are at most this share of the size of the data are tried as real ones too: noise can
    /// make two real roots complex. Default 0: real roots only.
    pub near_real: f64,
    /// Whether candidates are polished in the primal coordinates. Default true.
    pub polish: bool,
    /// For callers in a hurry: stop at the first physical candidate whose residual (root mean square, metres) is below this. Only sizes solved
    /// by paths without a smaller part (6r/3s, 5r/4s, 4r/5s, 5r/6s) stop early; in 6r/3s and 4r/5s every candidate fits exactly, so that the first
    /// physical one is given, which need not be the true one. Default `None`: all networks.
    pub first_under: Option<f64>,
    /// Settings for the paths; `paths.tracker.drop_complex` gives up paths that would hardly become real.
    pub paths: FibreOptions,
    /// What becomes of paths that fail or jump. Default [`Fallback::OtherCharts`].
    pub fallback: Fallback,
    /// Where paths start. Default [`Start::Stored`].
    pub start: Start,
}

/// How paths are tracked again that fail, jump or take too many steps. A chart is the same problem with the nodes in another order. What
/// each costs and loses is measured by `tdoa experiment charts`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Fallback {
    /// In the other charts, from where they have broken off.
    #[default]
    OtherCharts,
    /// In the other charts, from the start.
    OtherChartsFromStart,
    /// In the same chart, with shorter steps.
    OneChart,
}

/// Where the paths of the minimal solvers start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Start {
    /// From the stored solutions of a generic instance: as many paths as roots.
    #[default]
    Stored,
    /// From a polyhedral start system that is computed for the data, as in the paper: slower, and independent of what is stored. Where that
    /// leaves roots missing, all roots of a random member of the family are found in this way and tracked to the data; the paths that this takes count
    /// as tracked again.
    Polyhedral,
}

impl Default for SolveOptions {
    fn default() -> Self {
        let mut paths = FibreOptions::default();
        paths.tracker.contraction = 0.2;
        paths.tracker.corrector_tolerance = 3e-4;
        paths.tracker.beta_omega = 1.2;
        paths.tracker.beta_tau = 0.75;
        paths.tracker.beta_tau_last = 0.5;
        // Most paths take about 45 steps. One that takes many more is quicker in another chart.
        paths.tracker.max_steps = 400;
        SolveOptions {
            tolerance: 1e-6,
            near_real: 0.0,
            polish: true,
            first_under: None,
            paths,
            fallback: Fallback::OtherCharts,
            start: Start::Stored,
        }
    }
}

/// Measurements at most: the last refinement takes memory for a matrix of as many rows, and columns for all unknowns.
const MAX_MEASUREMENTS: usize = 5_000;

/// Why a matrix cannot be solved.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A setting of the tracker outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Fewer constraints than unknowns.
    #[error(
        "{configuration} is underdetermined: {constraints} measurements for {unknowns} unknowns (positions up to a rigid motion, \
         offsets); the smallest solvable networks are 6 receivers with 3 transmitters, 5 with 4, and 4 with 5"
    )]
    Underdetermined {
        /// Size, such as `4r/4s`.
        configuration: String,
        /// Measurements.
        constraints: usize,
        /// Unknowns.
        unknowns: usize,
    },
    /// More measurements than all of them can be refined with by dense algebra.
    #[error(
        "{configuration} has more than the {limit} measurements that exact solvers take; use `calibrate`, or select nodes"
    )]
    TooLarge {
        /// Size, such as `400r/300s`.
        configuration: String,
        /// Measurements at most.
        limit: usize,
    },
    /// The polyhedral route failed before any path was tracked.
    #[error("the polyhedral start system: {0}")]
    Polyhedral(String),
    /// The polyhedral route was stopped through its monitor, `paths.tracker.monitor`.
    #[error("the solve was cancelled")]
    Cancelled,
    /// A missing measurement.
    #[error(
        "receiver {receiver} did not hear transmitter {transmitter}: the exact solvers need every measurement; use `calibrate`"
    )]
    Missing {
        /// Name of the receiver.
        receiver: String,
        /// Name of the transmitter.
        transmitter: String,
    },
    /// Two receivers that cannot be told apart.
    #[error(
        "receivers {first} and {second} measure the same up to a constant: they coincide (or lie on one line with every transmitter); \
         remove one of them"
    )]
    IdenticalReceivers {
        /// Name of one.
        first: String,
        /// Name of the other.
        second: String,
    },
    /// Two transmitters that cannot be told apart.
    #[error("transmitters {first} and {second} are heard alike up to a constant: they coincide; remove one of them")]
    IdenticalTransmitters {
        /// Name of one.
        first: String,
        /// Name of the other.
        second: String,
    },
}

/// Every network that explains the measurements, best first: [`Solver::solve`] with a new solver.
///
/// # Errors
/// If the matrix is too small, a measurement is missing, or two nodes coincide.
pub fn solve(measured: &Pseudoranges, options: &SolveOptions) -> Result<MinimalSolution, SolveError> {
    Solver::new().solve(measured, options)
}

/// Refuses missing measurements and nodes that coincide.
fn check(measured: &Pseudoranges) -> Result<(), SolveError> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    for i in 0..m {
        for j in 0..n {
            if measured.get(i, j).is_none() {
                return Err(SolveError::Missing {
                    receiver: measured.receiver_names()[i].clone(),
                    transmitter: measured.transmitter_names()[j].clone(),
                });
            }
        }
    }
    let f = |i: usize, j: usize| measured.values()[i * n + j];
    let largest = measured.values().iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let spread = |differences: &mut dyn Iterator<Item = f64>| {
        let (low, high) =
            differences.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
        high - low
    };
    // What rounding of the input alone can tell apart.
    let resolution = 64.0 * f64::EPSILON * largest;
    for i in 0..m {
        for k in i + 1..m {
            if spread(&mut (0..n).map(|j| f(i, j) - f(k, j))) <= resolution {
                let names = measured.receiver_names();
                return Err(SolveError::IdenticalReceivers { first: names[i].clone(), second: names[k].clone() });
            }
        }
    }
    for j in 0..n {
        for k in j + 1..n {
            if spread(&mut (0..m).map(|i| f(i, j) - f(i, k))) <= resolution {
                let names = measured.transmitter_names();
                return Err(SolveError::IdenticalTransmitters { first: names[j].clone(), second: names[k].clone() });
            }
        }
    }
    Ok(())
}
