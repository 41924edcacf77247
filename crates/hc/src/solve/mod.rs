//! The front door: all isolated solutions of a polynomial system.

mod classify;
mod equations;
mod family;
mod paths;
mod prints;
mod start;

use crate::distinct::relative_distance;
use crate::endgame::EndgameOptions;
use crate::fibre::{FibreOptions, PathCounts};
use crate::monitor::Monitor;
use crate::start::MixedError;
use crate::tracker::{OptionError, TrackerOptions};
use classify::{Classified, Excess, classify};
use equations::Equations;
pub use family::solve_member;
use num_complex::Complex64;
use poly::{Exact, Polynomial, SupportError};
use serde::Serialize;
use start::Starts;

/// Which start system is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Start {
    /// The one with the least work. Polyhedral never has more paths than the others, but two stages instead of one: where another has
    /// hardly more (an eighth) that is tried first, and abandoned for polyhedral if more than an eighth of its paths do not end
    /// at regular solutions, or if one is lost. Systems whose mixed cells do not fit into 126 bits are left to the others too.
    #[default]
    Auto,
    /// Polyhedral: as many paths as the mixed volume.
    Polyhedral,
    /// Products of linear forms in the unknowns of given groups ([`SolveOptions::groups`]): as many paths as the multihomogeneous
    /// Bezout number, and no stage before them.
    Multihomogeneous,
    /// Total degree: as many paths as the product of the degrees, and no stage before them. Its coefficients are so special that
    /// paths may go to infinity in degenerate ways.
    TotalDegree,
}

/// Settings of [`solve`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct SolveOptions {
    /// Seed of everything random. Default 0.
    pub seed: u64,
    /// The start system. Default [`Start::Auto`].
    pub start: Start,
    /// Groups of unknowns, by their indices, for [`Start::Multihomogeneous`]; every unknown belongs to just one. Default none.
    pub groups: Vec<Vec<usize>>,
    /// Whether solutions with zero coordinates are left out, with the paths that lead to them. Default false.
    pub torus_only: bool,
    /// More paths than this are refused. Default 2^24.
    pub max_paths: u64,
    /// Settings of both stages. Default [`TrackerOptions::fast`]: paths that jump are found by their ends and tracked again.
    pub paths: FibreOptions,
    /// Settings for the ends of paths that are not regular.
    pub endgame: EndgameOptions,
    /// How many regular solutions there are, if that is known, for instance of a family. Once so many are found, paths without an
    /// end are left where they are and count as dropped; as long as paths share an end, these alone are tracked again. Default `None`:
    /// every path is taken to its end.
    pub known: Option<usize>,
    /// How often everything is done again from another start system while paths are lost. Default 2.
    pub restarts: u32,
}

impl Default for SolveOptions {
    fn default() -> Self {
        SolveOptions {
            seed: 0,
            start: Start::Auto,
            groups: Vec::new(),
            torus_only: false,
            max_paths: 1 << 24,
            paths: FibreOptions { tracker: TrackerOptions::fast(), ..FibreOptions::default() },
            endgame: EndgameOptions::default(),
            known: None,
            restarts: 2,
        }
    }
}

impl SolveOptions {
    /// Lets somebody watch, and stop, the work.
    pub fn set_monitor(&mut self, monitor: Monitor) {
        self.paths.tracker.monitor = monitor;
    }

    /// Who watches.
    pub fn monitor(&self) -> &Monitor {
        &self.paths.tracker.monitor
    }
}

/// An isolated solution.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Solution {
    /// Real and imaginary part of each coordinate.
    pub value: Vec<[f64; 2]>,
    /// Multiplicity: the number of paths that end here.
    pub multiplicity: usize,
    /// The largest winding number of these paths.
    pub winding_number: usize,
    /// Whether the Jacobian is singular here, to working precision.
    pub singular: bool,
    /// Whether all imaginary parts are below 1e-10 of the largest coordinate (or of one); 1e-7 where singular.
    pub real: bool,
    /// Largest residual, relative to its row of the Jacobian times the sizes of the coordinates; where that is singular,
    /// relative to the sizes of the terms of the equation.
    pub residual: f64,
    /// Condition number of the scaled Jacobian.
    pub condition: f64,
    /// Whether the solution is certified; `None` where that was not asked for.
    pub certified: Option<bool>,
}

/// A direction in which paths go to infinity.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct Direction {
    /// Unknown `j` is of order `t^(valuations[j] / denominator)` as `t` falls to zero.
    pub valuations: Vec<i64>,
    /// The winding number.
    pub denominator: usize,
    /// Number of paths.
    pub paths: usize,
}

/// What [`solve`] has found.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Solved {
    /// The start system that was used, never [`Start::Auto`]; `None` where paths came from a stored fibre or did not begin.
    pub start: Option<Start>,
    /// The mixed volume of the supports, the origin included unless only the torus was asked for; `None` where it was not needed.
    pub mixed_volume: Option<u64>,
    /// The product of the degrees: the paths of total degree. `None` if exponents are negative or the number does not fit.
    pub bezout_number: Option<u64>,
    /// The multihomogeneous Bezout number of the groups that were given; `None` as above, or without groups.
    pub multihomogeneous_number: Option<u64>,
    /// How the paths ended: `finite` at solutions, singular ones and such on components and in excess included.
    pub paths: PathCounts,
    /// Paths that ended on components of positive dimension.
    pub on_components: usize,
    /// Points on such components, one or more on each.
    pub component_points: Vec<Vec<[f64; 2]>>,
    /// Paths that ended at points that were not asked for: those that solve only random combinations of more equations than
    /// unknowns, and those outside the torus where that was asked for.
    pub excess: usize,
    /// Where the paths at infinity went.
    pub directions: Vec<Direction>,
    /// Start systems that were used: more than one if paths were lost.
    pub start_systems: u32,
    /// Whether the work was cancelled: the list is then partial, and paths not tracked count as failed. In JSON `partial`.
    #[serde(rename = "partial")]
    pub interrupted: bool,
    /// The distinct isolated solutions, regular ones first.
    pub solutions: Vec<Solution>,
}

/// Why a system is not solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// A setting outside its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// No polyhedral start system.
    #[error(transparent)]
    Mixed(#[from] MixedError),
    /// Exponents out of range.
    #[error(transparent)]
    Support(#[from] SupportError),
    /// An equation in another number of unknowns than the first.
    #[error("equation {0} has other unknowns than the first; write all in the same unknowns")]
    Mismatched(usize),
    /// Fewer equations than unknowns, or no unknowns.
    #[error(
        "{equations} equations in {unknowns} unknowns have no isolated solutions; add equations, or numbers for some of the unknowns"
    )]
    Underdetermined {
        /// Number of equations.
        equations: usize,
        /// Number of unknowns.
        unknowns: usize,
    },
    /// An equation that is identically zero.
    #[error("equation {0} is zero; leave it out")]
    Zero(usize),
    /// An equation without unknowns.
    #[error("equation {0} is a constant that is not zero, so that there is no solution; is a term missing?")]
    Constant(usize),
    /// A coefficient beyond the range of double precision.
    #[error(
        "equation {0} has a coefficient beyond the range of double precision; divide it by its largest coefficient"
    )]
    Coefficient(usize),
    /// Another start system than the polyhedral one was asked for, but some exponents are negative.
    #[error("this start system needs exponents that are not negative; take the polyhedral one")]
    NegativeExponents,
    /// Groups that are not a partition of the unknowns.
    #[error("every one of the {0} unknowns must stand in just one group")]
    Groups(usize),
    /// A multihomogeneous start system of too many terms or groups.
    #[error("the multihomogeneous start system of these groups is too large; take fewer groups, or the polyhedral one")]
    StartTooLarge,
    /// More paths than allowed.
    #[error("there are {paths} paths, more than the {limit} allowed; lower the exponents or allow more paths")]
    TooManyPaths {
        /// Number of paths; `u64::MAX` if it does not fit.
        paths: u64,
        /// The limit of [`SolveOptions::max_paths`].
        limit: u64,
    },
}

/// Finds the isolated solutions of polynomials, at least as many as unknowns.
///
/// From the solutions of a start system (polyhedral: Huber & Sturmfels 1995, with the origin added to supports for zero coordinates, Li &
/// Wang 1996; or one of fewer stages, [`Start`]) paths lead along a straight line in the coefficients to all isolated solutions. Ends that are not regular
/// go through the [endgame](crate::endgame). More equations than unknowns are combined at random, and the excess
/// solutions are left out again. The same seed gives the same bits on any number of threads.
///
/// ```
/// use hc::solve::{SolveOptions, solve};
/// let system = hc::poly::parse::phcpack("2\nx*(x - y);\n(y - 1)^2*(y + x);")?;
/// let found = solve(&system.expand(&Default::default())?, &SolveOptions::default())?;
/// let mut multiplicities: Vec<usize> = found.solutions.iter().map(|s| s.multiplicity).collect();
/// multiplicities.sort();
/// // The origin and (0, 1), (1, 1), each double.
/// assert_eq!((multiplicities, found.paths.failed), (vec![2, 2, 2], 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If there are too few equations or too many paths, an equation without unknowns, or a number or an option out of range.
pub fn solve(polynomials: &[Polynomial<Exact>], options: &SolveOptions) -> Result<Solved, SolveError> {
    options.paths.validate()?;
    options.endgame.validate()?;
    let given = Equations::new(polynomials)?;
    let excess = Excess::new(&given, options.torus_only)?;
    let mut starts = match Starts::new(given, options) {
        Err(SolveError::Mixed(MixedError::Cancelled)) => return Ok(Solved::nothing()),
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
        let start = match from.system(u64::from(start_systems), options) {
            Err(SolveError::Mixed(MixedError::Cancelled)) => break,
            other => other?,
        };
        let ends = paths::follow(&from.system, &start, from.paths, &from.target, trial, &excess, options);
        if !ends.abandoned {
            start_systems += 1;
            retracked += ends.retracked;
            let member = Some((&from.system, &from.target[..]));
            let found = classify(member, &ends, &excess, options.paths.coincidence);
            let this = Best { start: Some(from.kind), tracked: from.paths, found };
            best = if start_systems == 1 { this } else { best.joined(this) };
            if best.found.lost == 0 || start_systems > options.restarts || options.monitor().is_cancelled() {
                break;
            }
        }
        direct = None;
    }
    let whole = start_systems > 0 && best.found.lost == 0;
    let Best { start, tracked, found } = best;
    let paths = found.counts(tracked, retracked);
    let mut solutions = found.solutions;
    solutions.iter_mut().for_each(|s| starts.equations.unscale(&mut s.value));
    let pairs = |x: &Vec<Complex64>| x.iter().map(|z| [z.re, z.im]).collect::<Vec<[f64; 2]>>();
    let mut component_points: Vec<Vec<[f64; 2]>> = found.component_points.iter().map(pairs).collect();
    component_points.iter_mut().for_each(|x| starts.equations.unscale(x));
    Ok(Solved {
        start: start.or(Some(starts.kind)),
        mixed_volume: starts.numbers.mixed_volume,
        bezout_number: starts.numbers.bezout,
        multihomogeneous_number: starts.numbers.multihomogeneous,
        paths,
        on_components: found.on_components,
        component_points,
        excess: found.excess,
        directions: found.directions,
        start_systems,
        // Nothing is missing if the last path had ended already.
        interrupted: options.monitor().is_cancelled() && !whole,
        solutions,
    })
}

impl Solved {
    /// Of work that was cancelled before there were paths.
    fn nothing() -> Solved {
        Solved {
            start: None,
            mixed_volume: None,
            bezout_number: None,
            multihomogeneous_number: None,
            paths: PathCounts::default(),
            on_components: 0,
            component_points: Vec::new(),
            excess: 0,
            directions: Vec::new(),
            start_systems: 0,
            interrupted: true,
            solutions: Vec::new(),
        }
    }
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
        let point = |s: &Solution| s.value.iter().map(|z| Complex64::new(z[0], z[1])).collect::<Vec<_>>();
        let known: Vec<Vec<Complex64>> = better.found.solutions.iter().map(point).collect();
        let new = other.found.solutions.into_iter().filter(|s| !s.singular);
        let new = new.filter(|s| known.iter().all(|x| relative_distance(x, &point(s)) > paths::CLUSTER));
        better.found.solutions.extend(new);
        better
    }
}
