//! Proofs that solutions exist: Krawczyk's test in complex interval arithmetic.
//!
//! [`certify`] takes a system and approximate solutions. For each point that passes, it returns a
//! box of complex rectangles in which the system has **exactly one** solution, a regular one. It
//! also says whether that solution is proved real, and which of the points represent the same
//! solution. The proof is about the system *as it is written*. Decimal coefficients and fractions
//! are exact numbers, enclosed by intervals wherever they are not doubles; parameters are the
//! intervals that are given. All arithmetic is rounded outward; nothing rests on a tolerance.
//!
//! ```
//! use hc::certify::{CertifyOptions, Reality, certify};
//! use num_complex::Complex64;
//!
//! let system = hc::poly::parse::phcpack("2\n x^2 + y^2 - 1;\n x - 0.1*y;")?;
//! let near = |x: f64, y: f64| vec![Complex64::new(x, 0.0), Complex64::new(y, 0.0)];
//! let points = [near(0.0995, 0.9950), near(-0.0995, -0.9950), near(0.09950372, 0.99503719), near(0.3, 0.4)];
//! let found = certify(&system, &[], &points, &CertifyOptions::default())?;
//! assert_eq!((found.n_certified(), found.n_distinct(), found.n_real()), (3, 2, 2));
//! assert_eq!(found.duplicate_of, [None, None, Some(0), None]);
//! assert!(found.points[3].is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The proof
//! Let `c` be the refined point (double-double), `C` an approximate inverse of the Jacobian and `D`
//! a box around zero. With
//!
//! `K = -C F(c) + (I - C J(c + D)) D`
//!
//! `g(x) = x - C F(x)` maps `c + D` into `c + K`, because `F(x) - F(y) = A (x - y)` for a matrix
//! `A` in the interval matrix `J(c + D)` (rectangles are convex). If `K` lies in the interior of
//! `D`, Brouwer's theorem gives a fixed point of `g`. Suppose also that the norm of
//! `I - C J(c + D)` is below one, with moduli of entries and coordinates weighted by the box. Then
//! `C` is regular, so that fixed points are solutions, and `g` contracts, so that there is only
//! one. (Krawczyk 1969, Moore 1977, Rump 1983; for polynomial systems Breiding, Rose, Timme,
//! *Certifying zeros of polynomial systems using interval arithmetic*, arXiv:2011.05000.) In that
//! case `c + K` contains the solution, and repetition makes it small. `F(c)` is evaluated over
//! balls of 32 digits ([`poly::ComplexBall`]), so that rounding does not make ill-conditioned
//! solutions fail.
//!
//! * **Real**: for a system with real coefficients the conjugate of a solution is a solution. If
//!   the conjugate of the small box lies in the large one, both solutions are the same. **Not
//!   real**: the imaginary part of some coordinate is not zero in the small box.
//! * **The same solution**: the small box of one point lies in the large box of another.
//!   **Different solutions**: the small boxes are disjoint.
//!
//! Weights of unknowns and rows come from the system, `|C| |J| |x|`; badly scaled systems therefore
//! need no scaling beforehand.

mod certificate;
mod krawczyk;
mod proof;
mod prover;
mod same;
#[cfg(test)]
mod tests;

pub use certificate::{Certificate, CertifyOptions, Obstacle, Reality};

use crate::checkpoint::CheckpointError;
use crate::monitor::{Monitor, Stage};
use crate::run::Run;
use crate::threads::{IntoParallelRefIterator, ParallelIterator};
use num_complex::Complex64;
use poly::{CompileError, ComplexInterval, Evaluate, System, counted};
use prover::{Prover, Target};

/// Why nothing is certified at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CertifyError {
    /// The system does not compile.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// Not as many equations as unknowns.
    #[error("{} in {}; only square systems can be certified", counted(*.equations, "equation"), counted(*.unknowns, "unknown"))]
    NotSquare {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// A point has the wrong number of coordinates.
    #[error("point {point} has {}, the system has {}", counted(*.found, "coordinate"), counted(*.expected, "unknown"))]
    Length {
        /// The point, from 1.
        point: usize,
        /// Its number of coordinates.
        found: usize,
        /// Number of unknowns.
        expected: usize,
    },
    /// The wrong number of parameters.
    #[error("{} given, the system has {expected}", counted(*.found, "parameter"))]
    Parameters {
        /// Number of intervals given.
        found: usize,
        /// Number of parameters.
        expected: usize,
    },
    /// A checkpoint, in which nothing would be recorded.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

/// What [`certify`] has proved.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Certificates {
    /// A certificate or the reason why there is none, in the order of the points.
    pub points: Vec<Result<Certificate, Obstacle>>,
    /// The first point that is proved to stand for the same solution; `None` for points that are
    /// the first of their kind and for those without certificate.
    pub duplicate_of: Vec<Option<usize>>,
    /// Pairs of points that are proved neither the same solution nor different ones.
    pub unseparated: Vec<[usize; 2]>,
}

impl Certificates {
    /// The certificates of distinct solutions, the first point of each.
    pub fn solutions(&self) -> impl Iterator<Item = &Certificate> {
        let first = self.points.iter().zip(&self.duplicate_of).filter(|(_, duplicate)| duplicate.is_none());
        first.filter_map(|(point, _)| point.as_ref().ok())
    }

    /// Number of points with a certificate.
    pub fn n_certified(&self) -> usize {
        self.points.iter().filter(|p| p.is_ok()).count()
    }

    /// Number of distinct solutions, a lower bound of the number of regular solutions if no pair is
    /// left unseparated.
    pub fn n_distinct(&self) -> usize {
        self.solutions().count()
    }

    /// Number of distinct solutions that are proved real.
    pub fn n_real(&self) -> usize {
        self.solutions().filter(|s| s.reality == Reality::Real).count()
    }

    /// Whether the work was stopped before every point was tried.
    pub fn interrupted(&self) -> bool {
        self.points.contains(&Err(Obstacle::Cancelled))
    }

    /// Whether every point is certified and every two are proved equal or different.
    pub fn complete(&self) -> bool {
        self.n_certified() == self.points.len() && self.unseparated.is_empty()
    }
}

/// Tries to prove that each point is near exactly one solution of `F(x; p) = 0`, for every `p` in
/// the boxes given.
///
/// Points are treated independently on all threads of rayon; the result does not depend on their
/// number. Cost for each: a few interval Jacobians and products of `n x n` matrices; comparing the
/// boxes of N points costs N log N in general position.
///
/// # Errors
/// If the system is not square or does not compile, or if points or parameters do not fit. A point
/// that cannot be certified is no error: see [`Certificates::points`].
pub fn certify(
    system: &System,
    parameters: &[ComplexInterval],
    points: &[Vec<Complex64>],
    options: &CertifyOptions,
) -> Result<Certificates, CertifyError> {
    Run::new().certify(system, parameters, points, options)
}

impl Run {
    /// [`certify`], run in this way. Points that are left when the monitor is cancelled are
    /// [`Obstacle::Cancelled`].
    ///
    /// # Errors
    /// Those of [`certify`]; also if there is a checkpoint, since proofs are not recorded.
    pub fn certify(
        &self,
        system: &System,
        parameters: &[ComplexInterval],
        points: &[Vec<Complex64>],
        options: &CertifyOptions,
    ) -> Result<Certificates, CertifyError> {
        self.unrecorded("a certification")?;
        self.install(|| certify_watched(system, parameters, points, options, self.monitor()))
    }
}

fn certify_watched(
    system: &System,
    parameters: &[ComplexInterval],
    points: &[Vec<Complex64>],
    options: &CertifyOptions,
    monitor: &Monitor,
) -> Result<Certificates, CertifyError> {
    let compiled = system.compile()?;
    let n = compiled.variables();
    if compiled.equations() != n {
        return Err(CertifyError::NotSquare { equations: compiled.equations(), unknowns: n });
    }
    if parameters.len() != compiled.parameters() {
        return Err(CertifyError::Parameters { found: parameters.len(), expected: compiled.parameters() });
    }
    if let Some(k) = points.iter().position(|point| point.len() != n) {
        return Err(CertifyError::Length { point: k + 1, found: points[k].len(), expected: n });
    }
    let real = system.is_real() && parameters.iter().all(|p| p.im.low == 0.0 && p.im.high == 0.0);
    let target = Target { system: &compiled, parameters };
    monitor.enter(Stage::Proofs, points.len() as u64);
    let prove = |prover: &mut Prover<'_>, point: &Vec<Complex64>| {
        if monitor.is_cancelled() {
            return Err(Obstacle::Cancelled);
        }
        let proof = prover.prove(point);
        monitor.add(1, u64::from(proof.is_ok()));
        proof
    };
    let proofs: Vec<_> = points.par_iter().map_init(|| Prover::new(&target, options), prove).collect();
    let (duplicate_of, unseparated) = same::compare(&proofs);
    let points = proofs.into_iter().map(|proof| proof.map(|p| p.certificate(real))).collect();
    Ok(Certificates { points, duplicate_of, unseparated })
}
