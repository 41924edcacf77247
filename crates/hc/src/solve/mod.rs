//! All isolated solutions of a polynomial system.

mod classify;
mod cluster;
mod conditioned;
mod ends;
mod equations;
mod error;
mod excess;
mod graph;
mod infinity;
mod judged;
mod member;
mod options;
mod paths;
mod plane;
mod polynomials;
mod prints;
mod record;
mod slack;
mod solutions;
mod start;
mod warning;

pub use error::SolveError;
pub(crate) use member::{ends, solve_member};
pub use options::{SolveOptions, Start};
pub(crate) use polynomials::{solve_polynomials, solve_sliced};
pub use solutions::{Direction, Solution, Solutions, Unresolved};
pub use warning::Warning;

use crate::monitor::Monitor;
use poly::{ExpandLimits, System};
use solutions::Member;

/// Finds the isolated solutions of a system of polynomials, at least as many as unknowns.
///
/// From the solutions of a start system (polyhedral: Huber & Sturmfels 1995, with the origin added
/// to supports for zero coordinates, Li & Wang 1996; or one of fewer stages, [`Start`]) paths lead
/// along a straight line in the coefficients to all isolated solutions. Ends that are not regular
/// go through the endgame. More equations than unknowns are combined at random, and the excess
/// solutions are left out again. The same seed gives the same bits on any number of threads.
///
/// ```
/// let system = hc::poly::parse::phcpack("2\nx*(x - y);\n(y - 1)^2*(y + x);")?;
/// let found = hc::solve(&system, &hc::SolveOptions::new().seed(1))?;
/// let mut multiplicities: Vec<usize> = found.iter().map(|s| s.multiplicity).collect();
/// multiplicities.sort();
/// // The origin and (0, 1), (1, 1), each double.
/// assert_eq!((multiplicities, found.paths.failed), (vec![2, 2, 2], 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If there are too few equations or too many paths, an equation without unknowns, or a number or
/// an option out of range.
pub fn solve(system: &System, options: &SolveOptions) -> Result<Solutions, SolveError> {
    solve_watched(system, options, &Monitor::default())
}

/// [`solve`], watched: once the monitor is cancelled, what is found by then is returned, marked as
/// partial.
///
/// # Errors
/// As [`solve`].
pub fn solve_watched(system: &System, options: &SolveOptions, monitor: &Monitor) -> Result<Solutions, SolveError> {
    options.validate()?;
    if !system.parameters().is_empty() {
        return Err(SolveError::Parameters(system.parameters().join(", ")));
    }
    let polynomials = system.expand(&ExpandLimits::default())?;
    let mut found = solve_polynomials(&polynomials, system.variables(), options, monitor)?;
    found.variables = system.variables().to_vec();
    found.member = Member::new(system, &[]);
    if options.certify {
        found.certify()?;
    }
    Ok(found)
}
