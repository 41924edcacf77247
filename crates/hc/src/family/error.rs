//! Why a family cannot be used.

use crate::checkpoint::CheckpointError;
use crate::ranks::RanksError;
use crate::tracker::OptionError;
use poly::{CompileError, ParseError};

/// Why a family cannot be tracked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FamilyError {
    /// The text is not a family.
    #[error(transparent)]
    Parse(#[from] ParseError),
    /// The formulas do not compile.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// A setting outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The checkpoint does not belong to this run, or cannot be written.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Other processes cannot take part.
    #[error(transparent)]
    Ranks(#[from] RanksError),
    /// The number of equations differs from the number of unknowns, or is zero.
    #[error("{equations} equations in {unknowns} unknowns; as many equations as unknowns are needed, and at least one")]
    NotSquare {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A symmetry whose number of formulas differs from the number of unknowns.
    #[error("symmetry {map} has {found} formulas; it needs one for each of the {unknowns} unknowns")]
    Symmetry {
        /// The map, from 1.
        map: usize,
        /// Number of its formulas.
        found: usize,
        /// Number of unknowns of the family.
        unknowns: usize,
    },
    /// A map that takes a solution to a point that is not a solution.
    #[error(
        "symmetry {map} takes a solution to a point that is none; correct `symmetry` in the family, or leave it out"
    )]
    NotSymmetric {
        /// The map, from 1.
        map: usize,
    },
    /// A fibre of another family.
    #[error(
        "{found_parameters} parameters and solutions of {found_unknowns} coordinates, but the family has {parameters} parameters and \
         {unknowns} unknowns"
    )]
    Misfit {
        /// Number of parameters of the fibre.
        found_parameters: usize,
        /// Number of coordinates of its solutions.
        found_unknowns: usize,
        /// Number of parameters of the family.
        parameters: usize,
        /// Number of unknowns of the family.
        unknowns: usize,
    },
    /// A target that does not fit.
    #[error("target {target}: {parameters} finite parameters are needed")]
    Target {
        /// The target, from 1.
        target: usize,
        /// Number of parameters of the family.
        parameters: usize,
    },
    /// No first solution was found.
    #[error("no regular solution was found for any parameters; give a pair of parameters and solution")]
    NoPair,
}
