//! From expanded polynomials to solutions: start systems one after the other, as long as paths are
//! lost.

use super::classify::{ClusterSolver, Expanded, Tracked};
use super::conditioned::conditioned;
use super::counted::census_work;
use super::ends::{End, Ends};
use super::equations::ScaledEquations;
use super::error::SolveError;
use super::excess::Excess;
use super::infinity::Line;
use super::options::{SolveOptions, Start};
use super::paths::{Route, are_hopeless, follow};
use super::portions::{Announced, serve};
use super::singular_ends;
use super::slack::{self, Slack};
use super::solutions::Solutions;
use super::start::Starts;
use super::written;
use crate::checkpoint::{Checkpoint, Part};
use crate::distinct::Known;
use crate::exact::number_of_roots;
use crate::monitor::Monitor;
use crate::ranks::{Lead, Worker};
use crate::refine::LaneRefiners;
use crate::singular::ExactEquations;
use crate::start::MixedError;
use crate::tolerances::same;
use crate::tracker::Trackers;
use poly::{Exact, ExpandError, Polynomial, System};
use std::borrow::Cow;

/// Clusters of solutions are looked at within clusters this often.
const NESTED: usize = 3;

/// Where a solve takes place.
#[derive(Clone, Copy, Default)]
pub(crate) struct SolveContext<'a> {
    /// Where it is recorded.
    pub(crate) checkpoint: Option<&'a Checkpoint>,
    /// Among other ranks, of which this is the first.
    pub(crate) lead: Option<&'a Lead<'a>>,
    /// Among other ranks, of which this is not the first: there are no solutions here.
    pub(crate) worker: Option<&'a Worker<'a>>,
    /// How many unknowns, the last ones, and equations, the last ones, are [named sums](poly::System::with_named_sums).
    pub(crate) named_sums: usize,
    /// Whether some equations are general hyperplanes. They are kept as they are, like other linear ones
    /// and those of named sums; the others may get slack [unknowns](slack) instead of being combined.
    pub(crate) sliced: bool,
    /// How deep it is within other solves, the ends of which it tells apart; from [`NESTED`] on its own
    /// ends are told apart no further.
    pub(crate) level: usize,
    /// The equations of the solve around it, to whose work that of this one is added.
    pub(crate) outer: Option<&'a ExactEquations>,
}

/// The solutions of polynomials in unknowns of these names, which the result does not have.
pub(crate) fn solve_polynomials(
    polynomials: &[Polynomial<Exact>],
    names: &[String],
    options: &SolveOptions,
    monitor: &Monitor,
    context: SolveContext<'_>,
) -> Result<Solutions, SolveError> {
    match unless_cancelled(prepared(polynomials, names, options, monitor, context))? {
        Some((problem, starts)) => solved(&problem, starts),
        None => Ok(nothing()),
    }
}

/// The solutions of the equations of a cluster, `level` deep within a solve of the `outer` equations, to
/// whose work that of this one is added.
pub(super) fn solve_cluster(
    polynomials: &[Polynomial<Exact>],
    outer: &ExactEquations,
    level: usize,
    monitor: &Monitor,
) -> Option<Solutions> {
    let names: Vec<String> = (0..polynomials.first()?.variables()).map(|k| format!("x{k}")).collect();
    let context = SolveContext { level, outer: Some(outer), ..SolveContext::default() };
    // Cancelled with the rest, but no progress that is to be told.
    let found = solve_polynomials(polynomials, &names, &SolveOptions::new(), &monitor.quiet(), context).ok()?;
    (!found.interrupted).then_some(found)
}

/// The solutions of formulas that cannot be expanded, which `error` says. They are as many as their
/// unknowns. Ends that are not regular cannot be judged, and count as lost.
pub(super) fn solve_written(
    system: &System,
    error: &ExpandError,
    options: &SolveOptions,
    monitor: &Monitor,
    context: SolveContext<'_>,
) -> Result<Solutions, SolveError> {
    let starts = written::starts(system, error, options)?;
    let problem =
        Problem { expanded: None, roots: None, slack: None, options: Cow::Borrowed(options), monitor, context };
    solved(&problem, starts)
}

/// What there is where nothing was tracked.
fn nothing() -> Solutions {
    Solutions { interrupted: true, ..Solutions::default() }
}

fn solved(problem: &Problem<'_>, mut starts: Starts) -> Result<Solutions, SolveError> {
    let context = problem.context;
    let given = problem.expanded.as_ref().map(|expanded| &expanded.given);
    let unknowns = given.map_or(starts.equations.unknowns, ExactEquations::unknowns) - context.named_sums;
    let excess = Excess::new(given, problem.options.torus_only, unknowns);
    if let Some(worker) = context.worker {
        serve_all(problem, starts, &excess, worker)?;
        return Ok(nothing());
    }
    let attempts = attempted(problem, &mut starts, &excess)?;
    if let (Some(outer), Some(given)) = (context.outer, given) {
        outer.spend(given.spent());
    }
    Ok(assembled(attempts, &starts, problem.monitor))
}

/// The value, or `None` where mixed cells were cancelled.
fn unless_cancelled<T>(result: Result<T, SolveError>) -> Result<Option<T>, SolveError> {
    match result {
        Err(SolveError::Mixed(MixedError::Cancelled)) => Ok(None),
        other => other.map(Some),
    }
}

/// The given equations, and how those that are tracked follow from them.
struct Problem<'a> {
    /// `None` if they cannot be expanded.
    expanded: Option<Expanded<'a>>,
    /// The number of all roots, with their multiplicities, of a single equation in a single unknown.
    roots: Option<usize>,
    slack: Option<Slack>,
    options: Cow<'a, SolveOptions>,
    monitor: &'a Monitor,
    context: SolveContext<'a>,
}

/// Prepares equations, as many as unknowns, and their start systems.
fn prepared<'a>(
    polynomials: &'a [Polynomial<Exact>],
    names: &[String],
    options: &'a SolveOptions,
    monitor: &'a Monitor,
    context: SolveContext<'a>,
) -> Result<(Problem<'a>, Starts), SolveError> {
    let equations = ScaledEquations::new(&conditioned(polynomials), names, context.named_sums)?;
    // A single equation has no condition number to tell, and combinations are rounded.
    let exact = equations.exact && (2..=names.len()).contains(&polynomials.len());
    let seed = context.outer.map_or(options.seed, ExactEquations::seed);
    let expanded = Some(Expanded::new(polynomials, equations.units(), exact, seed, monitor));
    let roots = number_of_roots(polynomials).filter(|_| !options.torus_only);
    let square = if context.sliced { slack::squared(&equations, options, monitor)? } else { None };
    let (equations, slack, options) = match square {
        Some((equations, slack, options)) => (equations, slack, Cow::Owned(options)),
        None => (equations, None, Cow::Borrowed(options)),
    };
    let starts = Starts::new(equations, &options, monitor)?;
    Ok((Problem { expanded, roots, slack, options, monitor, context }, starts))
}

/// Tracks paths of all start systems for rank 0 as long as it sends any.
fn serve_all(
    problem: &Problem<'_>,
    mut starts: Starts,
    excess: &Excess<'_>,
    worker: &Worker<'_>,
) -> Result<(), SolveError> {
    let options = &*problem.options;
    let mut direct = starts.direct(options);
    while let Some(task) = worker.next::<Announced>()? {
        let monitor = &task.monitor;
        let from = direct.as_mut().filter(|_| task.content.trial).unwrap_or(&mut starts);
        let system = from.system(task.content.attempt, options, monitor);
        let Some(start) = unless_cancelled(system)? else { continue };
        let (count, target) = (from.paths, &from.target[..]);
        let (trackers, refiners, start) = (&Trackers::new(&from.system), &LaneRefiners::new(&from.system), &start);
        let route = Route {
            trackers,
            refiners,
            start,
            count,
            target,
            excess,
            options,
            monitor,
            record: None,
            lead: None,
            moving: None,
            has_other_ways: true,
        };
        serve(worker, &task, route)?;
    }
    Ok(())
}

/// What all start systems have given so far.
struct Attempts {
    start_systems: u32,
    retracked: usize,
    /// The start system that lost fewest paths, the first of such.
    start: Option<Start>,
    /// What it has found, with the solutions that only others have.
    best: Ends,
}

/// Tracks the paths of one start system after the other until none are lost, or another start system
/// would not help.
fn attempted(problem: &Problem<'_>, starts: &mut Starts, excess: &Excess<'_>) -> Result<Attempts, SolveError> {
    let (options, monitor, context) = (&*problem.options, problem.monitor, problem.context);
    let mut attempts = Attempts { start_systems: 0, retracked: 0, start: None, best: Ends::new(0) };
    // First, on trial, those of one stage.
    let mut direct = starts.direct(options);
    for number in 0.. {
        let trial = direct.is_some();
        let from = direct.as_mut().unwrap_or(&mut *starts);
        let attempt = attempts.start_systems;
        if let Some(lead) = context.lead {
            lead.begin_part(&Announced { trial, attempt: u64::from(attempt) }, 1);
        }
        let system = from.system(u64::from(attempt), options, monitor);
        let Some(start) = unless_cancelled(system)? else { break };
        let mut ends = {
            // Their memory is given back before the ends are sorted.
            let options = match context.sliced {
                true => Cow::Owned(slack::of_attempt(options, attempt)),
                false => Cow::Borrowed(options),
            };
            let (trackers, refiners) = (&Trackers::new(&from.system), &LaneRefiners::new(&from.system));
            let (start, lead) = (&start, context.lead);
            let record = context.checkpoint.map(|checkpoint| Part { checkpoint, number });
            let (count, target, options) = (from.paths, &from.target[..], &*options);
            follow(
                Route {
                    trackers,
                    refiners,
                    moving: None,
                    start,
                    count,
                    target,
                    excess,
                    options,
                    monitor,
                    record,
                    lead,
                    has_other_ways: true,
                },
                trial,
            )
        };
        if let Some(error) = context.checkpoint.and_then(Checkpoint::failure) {
            return Err(error.into());
        }
        if let Some(error) = context.lead.and_then(Lead::failure) {
            return Err(error.into());
        }
        if !ends.abandoned {
            let hopeless = problem.roots.is_some() || are_hopeless(ends.lost(), from.paths);
            attempts.start_systems += 1;
            attempts.retracked += ends.retracked;
            let mut found = problem.solutions_at(ends, from, excess);
            // Other paths would come to the ends for which no work is left.
            let needless = found.lost() <= found.unexamined;
            attempts.join(from.kind, found);
            if let Some(expanded) = &problem.expanded
                && let Some(census) = expanded.counted()
            {
                attempts.best.accept(census, expanded.elsewhere());
            }
            let last = attempts.start_systems > options.restarts || hopeless || needless;
            if attempts.best.lost() == 0 || last || monitor.is_cancelled() {
                break;
            }
        }
        direct = None;
    }
    Ok(attempts)
}

impl Problem<'_> {
    /// The solutions at the ends of all paths of a start system, and those that other methods find if
    /// some are missing.
    fn solutions_at(&self, mut ends: Ends, from: &Starts, excess: &Excess<'_>) -> Ends {
        let (coincidence, monitor) = (self.options.paths.coincidence, self.monitor);
        let SolveContext { level, outer, .. } = self.context;
        let Some(expanded) = &self.expanded else { return ends.judged(None, excess, coincidence) };
        let line = Line { supports: &from.equations.supports, target: &from.coefficients };
        let work = singular_ends::work(&expanded.given, from.paths).min(outer.map_or(u64::MAX, ExactEquations::left));
        let all = !self.options.torus_only && self.options.known.is_none() && !monitor.is_cancelled();
        let census_work = if all && level == 0 { census_work(&expanded.given, from.paths) } else { 0 };
        let (system, target) = match &self.slack {
            Some(slack) => {
                slack.shorten(&mut ends);
                (&slack.combined.0, &slack.combined.1[..])
            }
            None => (&from.system, &from.target[..]),
        };
        let solver = |polynomials: &[Polynomial<Exact>], outer: &ExactEquations| {
            solve_cluster(polynomials, outer, level + 1, monitor)
        };
        let tracked = Tracked {
            expanded,
            work,
            census_work,
            system,
            target,
            line: Some(line),
            monitor,
            solve_cluster: (level < NESTED).then_some(&solver as &ClusterSolver<'_>),
        };
        // There is a better way to all roots of a polynomial in one unknown than other paths.
        let missing = self.roots.is_some_and(|roots| ends.lost() > 0 || ends.regular.len() != roots);
        if missing
            && !monitor.is_cancelled()
            && let Some(solutions) = tracked.solutions()
        {
            return ends.with_all(solutions).decide_real(expanded);
        }
        let mut ends = ends.judged(Some(&tracked), excess, coincidence);
        if self.roots.is_some() {
            // All paths end at roots, those that seem to go to infinity too.
            (0..ends.directions.len()).for_each(|k| ends.reassign(ends.paths, End::infinite(k), End::LOST));
        }
        if all { ends.checked(&tracked) } else { ends }.decide_real(expanded)
    }
}

/// The solutions that all start systems have given, in the unknowns themselves.
fn assembled(attempts: Attempts, starts: &Starts, monitor: &Monitor) -> Solutions {
    let Attempts { start_systems, retracked, start, mut best } = attempts;
    let whole = start_systems > 0 && best.lost() == 0;
    let mut found = best.solutions(retracked);
    for solution in &mut found.solutions {
        starts.equations.unscale(&mut solution.value);
    }
    for point in &mut found.component_points {
        starts.equations.unscale(point);
    }
    for end in &mut found.unresolved {
        starts.equations.unscale(&mut end.value);
    }
    Solutions {
        start: start.or(Some(starts.kind)),
        mixed_volume: starts.numbers.mixed_volume,
        bezout_number: starts.numbers.bezout,
        multihomogeneous_number: starts.numbers.multihomogeneous,
        start_systems,
        // Nothing is missing if the last path had ended already.
        interrupted: monitor.is_cancelled() && !whole,
        ..found
    }
}

impl Attempts {
    /// Joins what one more start system has given: `new`, with the solutions that only others have, if it
    /// loses fewer paths than those before.
    fn join(&mut self, start: Start, mut new: Ends) {
        if self.start.is_some() {
            let keeps = self.best.lost() <= new.lost();
            if !keeps {
                (self.start, self.best, new) = (Some(start), new, std::mem::replace(&mut self.best, Ends::new(0)));
            }
            if self.best.lost() > 0 {
                let known = Known::new(self.best.solutions.iter().map(|s| &s.value[..]));
                new.solutions.retain(|s| !s.singular && !known.has(&s.value, same::SINGULAR));
                self.best.add_missed(new.solutions);
            }
        } else {
            (self.start, self.best) = (Some(start), new);
        }
    }
}
