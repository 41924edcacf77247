//! Why a system is not solved.

use crate::certify::CertifyError;
use crate::checkpoint::CheckpointError;
use crate::ranks::RanksError;
use crate::start::MixedError;
use crate::tracker::OptionError;
use poly::{ExpandError, SupportError, counted};

/// Why a system is not solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A setting outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// No polyhedral start system.
    #[error(transparent)]
    Mixed(#[from] MixedError),
    /// Exponents out of range.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// Formulas that are not polynomials, or too large when multiplied out.
    #[error(transparent)]
    Expand(#[from] ExpandError),
    /// A system with parameters.
    #[error("the system has parameters ({0}); give them values, or track a family")]
    Parameters(String),
    /// The checkpoint does not belong to this run, or cannot be written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Other processes cannot take part.
    #[error(transparent)]
    Ranks(#[from] RanksError),
    /// The solutions cannot be certified.
    #[error(transparent)]
    Certify(#[from] CertifyError),
    /// An equation whose number of unknowns differs from that of the first.
    #[error("equation {0} has other unknowns than the first; write all in the same unknowns")]
    Mismatched(usize),
    /// Fewer equations than unknowns, or no unknowns.
    #[error(
        "too few equations for isolated solutions, {} in {}{}; add equations, or numbers for some of the unknowns",
        counted(*.equations, "equation"),
        counted(unknowns.len(), "unknown"),
        if unknowns.is_empty() { String::new() } else { format!(" ({})", unknowns.join(", ")) }
    )]
    Underdetermined {
        /// Number of equations.
        equations: usize,
        /// The unknowns.
        unknowns: Vec<String>,
    },
    /// An equation that is identically zero.
    #[error("equation {0} is zero; leave it out")]
    Zero(usize),
    /// An equation without unknowns.
    #[error("equation {0} is a constant that is not zero, so that there is no solution; is a term missing?")]
    Constant(usize),
    /// A coefficient beyond the range of double precision.
    #[error(
        "equation {0} has a coefficient beyond the range of double precision; divide it by its largest coefficient"
    )]
    Coefficient(usize),
    /// An equation with very many terms whose coefficients differ so much that doubles cannot
    /// determine its solutions, such as the power of a sum, multiplied out.
    #[error(
        "equation {equation} has {terms} terms with coefficients over {decades} decades, too many for double \
        precision; write powers of sums as such, not multiplied out, or give the sum a new unknown: \
        z^100 - 1 and z - (x + y + 1) instead of (x + y + 1)^100 - 1"
    )]
    Spread {
        /// The equation, from 1.
        equation: usize,
        /// Number of its terms.
        terms: usize,
        /// Decimal logarithm of the quotient of its largest and smallest coefficient.
        decades: usize,
    },
    /// A start system other than the polyhedral one was requested, but some exponents are negative.
    #[error("this start system needs exponents that are not negative; take the polyhedral one")]
    NegativeExponents,
    /// Groups that are not a partition of the unknowns.
    #[error("every one of the {0} unknowns must stand in just one group")]
    Groups(usize),
    /// A multihomogeneous start system with too many terms or groups.
    #[error("the multihomogeneous start system of these groups is too large; take fewer groups, or the polyhedral one")]
    StartTooLarge,
    /// More paths than allowed.
    #[error("there are {paths} paths, more than the {limit} allowed; lower the exponents or allow more paths")]
    TooManyPaths {
        /// Number of paths; `u64::MAX` if it does not fit.
        paths: u64,
        /// The limit of [`SolveOptions::max_paths`](crate::SolveOptions::max_paths).
        limit: u64,
    },
}
