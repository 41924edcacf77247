//! All isolated regular solutions of a square polynomial system.

use crate::distinct::coincidences;
use crate::fibre::{FibreOptions, PathCounts, track_fibre};
use crate::refine::Refiner;
use crate::start::{MixedError, generic};
use crate::tracker::PathEnd;
use num_complex::Complex64;
use num_traits::ToPrimitive;
use poly::{Exact, Polynomial, SparseSystem, SupportError};
use serde::Serialize;

/// Settings of [`solve`].
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct SolveOptions {
    /// Seed of the generic coefficients. Default 0.
    pub seed: u64,
    /// Whether solutions with zero coordinates are left out, with the paths that lead to them. Default false.
    pub torus_only: bool,
    /// Settings of both stages.
    pub paths: FibreOptions,
}

/// A regular solution.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solution {
    /// Real and imaginary part of each coordinate.
    pub value: Vec<[f64; 2]>,
    /// Whether all imaginary parts are below 1e-10 of the largest coordinate (or of one).
    pub real: bool,
    /// Largest residual relative to the sizes of the terms of the Jacobian.
    pub residual: f64,
    /// Condition number of the scaled Jacobian.
    pub condition: f64,
}

/// What [`solve`] has found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Solved {
    /// Paths there are: the mixed volume of the supports, the origin included unless only the torus was asked for.
    pub mixed_volume: u64,
    /// How the paths ended; `failed` counts those that ended neither at a regular solution of their own nor at infinity,
    /// those at singular solutions included.
    pub paths: PathCounts,
    /// Paths that stayed bounded but ended at no regular solution.
    pub singular_ends: usize,
    /// The distinct regular solutions.
    pub solutions: Vec<Solution>,
}

/// Why a system is not solved.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// No start system.
    #[error(transparent)]
    Mixed(#[from] MixedError),
    /// Exponents out of range.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// An equation that is identically zero.
    #[error("equation {0} is zero; leave it out")]
    Zero(usize),
    /// A coefficient beyond the range of double precision.
    #[error("equation {0} has a coefficient beyond the range of double precision; scale it")]
    Coefficient(usize),
}

/// Finds the isolated regular solutions of as many polynomials as unknowns: polyhedral homotopy to generic coefficients (Huber &
/// Sturmfels 1995; the origin is added to supports for zero coordinates, Li & Wang 1996), then a straight line in the
/// coefficients. The same seed gives the same bits on any number of threads.
///
/// # Errors
/// If the system is not square, has a zero equation, or numbers out of range.
pub fn solve(polynomials: &[Polynomial<Exact>], options: &SolveOptions) -> Result<Solved, SolveError> {
    let unknowns = polynomials.first().map_or(0, Polynomial::variables);
    if polynomials.len() != unknowns {
        return Err(MixedError::NotSquare { supports: polynomials.len(), unknowns }.into());
    }
    let mut supports = Vec::with_capacity(unknowns);
    let mut target = Vec::new();
    for (i, polynomial) in polynomials.iter().enumerate() {
        let mut support = polynomial.support();
        let mut coefficients = polynomial
            .terms()
            .iter()
            .map(|(_, c)| Some(Complex64::new(c.re.to_f64()?, c.im.to_f64()?)).filter(|z| z.is_finite()))
            .collect::<Option<Vec<Complex64>>>()
            .ok_or(SolveError::Coefficient(i + 1))?;
        let largest = coefficients.iter().map(|c| c.norm()).fold(0.0, f64::max);
        if largest == 0.0 {
            return Err(SolveError::Zero(i + 1));
        }
        coefficients.iter_mut().for_each(|c| *c /= largest);
        let has_negative = support.iter().flatten().any(|&e| e < 0);
        if !options.torus_only && !has_negative && !support.iter().any(|p| p.iter().all(|&e| e == 0)) {
            support.push(vec![0; unknowns]);
            coefficients.push(Complex64::new(0.0, 0.0));
        }
        supports.push(support);
        target.extend(coefficients);
    }
    let system = SparseSystem::new(unknowns, &supports)?;
    let start = generic(&system, &supports, options.seed, &options.paths)?;
    let (paths, mut counts) = track_fibre(&system, &start.fibre, &target, &options.paths);
    let lost = usize::try_from(start.mixed_volume).unwrap_or(usize::MAX) - start.fibre.len();
    counts.tracked += lost;
    counts.failed += lost;
    counts.retracked += start.retracked;

    let mut refiner = Refiner::new(&system);
    let successes = paths.iter().filter(|(r, _)| r.end == PathEnd::Success);
    let refined: Vec<_> = successes.map(|(_, x)| refiner.refine(&target, x)).collect();
    let mut repeated = vec![false; refined.len()];
    let points = refined.iter().enumerate().map(|(k, r)| (k, &r.point[..]));
    for group in coincidences(points, options.paths.coincidence) {
        group[1..].iter().for_each(|&k| repeated[k] = true);
    }
    let distinct = refined.iter().zip(&repeated).filter(|(_, repeated)| !**repeated).map(|(r, _)| {
        let size = r.point.iter().map(|z| z.norm()).fold(1.0, f64::max);
        Solution {
            value: r.point.iter().map(|z| [z.re, z.im]).collect(),
            real: r.point.iter().all(|z| z.im.abs() <= 1e-10 * size),
            residual: r.residual,
            condition: r.condition,
        }
    });
    let singular_ends = paths.count(PathEnd::Singular);
    Ok(Solved { mixed_volume: start.mixed_volume, paths: counts, singular_ends, solutions: distinct.collect() })
}
