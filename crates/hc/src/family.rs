//! A parameter family, ready to be tracked.

use crate::fibre::Fibre;
use num_complex::Complex64;
use poly::{CompileError, Evaluate, Family, Interpreter, Isa};
use thiserror::Error;

/// Values of this size and below count as zero where a family demands that something does not vanish.
const VANISHES: f64 = 1e-9;

/// The equations of a family and what must not vanish at their solutions, compiled.
#[derive(Debug)]
pub struct Compiled {
    /// The equations, as many as unknowns.
    pub system: Interpreter,
    nonzero: Interpreter,
}

/// Why a family cannot be tracked.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FamilyError {
    /// The formulas do not compile.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// Not as many equations as unknowns, or none.
    #[error("{equations} equations in {unknowns} unknowns; as many equations as unknowns are needed, and at least one")]
    NotSquare {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A fibre of another family.
    #[error(
        "{found_parameters} parameters and solutions of {found_unknowns} coordinates, but the family has {parameters} parameters and \
         {unknowns} unknowns"
    )]
    Misfit {
        /// Parameters of the fibre.
        found_parameters: usize,
        /// Coordinates of its solutions.
        found_unknowns: usize,
        /// Parameters of the family.
        parameters: usize,
        /// Unknowns of the family.
        unknowns: usize,
    },
}

impl Compiled {
    /// Compiles a family.
    ///
    /// # Errors
    /// If a formula does not compile or the equations are not square.
    pub fn new(family: &Family) -> Result<Compiled, FamilyError> {
        let (system, nonzero) = (family.system.compile()?, family.nonzero.compile()?);
        let (equations, unknowns) = (system.equations(), system.variables());
        if equations != unknowns || unknowns == 0 {
            return Err(FamilyError::NotSquare { equations, unknowns });
        }
        Ok(Compiled { system, nonzero })
    }

    /// Whether none of the factors that the family declares nonzero vanishes at the solution `x` (one entry an unknown) for the
    /// parameters `p` (one entry a parameter).
    pub fn accepts(&self, p: &[Complex64], x: &[Complex64]) -> bool {
        let mut memory = self.nonzero.memory(Isa::Portable);
        let mut values = vec![Complex64::new(0.0, 0.0); self.nonzero.equations()];
        self.nonzero.values(&mut memory, x, p, &mut values);
        values.iter().all(|z| z.norm() > VANISHES)
    }

    /// Checks that a fibre has the family's numbers of parameters and unknowns.
    ///
    /// # Errors
    /// If it has not.
    pub fn check(&self, fibre: &Fibre) -> Result<(), FamilyError> {
        let (parameters, unknowns) = (self.system.parameters(), self.system.variables());
        let (found_parameters, found_unknowns) = (fibre.parameters.len(), fibre.dimension);
        if (found_parameters, found_unknowns) == (parameters, unknowns) {
            return Ok(());
        }
        Err(FamilyError::Misfit { found_parameters, found_unknowns, parameters, unknowns })
    }
}
