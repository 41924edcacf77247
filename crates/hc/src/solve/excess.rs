//! Solutions that were not asked for.

use super::equations::Equations;
use num_complex::Complex64;
use poly::simd::Isa;
use poly::{Evaluate, SparseSystem, SupportError};

/// Residuals relative to the sizes of the terms from which a regular point does not solve an
/// equation.
const EXCESS: f64 = 1e-9;
/// Coordinates up to this share of the largest count as zero.
const TORUS: f64 = 1e-12;

/// Which points were not asked for.
pub(super) struct Excess {
    /// All equations and their coefficients, where they are more than the unknowns.
    all: Option<(SparseSystem, Vec<Complex64>)>,
    torus_only: bool,
}

impl Excess {
    pub(super) fn new(given: &Equations, torus_only: bool) -> Result<Excess, SupportError> {
        let all = (given.len() > given.unknowns)
            .then(|| Ok((SparseSystem::new(given.unknowns, &given.supports)?, given.coefficients.concat())))
            .transpose()?;
        Ok(Excess { all, torus_only })
    }

    /// Every point that is found was asked for.
    pub(super) fn none() -> Excess {
        Excess { all: None, torus_only: false }
    }

    /// Whether a regular end was not asked for.
    pub(super) fn contains_regular(&self, point: &[Complex64]) -> bool {
        self.contains(point, EXCESS)
    }

    /// Whether a point misses an equation by more than `tolerance` times the sizes of its terms, or
    /// has a zero coordinate where only the torus was asked for.
    pub(super) fn contains(&self, point: &[Complex64], tolerance: f64) -> bool {
        let largest = point.iter().map(|z| z.norm()).fold(0.0, f64::max);
        if self.torus_only && point.iter().any(|z| z.norm() <= TORUS * largest) {
            return true;
        }
        let Some((system, coefficients)) = &self.all else { return false };
        let mut memory = system.memory(Isa::Portable);
        let mut values = vec![Complex64::new(0.0, 0.0); system.equations()];
        let mut sizes = values.clone();
        system.values(&mut memory, point, coefficients, &mut values);
        let absolute: Vec<Complex64> = point.iter().map(|z| z.norm().into()).collect();
        let absolute_coefficients: Vec<Complex64> = coefficients.iter().map(|c| c.norm().into()).collect();
        system.values(&mut memory, &absolute, &absolute_coefficients, &mut sizes);
        values.iter().zip(&sizes).any(|(v, size)| v.norm() > tolerance * size.norm())
    }
}
