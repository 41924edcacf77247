//! What distinguishes one solver with paths from another; [`super::engine`] does everything else.

use super::linear::LeastSquares;
use super::normalised::Normalised;
use super::orders::Orders;
use crate::clocks::Emissions;
use crate::network::Network;
use crate::pseudoranges::Pseudoranges;
use hc::Fibre;
use hc::poly::Evaluate;
use num_complex::Complex64;
use smallvec::SmallVec;

/// Unknowns or offsets: few enough to need no allocation.
pub(crate) type Point = SmallVec<[Complex64; 8]>;
/// Parameters likewise.
pub(crate) type Parameters = SmallVec<[Complex64; 28]>;

/// A square family whose parameters are the differences `f_ij - f_1j`, rows `i = 2..m`, row-major,
/// in any unit of length; of ranges, their squares in any unit of these, or if all have one constant in common, the ranges.
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
    /// By which power of the unit each unknown grows.
    const WEIGHTS: &'static [i32];
    /// How many parameters grow with the unit; those that follow are ratios.
    const SCALED: usize = usize::MAX;
    /// What is known of offsets.
    const EMISSIONS: Emissions = Emissions::Unknown;
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

    /// The order of the nodes in which measurements are solved; `None` if it is the one nearest to the stored fibre.
    fn orders(_: &Pseudoranges) -> Option<Orders> {
        None
    }

    /// The parameters of some measurements.
    fn given(data: &Normalised, out: &mut Vec<f64>) {
        out.extend_from_slice(data.parameters());
    }

    /// What is real of a real network: `p_j = o_j - f_1j` of a solution, one for each transmitter; of ranges,
    /// squares of distances of receivers, and the constant if there is one.
    fn offsets(f: &[Complex64], x: &[Complex64]) -> Point;
}

/// A formulation of networks in the plane or, with `D` = 3, in space.
pub(crate) trait FormulationIn<const D: usize = 2>: Formulation {
    /// The network of a real solution for the parameters `f`, its first receiver in the origin, its offsets `p_j`, of ranges zero
    /// or the constant; `None` unless the positions are real.
    fn network(f: &[f64], x: &[f64], squares: &mut LeastSquares) -> Option<Network<D>>;
}
