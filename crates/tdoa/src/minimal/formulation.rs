//! What distinguishes one solver with paths from another; [`super::engine`] does everything else.

use super::linear::LeastSquares;
use crate::network::Network;
use hc::Fibre;
use hc::poly::Evaluate;
use num_complex::Complex64;
use smallvec::SmallVec;

/// Unknowns or offsets: few enough to need no allocation.
pub(crate) type Point = SmallVec<[Complex64; 8]>;
/// Parameters likewise.
pub(crate) type Parameters = SmallVec<[Complex64; 24]>;

/// A square family whose parameters are the differences `f_ij - f_1j`, rows `i = 2..m`, row-major,
/// in any unit of length.
pub(crate) trait Formulation {
    /// The evaluator of the equations.
    type System: Evaluate + 'static;
    /// The configuration, such as `6r/3s`.
    const NAME: &'static str;
    /// The family (TOML).
    const FAMILY: &'static str;
    /// Receivers `m`.
    const RECEIVERS: usize;
    /// Transmitters `n`.
    const TRANSMITTERS: usize;
    /// By which power of the unit of length each unknown grows.
    const WEIGHTS: &'static [i32];
    /// Number of charts: forms of the same problem with the nodes in another order. Chart 0 is that
    /// of the data.
    const CHARTS: usize;
    /// Whether there are so many paths that they are tracked on all threads.
    const MANY: bool = false;

    /// The evaluator.
    fn system() -> &'static Self::System;

    /// The stored solutions for one generic parameter point.
    fn fibre() -> Fibre;

    /// Parameters in a chart.
    fn parameters(chart: usize, f: &[Complex64]) -> Parameters;

    /// Carries a solution over into a chart.
    fn enter(chart: usize, x: &[Complex64]) -> Point;

    /// Carries a solution of a chart back.
    fn leave(chart: usize, x: &[Complex64]) -> Point;

    /// `p_j = o_j - f_1j` of a solution, one for each transmitter.
    fn offsets(f: &[Complex64], x: &[Complex64]) -> Point;
}

/// A formulation of networks in the plane or, with `D` = 3, in space.
pub(crate) trait FormulationIn<const D: usize = 2>: Formulation {
    /// The network of a real solution, its first receiver in the origin, its offsets `p_j`; `None`
    /// unless the positions are real.
    fn network(f: &[f64], x: &[f64], squares: &mut LeastSquares) -> Option<Network<D>>;
}
