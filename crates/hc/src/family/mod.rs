//! Parameter families: from all solutions for one generic parameter point to all solutions for any
//! other.
//!
//! [`Family`] is the front door. Below it, for programs of one's own ([`poly::Evaluate`]), such as
//! generated ones: [`track_fibre`] and [`move_fibre`], [`FibreTracker`] with its memory and [`Charts`],
//! [`monodromy`], [`find_pair`] and [`trace_test`].

mod charts;
mod compiled;
mod error;
mod fibre;
mod judge;
mod monodromy;
mod orbits;
mod pair;
mod start_file;
mod symmetry;
mod targets;
mod trace;
mod track;

pub use charts::{Charts, OneChart};
pub use compiled::Family;
pub use error::FamilyError;
pub use fibre::{Fibre, FibreOptions, PathCounts};
pub use monodromy::{Monodromy, MonodromyOptions, Stop, monodromy};
pub use pair::find_pair;
pub use start_file::{StartFile, StartFileError};
pub use targets::Targets;
pub use trace::{TraceTest, trace_test};
pub use track::{FibreTracker, move_fibre, track_fibre};

use crate::monitor::Monitor;
use crate::solve::{Solutions, SolveOptions};
use crate::tracker::Trackers;
use num_complex::Complex64;
use poly::{Evaluate, System};

/// Finds the isolated solutions of the member of a family at the parameters `target`, from all
/// solutions at those of `fibre`, with the care of [`solve`](crate::solve): jumped paths are tracked
/// again, ends that are not regular go through the endgame.
///
/// `program` evaluates `family`: its interpreter or a generated one. The start system and torus of
/// `options` have no meaning here. Singular ends are told from points on components of positive
/// dimension by the expanded polynomials; where these are too large, or are none, singular ends count
/// as failed.
///
/// ```
/// use hc::family::{Fibre, solve_member};
/// use hc::SolveOptions;
/// use num_complex::Complex64;
/// let text = "name = \"roots\"\nunknowns = [\"x\"]\nparameters = [\"a\", \"b\"]\nequations = [\"x^2 + a*x + b\"]";
/// let family = hc::poly::parse::family(text)?.system;
/// // From the roots of x^2 + 3 - 4i to (x - 3)^2.
/// let (zero, root) = (Complex64::new(0.0, 0.0), Complex64::new(1.0, 2.0));
/// let fibre = Fibre::new(vec![zero, -root * root], 1, vec![root, -root]);
/// let target = [-6.0, 9.0].map(Complex64::from);
/// let found = solve_member(&family, &family.compile()?, &fibre, &target, &SolveOptions::default());
/// assert_eq!((found.len(), found.solutions[0].multiplicity), (1, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Panics
/// If the system is not square or `target` or the fibre do not fit it.
pub fn solve_member<E: Evaluate>(
    family: &System,
    program: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &SolveOptions,
) -> Solutions {
    crate::solve::solve_member(family, &Trackers::new(program), fibre, target, options, &Monitor::default())
}
