//! Why a family cannot be used.

use super::start_file::StartFileError;
use crate::checkpoint::CheckpointError;
use crate::ranks::RanksError;
use crate::tracker::OptionError;
use poly::{CompileError, Evaluate, ParseError, counted};

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
    /// There are fewer equations than unknowns, or no unknowns.
    #[error("{} in {}; at least as many equations as unknowns are needed, and at least one unknown", counted(*.equations, "equation"), counted(*.unknowns, "unknown"))]
    Underdetermined {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A symmetry whose number of formulas differs from the number of unknowns.
    #[error("symmetry {map} has {}; it needs one for each unknown, {unknowns} in all", counted(*.found, "formula"))]
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
    /// Solutions are asked for up to a symmetry, of which there is none.
    #[error("the family states no symmetry; add `symmetry`, or ask for all solutions")]
    NoSymmetry,
    /// The start file cannot be used.
    #[error(transparent)]
    Start(#[from] StartFileError),
    /// A listed solution whose orbit under the symmetry has another size than the file says.
    #[error(
        "solution {solution} stands for {stated} of its orbit, but by the family's symmetry for {found}; \
        is the file that of another family? Compute it anew"
    )]
    Represents {
        /// The solution, from 1.
        solution: usize,
        /// Number of solutions that the file says.
        stated: usize,
        /// Number of solutions of its orbit.
        found: usize,
    },
    /// A fibre of another family.
    #[error(
        "{} and solutions of {}, but the family has {} and {}",
        counted(*.found_parameters, "parameter"),
        counted(*.found_unknowns, "coordinate"),
        counted(*.parameters, "parameter"),
        counted(*.unknowns, "unknown")
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
    #[error("target {target}: {} needed", counted(*.parameters, "finite parameter"))]
    Target {
        /// The target, from 1.
        target: usize,
        /// Number of parameters of the family.
        parameters: usize,
    },
    /// A first solution that is none.
    #[error(
        "first solution {solution} is none for its parameters: Newton's method moves it by {moved:.2} of its size; \
        correct it, or let a first pair be found"
    )]
    FirstSolution {
        /// The solution, from 1.
        solution: usize,
        /// The relative distance of the solution to which Newton's method leads.
        moved: f64,
    },
    /// A first solution at which Newton's method does not settle, or that is singular.
    #[error(
        "first solution {solution} is no regular solution for its parameters: Newton's method does not settle there; \
        correct it, or let a first pair be found"
    )]
    FirstSingular {
        /// The solution, from 1.
        solution: usize,
    },
    /// A solution of combinations of the equations, or none at all, in place of one of all equations.
    #[error(
        "solution {solution} is none for its parameters: equation {equation} does not hold there; correct it, or let \
        the fibre be computed anew"
    )]
    Misses {
        /// The solution, from 1.
        solution: usize,
        /// The equation, from 1.
        equation: usize,
    },
    /// More equations than unknowns that have solutions for special parameters only.
    #[error(
        "the equations have no solution for generic parameters, as far as was seen: equation {equation} ceases to hold \
        when the parameters of a solution of all equations move; correct the equations, or, if parameters depend on \
        each other, write these in independent ones"
    )]
    Special {
        /// The equation, from 1.
        equation: usize,
    },
    /// Certificates are asked for of more equations than unknowns.
    #[error(
        "{} in {}; only families of as many equations as unknowns can be certified; leave the certificates out",
        counted(*.equations, "equation"),
        counted(*.unknowns, "unknown")
    )]
    Uncertifiable {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// No first solution was found.
    #[error("no regular solution was found for any parameters; give a pair of parameters and solution")]
    NoPair,
}

impl FamilyError {
    /// An error unless a fibre of these numbers of parameters and coordinates can be one of the system.
    pub(super) fn unless_fits<E: Evaluate>(
        system: &E,
        found_parameters: usize,
        found_unknowns: usize,
    ) -> Result<(), FamilyError> {
        let (parameters, unknowns) = (system.parameters(), system.variables());
        if (found_parameters, found_unknowns) == (parameters, unknowns) {
            return Ok(());
        }
        Err(FamilyError::Misfit { found_parameters, found_unknowns, parameters, unknowns })
    }
}
