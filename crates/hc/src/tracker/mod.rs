//! The path tracker.
//!
//! In a step of a path, the *predictor* extrapolates from Taylor coefficients of order 3 by Pade
//! approximants of type [2/1]. The *corrector* is Newton's method. It is given up as soon as its
//! first corrections show that it would not converge quadratically. For this the tracker estimates
//! the Lipschitz constant `omega` of Newton's method and the limiting accuracy `mu` (Timme 2020,
//! arXiv:1902.02968; Deuflhard 2004). The next step is bounded by the distance to the nearest pole
//! of the approximants, and by the length for which Newton's method is predicted to converge at
//! once. When `omega mu` says that double precision is not enough, residuals are computed in
//! double-double. Even that may not be enough, because other paths are nearly as near as the next
//! double. The points are then carried in double-double too.
//!
//! Where the ends of a set of paths show which have jumped, most paths need less care: with
//! [`TrackerOptions::quick`] each lane makes one attempt at a step at a time, first in single precision, and
//! what is difficult is left to the tracker above.
//!
//! Paths travel in lanes, eight at once or alone ([`Tracker`] is generic over [`poly::Lane`]). A
//! path takes the same steps to the same bits in either case. [`track`] is the entry point: it
//! spreads paths over threads and returns them in order.

mod batch;
mod correct;
mod judge;
mod kernels;
mod logarithms;
mod options;
mod pool;
mod precise;
mod progress;
mod quick;
mod result;
mod resume;
mod valuation;
mod workspace;

pub use batch::Tracker;
pub use options::{OptionError, TrackerOptions};
pub(crate) use pool::Trackers;
pub(crate) use precise::Precise;
pub use result::{PathEnd, PathResult, PathSet};

use crate::homotopy::ParameterPath;
use crate::monitor::Monitor;
use num_complex::Complex64;
use poly::Evaluate;

/// Tracks the paths with the given indices into `starts` (`n` coordinates per start solution) from
/// `t = 1` to `t = 0`, in lanes of eight and on the threads of the current rayon pool.
///
/// ```
/// use hc::homotopy::Segment;
/// use hc::poly::{Complex64, parse};
/// use hc::tracker::{PathEnd, TrackerOptions, track};
///
/// // Both solutions of x^2 = a, from a = 1 to a = 4.
/// let family = parse::family("name = 'root'\nunknowns = ['x']\nparameters = ['a']\nequations = ['x^2 - a']")?;
/// let real = |x: f64| Complex64::new(x, 0.0);
/// let path = Segment::new(&[real(1.0)], &[real(4.0)]);
/// let starts = [real(1.0), real(-1.0)];
/// let ends = track(&family.system.compile()?, &path, &starts, &[0, 1], &TrackerOptions::default());
/// for ((result, point), root) in ends.iter().zip([2.0, -2.0]) {
///     assert_eq!(result.end, PathEnd::Success);
///     // About the third power of the corrector's tolerance.
///     assert!((point[0] - root).norm() < 1e-10);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The results are in the order of `which` if that is ascending. They are the same, bit for bit,
/// for any number of threads.
///
/// # Panics
/// If the system is not square, an index lies outside `starts`, or the numbers of parameters
/// differ.
pub fn track<E: Evaluate, P: ParameterPath>(
    system: &E,
    path: &P,
    starts: &[Complex64],
    which: &[usize],
    options: &TrackerOptions,
) -> PathSet {
    Trackers::new(system).track(path, starts, which, options, &Monitor::default())
}
