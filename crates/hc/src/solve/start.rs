//! Which start system is used, and the equations with the terms that it needs.

use super::equations::Equations;
use super::{SolveError, SolveOptions, Start};
use crate::start::{Generic, MixedError, Polyhedral, bezout_number, degrees, total_degree};
use num_complex::Complex64;
use poly::SparseSystem;

/// A source of start systems for given equations.
pub(super) struct Starts {
    /// The system of the coefficient stage.
    pub(super) system: SparseSystem,
    /// As many equations as unknowns, with all terms of the system.
    pub(super) equations: Equations,
    /// Their coefficients in one row.
    pub(super) target: Vec<Complex64>,
    pub(super) kind: Start,
    pub(super) mixed_volume: Option<u64>,
    degrees: Vec<u64>,
    /// The first mixed cells, found while choosing.
    first: Option<Polyhedral>,
}

impl Starts {
    pub(super) fn new(given: Equations, options: &SolveOptions) -> Result<Starts, SolveError> {
        let n = given.unknowns;
        let mut equations = if given.len() > n { given.squared(options.seed) } else { given };
        let laurent = equations.is_laurent();
        if !options.torus_only && !laurent {
            (0..n).for_each(|i| equations.add_term(i, vec![0; n]));
        }
        let degrees = degrees(&equations.supports).unwrap_or_default();
        let bezout = if laurent { None } else { bezout_number(&degrees) };
        let (kind, first, mixed_volume) = match options.start {
            Start::TotalDegree if laurent => return Err(SolveError::NegativeExponents),
            Start::TotalDegree => (Start::TotalDegree, None, None),
            choice => match Polyhedral::new(&equations.supports, options.seed, 0, options.monitor()) {
                Ok(cells) => {
                    let volume = cells.mixed_volume;
                    (Start::Polyhedral, Some(cells), Some(volume))
                }
                Err(MixedError::Cancelled) => return Err(MixedError::Cancelled.into()),
                // Determinants out of range, but no more paths than are allowed.
                Err(_) if choice == Start::Auto && bezout.is_some_and(|paths| paths <= options.max_paths) => {
                    (Start::TotalDegree, None, None)
                }
                Err(error) => return Err(error.into()),
            },
        };
        let paths = match kind {
            Start::TotalDegree => bezout.unwrap_or(u64::MAX),
            _ => mixed_volume.unwrap_or(0),
        };
        if paths > options.max_paths {
            return Err(SolveError::TooManyPaths { paths, limit: options.max_paths });
        }
        if kind == Start::TotalDegree {
            for (i, &degree) in degrees.iter().enumerate() {
                let degree = i32::try_from(degree).map_err(|_| SolveError::NegativeExponents)?;
                equations.add_term(i, vec![0; n]);
                equations.add_term(i, (0..n).map(|j| if j == i { degree } else { 0 }).collect());
            }
        }
        let system = SparseSystem::new(n, &equations.supports)?;
        let target = equations.coefficients.concat();
        Ok(Starts { system, equations, target, kind, mixed_volume, degrees, first })
    }

    /// A start system and its solutions, another one for every attempt.
    pub(super) fn solve(&mut self, attempt: u64, options: &SolveOptions) -> Result<Generic, SolveError> {
        if self.kind == Start::TotalDegree {
            return Ok(total_degree(&self.equations.supports, &self.degrees, options.seed, attempt));
        }
        let cells = match self.first.take() {
            Some(cells) => cells,
            None => Polyhedral::new(&self.equations.supports, options.seed, attempt, options.monitor())?,
        };
        Ok(cells.solve(&self.system, &options.paths))
    }
}
