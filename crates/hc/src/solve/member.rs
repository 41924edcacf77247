//! The members of a parameter family, from its stored fibre.

use super::classify::{Expanded, Tracked};
use super::ends::Ends;
use super::excess::{Excess, Stray};
use super::options::SolveOptions;
use super::paths::{Route, follow};
use super::polynomials::solve_cluster;
use super::singular_ends::work;
use super::solutions::{Member, Solutions, is_real_in_doubt};
use crate::family::{Fibre, Limit};
use crate::monitor::Monitor;
use crate::moving::MovingTrackers;
use crate::refine::{LaneRefiners, Refined};
use crate::singular::ExactEquations;
use crate::start::PathSystem;
use crate::tracker::Trackers;
use num_complex::Complex64;
use num_traits::ToPrimitive;
use poly::{Evaluate, Exact, Polynomial, SparseSystem, System};
use std::borrow::Cow;

/// The isolated solutions of the member of a family at the parameters `target`, from those at the
/// parameters of `fibre`, all of which are tracked. `trackers` belong to the second system, which is square: the family,
/// or combinations of it that have all its solutions. Regular ends are solutions of these, and paths to the `stray` ones
/// are tracked again; singular ends are judged by the family. `moving` tracks with fewer operations up to where the
/// endgame begins. The result does not know its member yet ([`Solutions::of_member`]).
pub(crate) fn solve_member<'e, E: Evaluate>(
    systems: [&System; 2],
    (trackers, refiners, moving): (&Trackers<'e, E>, &LaneRefiners<'e, E>, Option<&MovingTrackers<'e>>),
    fibre: &Fibre,
    target: &[Complex64],
    stray: Option<&Stray<'_>>,
    options: &SolveOptions,
    monitor: &Monitor,
) -> Solutions {
    let excess = &Excess::with_stray(stray);
    let ends = followed((trackers, refiners, moving), fibre, target, excess, options, monitor);
    let real_coefficients = systems[0].is_real() && target.iter().all(|p| p.im == 0.0);
    let in_doubt = |end: &Refined| is_real_in_doubt(&end.point, end.condition, real_coefficients);
    let asks = !ends.singular.is_empty() || ends.regular.values().any(in_doubt);
    let expanded = if asks { expanded(systems, target, options.seed, monitor) } else { None };
    let solver =
        |polynomials: &[Polynomial<Exact>], outer: &ExactEquations| solve_cluster(polynomials, outer, 0, monitor);
    let tracked = expanded.as_ref().map(|(expanded, system, target)| Tracked {
        expanded,
        work: work(&expanded.given, fibre.len()),
        census_work: 0,
        system,
        target,
        line: None,
        monitor,
        solve_cluster: Some(&solver),
    });
    let (retracked, bounded) = (ends.retracked, ends.bounded);
    let mut ends = ends.judged(tracked.as_ref(), excess, options.paths.coincidence);
    if let Some(tracked) = &tracked {
        ends = ends.decide_real(tracked.expanded);
    }
    let lost = ends.lost() > 0;
    let limited = (bounded && lost).then_some(Limit::Again);
    Solutions { start_systems: 1, interrupted: monitor.is_cancelled() && lost, limited, ..ends.solutions(retracked) }
}

impl Solutions {
    /// Notes that these solutions belong to the member of `family` at these parameters. The member
    /// is not serialized.
    pub(crate) fn of_member(self, family: &System, target: &[Complex64]) -> Solutions {
        Solutions { variables: family.variables().to_vec(), member: Member::new(family, target), ..self }
    }
}

/// The points at which the solutions of a fibre end at other parameters, singular ones among them.
pub(crate) fn ends<E: Evaluate>(
    family: &E,
    fibre: &Fibre,
    target: &[Complex64],
    options: &SolveOptions,
    monitor: &Monitor,
) -> impl Iterator<Item = Vec<Complex64>> {
    let trackers = Trackers::from_solutions(family, &fibre.parameters, &fibre.solutions);
    let with = (&trackers, &LaneRefiners::new(family), None);
    let ends = followed(with, fibre, target, &Excess::none(), options, monitor);
    let regular = ends.regular.into_values().map(|end| end.point);
    regular.chain(ends.singular.into_values().map(|end| end.point))
}

/// Where the paths from all solutions of a fibre end.
fn followed<'e, E: Evaluate>(
    (trackers, refiners, moving): (&Trackers<'e, E>, &LaneRefiners<'e, E>, Option<&MovingTrackers<'e>>),
    fibre: &Fibre,
    target: &[Complex64],
    excess: &Excess<'_>,
    options: &SolveOptions,
    monitor: &Monitor,
) -> Ends {
    let count = fibre.len();
    follow(
        Route {
            trackers,
            refiners,
            moving,
            start: fibre,
            count,
            target,
            excess,
            options,
            monitor,
            record: None,
            lead: None,
            has_other_ways: false,
        },
        false,
    )
}

/// The polynomials of a member, and the supports and coefficients of those that are tracked.
fn expanded(
    [family, square]: [&System; 2],
    target: &[Complex64],
    seed: u64,
    monitor: &Monitor,
) -> Option<(Expanded<'static>, PathSystem, Vec<Complex64>)> {
    let at_target = |system: &System| system.at(target).ok()?.expand(&Default::default()).ok();
    let polynomials = at_target(family)?;
    let unknowns = family.variables().len();
    let is_square = polynomials.len() == unknowns;
    let tracked = if is_square { Cow::Borrowed(&polynomials) } else { Cow::Owned(at_target(square)?) };
    let supports: Vec<Vec<Vec<i32>>> = tracked.iter().map(Polynomial::support).collect();
    let terms = tracked.iter().flat_map(|p| p.terms());
    let numbers = terms.map(|(_, c)| Some(Complex64::new(c.re.to_f64()?, c.im.to_f64()?)).filter(|z| z.is_finite()));
    let system = PathSystem::of_terms(SparseSystem::new(unknowns, &supports).ok()?);
    let target = numbers.collect::<Option<_>>()?;
    // Combinations are rounded.
    Some((Expanded::new(polynomials, vec![0; unknowns], is_square, seed, monitor), system, target))
}
