//! From expanded polynomials to solutions: start systems one after the other, as long as paths are
//! lost.

use super::classify::{Classified, Tracked, Zoomed, classify};
use super::conditioned::conditioned;
use super::equations::Equations;
use super::error::SolveError;
use super::excess::Excess;
use super::graph::Graph;
use super::infinity::Line;
use super::judged;
use super::options::{SolveOptions, Start};
use super::paths::{Route, are_hopeless, follow};
use super::portions::{Announced, serve};
use super::slack;
use super::solutions::Solutions;
use super::start::Starts;
use crate::checkpoint::{Checkpoint, Part};
use crate::distinct::Known;
use crate::monitor::Monitor;
use crate::ranks::{Lead, Worker};
use crate::singular::Given;
use crate::start::MixedError;
use crate::tolerances::ENDS;
use crate::tracker::Trackers;
use poly::{Exact, Polynomial};
use std::borrow::Cow;

/// Clusters of solutions are looked at within clusters this often.
const ZOOMS: usize = 3;

/// Where a solve takes place.
#[derive(Clone, Copy, Default)]
pub(crate) struct Place<'a> {
    /// Where it is recorded.
    pub(crate) checkpoint: Option<&'a Checkpoint>,
    /// Among other ranks, of which this is the first.
    pub(crate) lead: Option<&'a Lead<'a>>,
    /// Among other ranks, of which this is not the first: there are no solutions here.
    pub(crate) worker: Option<&'a Worker<'a>>,
}

/// The solutions of polynomials in unknowns of these names, which the result does not have.
pub(crate) fn solve_polynomials(
    polynomials: &[Polynomial<Exact>],
    names: &[String],
    options: &SolveOptions,
    monitor: &Monitor,
    place: Place<'_>,
) -> Result<Solutions, SolveError> {
    solve_zoomed(polynomials, names, options, monitor, Zooms::default(), false, place)
}

/// [`solve_polynomials`] of equations that are too many, some of them general hyperplanes: linear ones
/// are kept as they are, and the others may get further [unknowns](slack) instead of being combined.
pub(crate) fn solve_sliced(
    polynomials: &[Polynomial<Exact>],
    names: &[String],
    options: &SolveOptions,
    monitor: &Monitor,
) -> Result<Solutions, SolveError> {
    solve_zoomed(polynomials, names, options, monitor, Zooms::default(), true, Place::default())
}

/// [`solve_polynomials`] of equations around ends of others, whose work this is.
pub(super) fn solve_around(
    polynomials: &[Polynomial<Exact>],
    around: &Given,
    zooms: usize,
    monitor: &Monitor,
) -> Option<Solutions> {
    let names: Vec<String> = (0..polynomials.first()?.variables()).map(|k| format!("x{k}")).collect();
    let zooms = Zooms { depth: zooms, around: Some(around) };
    // Cancelled with the rest, but no progress that is to be told.
    let found =
        solve_zoomed(polynomials, &names, &SolveOptions::new(), &monitor.quiet(), zooms, false, Place::default())
            .ok()?;
    (!found.interrupted).then_some(found)
}

/// How often equations are zoomed, and around ends of which ones.
#[derive(Clone, Copy, Default)]
struct Zooms<'a> {
    depth: usize,
    around: Option<&'a Given>,
}

/// The same for equations that are zoomed.
fn solve_zoomed(
    polynomials: &[Polynomial<Exact>],
    names: &[String],
    options: &SolveOptions,
    monitor: &Monitor,
    zooms: Zooms<'_>,
    sliced: bool,
    place: Place<'_>,
) -> Result<Solutions, SolveError> {
    // The equations around ends that are not told apart.
    let zoomed =
        |polynomials: &[Polynomial<Exact>], around: &Given| solve_around(polynomials, around, zooms.depth + 1, monitor);
    let zoomed: Option<&Zoomed<'_>> = if zooms.depth < ZOOMS { Some(&zoomed) } else { None };
    let equations = Equations::new(polynomials, names)?;
    let equations = match conditioned(polynomials) {
        Cow::Borrowed(_) => equations,
        Cow::Owned(rewritten) => Equations::new(&rewritten, names)?,
    };
    // A single equation has no condition number to tell, and combinations are rounded.
    let exact = equations.exact && (2..=names.len()).contains(&polynomials.len());
    let units = equations.units();
    let given = Given::new(polynomials, units.clone()).heeding(monitor);
    let univariate = given.univariate_degrees().filter(|_| !options.torus_only);
    let excess = Excess::new(&given, options.torus_only);
    let nothing = Solutions { interrupted: true, ..Solutions::default() };
    let square = match sliced.then(|| slack::squared(&equations, options, monitor)) {
        Some(Err(SolveError::Mixed(MixedError::Cancelled))) => return Ok(nothing),
        Some(other) => other?,
        None => None,
    };
    let (equations, slack, own) = match square {
        Some(square) => (square.equations, square.slack, Some(square.options)),
        None => (equations, None, None),
    };
    let options = own.as_ref().unwrap_or(options);
    let mut starts = match Starts::new(equations, options, monitor) {
        Err(SolveError::Mixed(MixedError::Cancelled)) => return Ok(nothing),
        other => other?,
    };
    let mut retracked = 0;
    let mut best = BestStart::default();
    let mut start_systems = 0;
    // First, on trial, those of one stage.
    let mut direct = starts.direct(options);
    let Place { checkpoint, lead, worker } = place;
    if let Some(worker) = worker {
        while let Some(task) = worker.next::<Announced>()? {
            let monitor = &task.monitor;
            let from = direct.as_mut().filter(|_| task.content.trial).unwrap_or(&mut starts);
            let start = match from.system(task.content.attempt, options, monitor) {
                Err(SolveError::Mixed(MixedError::Cancelled)) => continue,
                other => other?,
            };
            let (count, target, trackers) = (from.paths, &from.target[..], &Trackers::new(&from.system));
            let (start, excess) = (&start, &excess);
            serve(
                worker,
                &task,
                Route { trackers, start, count, target, excess, options, monitor, record: None, lead },
            )?;
        }
        return Ok(nothing);
    }
    for number in 0.. {
        let trial = direct.is_some();
        let from = direct.as_mut().unwrap_or(&mut starts);
        if let Some(lead) = lead {
            lead.begin_part(&Announced { trial, attempt: u64::from(start_systems) }, 1);
        }
        let start = match from.system(u64::from(start_systems), options, monitor) {
            Err(SolveError::Mixed(MixedError::Cancelled)) => break,
            other => other?,
        };
        let (count, target) = (from.paths, &from.target[..]);
        let mut ends = {
            // Their memory is given back before the ends are sorted.
            let own = sliced.then(|| slack::of_attempt(options, start_systems));
            let options = own.as_ref().unwrap_or(options);
            let trackers = Trackers::new(&from.system);
            let record = checkpoint.map(|checkpoint| Part { checkpoint, number });
            let (trackers, start, excess) = (&trackers, &start, &excess);
            follow(Route { trackers, start, count, target, excess, options, monitor, record, lead }, trial)
        };
        if let Some(error) = checkpoint.and_then(Checkpoint::failure) {
            return Err(error.into());
        }
        if let Some(error) = lead.and_then(Lead::failure) {
            return Err(error.into());
        }
        if !ends.abandoned {
            start_systems += 1;
            retracked += ends.retracked;
            let line = Line { supports: &from.equations.supports, target };
            let work = judged::work(&given, count).min(zooms.around.map_or(u64::MAX, Given::left));
            let (system, target) = match &slack {
                Some(slack) => {
                    slack.shorten(&mut ends);
                    (&slack.combined.0, &slack.combined.1[..])
                }
                None => (&from.system, target),
            };
            let tracked =
                Tracked { given: &given, work, polynomials, system, target, line: Some(line), exact, monitor, zoomed };
            // For a polynomial in one unknown there is a better way to all roots than other paths.
            let whole = univariate.is_none_or(|(_, degree)| ends.lost == 0 && ends.regular.len() == degree);
            let graph = if whole || monitor.is_cancelled() { None } else { Graph::new(polynomials) };
            let roots = graph.and_then(|graph| graph.solutions(&units, &tracked));
            let found = match roots {
                Some(roots) => Classified { solutions: roots, ..Classified::default() },
                None => {
                    let found = classify(Some(&tracked), &ends, &excess, options.paths.coincidence);
                    // All paths end at roots, those that seem to go to infinity too.
                    let astray = if univariate.is_some() { found.infinite } else { 0 };
                    Classified { lost: found.lost + astray, infinite: found.infinite - astray, ..found }
                }
            };
            let all = !options.torus_only && options.known.is_none() && !monitor.is_cancelled();
            let found = if all { found.checked(polynomials, &units, &tracked, count) } else { found };
            let this = BestStart { start: Some(from.kind), tracked: from.paths, found };
            best = if start_systems == 1 { this } else { best.joined(this) };
            let hopeless = univariate.is_some() || are_hopeless(ends.lost, count);
            let last = start_systems > options.restarts || hopeless;
            if best.found.lost == 0 || last || monitor.is_cancelled() {
                break;
            }
        }
        direct = None;
    }
    if let Some(around) = zooms.around {
        around.spend(given.spent());
    }
    let whole = start_systems > 0 && best.found.lost == 0;
    let BestStart { start, tracked, found } = best;
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

/// The best start system so far, and what all of them have given.
#[derive(Default)]
struct BestStart {
    /// The one that lost fewest paths, the first of such.
    start: Option<Start>,
    tracked: usize,
    /// What it has found, with the solutions that only others have.
    found: Classified,
}

impl BestStart {
    fn joined(self, new: BestStart) -> BestStart {
        let (mut better, other) = if self.found.lost <= new.found.lost { (self, new) } else { (new, self) };
        if better.found.lost == 0 {
            return better;
        }
        let known = Known::new(better.found.solutions.iter().map(|s| &s.value[..]));
        let mut new = other.found.solutions;
        new.retain(|s| !s.singular && !known.has(&s.value, ENDS.cluster));
        let before = better.found.solutions.len();
        better.found.solutions.extend(new);
        // Each of them is the end of a path that was lost.
        better.found.lost = better.found.lost.saturating_sub(better.found.solutions.len() - before);
        better
    }
}
