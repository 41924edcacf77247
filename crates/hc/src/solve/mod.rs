//! All isolated solutions of a polynomial system.

mod classify;
mod conditioned;
mod equations;
mod error;
mod excess;
mod infinity;
mod judged;
mod member;
mod options;
mod paths;
mod prints;
mod record;
mod solutions;
mod start;
mod warning;

pub use error::SolveError;
pub(crate) use member::solve_member;
pub use options::{SolveOptions, Start};
pub use solutions::{Direction, Solution, Solutions, Unresolved};
pub use warning::Warning;

use crate::distinct::{CLUSTER, relative_distance};
use crate::monitor::Monitor;
use crate::singular::Given;
use crate::start::MixedError;
use crate::tracker::Trackers;
use classify::{Classified, Tracked, classify};
use conditioned::conditioned;
use equations::Equations;
use excess::Excess;
use infinity::Line;
use num_complex::Complex64;
use paths::{Route, are_hopeless, follow};
use poly::{Exact, ExpandLimits, Polynomial, System};
use solutions::Member;
use start::Starts;
use std::borrow::Cow;

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

/// The solutions of polynomials in unknowns of these names, which the result does not have.
pub(crate) fn solve_polynomials(
    polynomials: &[Polynomial<Exact>],
    names: &[String],
    options: &SolveOptions,
    monitor: &Monitor,
) -> Result<Solutions, SolveError> {
    let equations = Equations::new(polynomials, names)?;
    let equations = match conditioned(polynomials) {
        Cow::Borrowed(_) => equations,
        Cow::Owned(rewritten) => Equations::new(&rewritten, names)?,
    };
    // A single equation has no condition number to tell, and combinations are rounded.
    let exact = equations.exact && (2..=names.len()).contains(&polynomials.len());
    let units = equations.units();
    let given = Given::new(polynomials, units.clone());
    let univariate = given.univariate_degrees().filter(|_| !options.torus_only);
    let excess = Excess::new(&given, options.torus_only);
    let nothing = Solutions { interrupted: true, ..Solutions::default() };
    let mut starts = match Starts::new(equations, options, monitor) {
        Err(SolveError::Mixed(MixedError::Cancelled)) => return Ok(nothing),
        other => other?,
    };
    let mut retracked = 0;
    let mut best = Best::default();
    let mut start_systems = 0;
    // First, on trial, those of one stage.
    let mut direct = starts.direct(options);
    loop {
        let trial = direct.is_some();
        let from = direct.as_mut().unwrap_or(&mut starts);
        let start = match from.system(u64::from(start_systems), options, monitor) {
            Err(SolveError::Mixed(MixedError::Cancelled)) => break,
            other => other?,
        };
        let (count, target) = (from.paths, &from.target[..]);
        let ends = {
            // Their memory is given back before the ends are sorted.
            let trackers = Trackers::new(&from.system);
            let route = Route { trackers: &trackers, start: &start, count, target, excess: &excess, options, monitor };
            follow(route, trial)
        };
        if !ends.abandoned {
            start_systems += 1;
            retracked += ends.retracked;
            let line = Line { supports: &from.equations.supports, target };
            let system = &from.system;
            let tracked = Tracked { given: &given, polynomials, system, target, line: Some(line), exact, monitor };
            // Of a polynomial in one unknown there is a better way to all roots than other paths.
            let whole = univariate.is_none_or(|(_, degree)| ends.lost == 0 && ends.regular.len() == degree);
            let roots = (!whole && !monitor.is_cancelled())
                .then(|| judged::univariate(polynomials, &units, &tracked))
                .flatten();
            let found = match roots {
                Some(roots) => Classified { solutions: roots, ..Classified::default() },
                None => {
                    let found = classify(Some(&tracked), &ends, &excess, options.paths.coincidence);
                    // All paths end at roots, those that seem to go to infinity too.
                    let astray = if univariate.is_some() { found.infinite } else { 0 };
                    Classified { lost: found.lost + astray, infinite: found.infinite - astray, ..found }
                }
            };
            let this = Best { start: Some(from.kind), tracked: from.paths, found };
            best = if start_systems == 1 { this } else { best.joined(this) };
            let hopeless = univariate.is_some() || are_hopeless(ends.lost, count);
            let last = start_systems > options.restarts || hopeless;
            if best.found.lost == 0 || last || monitor.is_cancelled() {
                break;
            }
        }
        direct = None;
    }
    let whole = start_systems > 0 && best.found.lost == 0;
    let Best { start, tracked, found } = best;
    let mut found = found.solutions(tracked, retracked);
    for solution in &mut found.solutions {
        starts.equations.unscale(&mut solution.value);
    }
    for point in &mut found.component_points {
        starts.equations.unscale(point);
    }
    for end in &mut found.unresolved {
        starts.equations.unscale(&mut end.value);
    }
    Ok(Solutions {
        start: start.or(Some(starts.kind)),
        mixed_volume: starts.numbers.mixed_volume,
        bezout_number: starts.numbers.bezout,
        multihomogeneous_number: starts.numbers.multihomogeneous,
        start_systems,
        // Nothing is missing if the last path had ended already.
        interrupted: monitor.is_cancelled() && !whole,
        ..found
    })
}

/// What the start systems so far have given.
#[derive(Default)]
struct Best {
    /// The one that lost fewest paths, the first of such.
    start: Option<Start>,
    tracked: usize,
    /// What it has found, with the solutions that only others have.
    found: Classified,
}

impl Best {
    fn joined(self, new: Best) -> Best {
        let (mut better, other) = if self.found.lost <= new.found.lost { (self, new) } else { (new, self) };
        if better.found.lost == 0 {
            return better;
        }
        let known: Vec<Vec<Complex64>> = better.found.solutions.iter().map(|s| s.value.clone()).collect();
        let new = other.found.solutions.into_iter().filter(|s| !s.singular);
        let new = new.filter(|s| known.iter().all(|x| relative_distance(x, &s.value) > CLUSTER));
        let before = better.found.solutions.len();
        better.found.solutions.extend(new);
        // Each of them is the end of a path that was lost.
        better.found.lost = better.found.lost.saturating_sub(better.found.solutions.len() - before);
        better
    }
}
