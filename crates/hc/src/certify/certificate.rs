//! What is proved about one point, or why nothing is proved, and how far proofs may reach.

use num_complex::Complex64;
use poly::ComplexInterval;

/// Settings of [`certify`](super::certify()).
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CertifyOptions {
    /// How far a point may be from the solution that it represents, as a share of the size of each
    /// coordinate. The size counts as at least 1e-4 of the largest coordinate or of one. In any
    /// case, Newton's method must contract from the point. Default 1e-3.
    pub reach: f64,
    /// Largest box that is tried, as a share of the weights of the unknowns. Default 2^-8.
    pub largest_box: f64,
}

impl Default for CertifyOptions {
    fn default() -> CertifyOptions {
        CertifyOptions { reach: 1e-3, largest_box: 1.0 / 256.0 }
    }
}

/// What is known about the imaginary parts of a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reality {
    /// Proved real in every coordinate.
    Real,
    /// Proved not real in some coordinate.
    NotReal,
    /// Neither is proved.
    Undecided,
}

/// A solution that exists.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Certificate {
    /// The middle of the box: the solution to double precision.
    pub value: Vec<Complex64>,
    /// One rectangle per coordinate; their product contains exactly one solution.
    pub enclosure: Vec<ComplexInterval>,
    /// Whether the solution is real.
    pub reality: Reality,
}

/// Why a point is not certified.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Obstacle {
    /// A coordinate is not finite.
    #[error("a coordinate is not finite")]
    NotFinite,
    /// The Jacobian has no inverse at the point.
    #[error("the Jacobian is singular at the point: the solution is singular, or there is none")]
    Singular,
    /// Newton's method leaves the neighbourhood of the point.
    #[error("Newton's method leads away from the point: it is no approximate solution")]
    Away,
    /// No box around the point passes the test.
    #[error("no box about the point contracts: the solution is singular or nearly so, or there is none")]
    NoContraction,
    /// The work was stopped before the point was tried.
    #[error("not tried: the work was stopped before")]
    Cancelled,
}
