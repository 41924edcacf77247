//! Too many equations, reduced to as many as unknowns; linear equations are kept.
//!
//! Random combinations `f_i + sum c_ij f_j` have few paths if the degrees determine their number.
//! If the supports determine it, unknowns `z_j` that vanish at the solutions take the place of the
//! `f_j` (Sommese & Verschelde 2000, J. Complexity 16:572). With `f_j + z_j` these are the same
//! combinations once `z` is eliminated, but the supports stay small, and so does the mixed volume.

use super::ends::Ends;
use super::equations::ScaledEquations;
use super::error::SolveError;
use super::options::SolveOptions;
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use crate::start::{MixedError, PathSystem, Polyhedral, bezout_number, degrees};
use crate::tolerances::ends;
use num_complex::Complex64;
use poly::SparseSystem;

/// Combinations are less work if they have up to this many paths for each path with further
/// unknowns, because they have one stage and fewer unknowns.
const WORTH: u64 = 2;
/// Steps at most of a path with further unknowns, and how often it is tracked again: those that need
/// more do not with another start system.
const STEPS: usize = 1_000;
const RETRIES: u32 = 2;
/// Start systems more for that.
const RESTARTS: u32 = 4;

/// Further unknowns, the last ones of the equations that are tracked.
pub(super) struct Slack {
    /// The number of unknowns that were given.
    given: usize,
    /// Combinations in the given unknowns alone, with their coefficients: by these the Jacobian at a
    /// solution is judged.
    pub(super) combined: (PathSystem, Vec<Complex64>),
}

/// Makes equations that are more than their unknowns as many, and says how they are tracked; `None` if
/// they are not more. Those of named sums are kept as linear ones are.
pub(super) fn squared(
    equations: &ScaledEquations,
    options: &SolveOptions,
    monitor: &Monitor,
) -> Result<Option<(ScaledEquations, Option<Slack>, SolveOptions)>, SolveError> {
    if equations.len() <= equations.unknowns {
        return Ok(None);
    }
    let mut options = options.clone();
    let sums = equations.named_sums();
    let mut kept: Vec<usize> = equations.linear().into_iter().filter(|i| !sums.contains(i)).collect();
    if kept.len() + sums.len() > equations.unknowns {
        kept.clear();
    }
    kept.extend(sums);
    let combined = equations.squared(options.seed, &kept);
    let wide = widened(equations, &kept, options.seed);
    let volume = match wide.as_ref().map(|wide| Polyhedral::new(&with_origin(wide), options.seed, 0, monitor)) {
        Some(Ok(cells)) => Some(cells.mixed_volume),
        Some(Err(MixedError::Cancelled)) => return Err(MixedError::Cancelled.into()),
        Some(Err(_)) | None => None,
    };
    let bezout = degrees(&combined.supports).and_then(|degrees| bezout_number(&degrees));
    let (Some(wide), Some(volume)) = (wide, volume) else {
        return Ok(Some((combined, None, options)));
    };
    if bezout.is_some_and(|bezout| bezout <= volume.saturating_mul(WORTH)) {
        return Ok(Some((combined, None, options)));
    }
    options.paths.tracker.max_steps = options.paths.tracker.max_steps.min(STEPS);
    options.paths.retries = options.paths.retries.min(RETRIES);
    options.restarts = options.restarts.max(RESTARTS);
    let system = PathSystem::of_terms(SparseSystem::new(combined.unknowns, &combined.supports)?);
    let slack = Slack { given: equations.unknowns, combined: (system, combined.coefficients.concat()) };
    Ok(Some((wide, Some(slack), options)))
}

/// The options of an attempt: every second one has larger circles. On hyperplanes that are kept,
/// coordinates that grow at different rates cancel: of those of paths to infinity too few digits are
/// left on small circles, while ends that lie close together are told apart there only.
pub(super) fn of_attempt(options: &SolveOptions, attempt: u32) -> SolveOptions {
    let mut options = options.clone();
    if attempt % 2 == 1 {
        options.endgame.radius = options.endgame.radius.max(ends::LEAST_CIRCLE);
        options.endgame.start = options.endgame.start.max(10.0 * ends::LEAST_CIRCLE);
    }
    options
}

/// The equations with further unknowns; `None` if too many of them are kept.
fn widened(equations: &ScaledEquations, kept: &[usize], seed: u64) -> Option<ScaledEquations> {
    let further = equations.len() - equations.unknowns;
    let mut curved: Vec<usize> = (0..equations.len()).filter(|i| !kept.contains(i)).collect();
    curved.sort_by_key(|&i| equations.degree(i));
    if curved.len() < further {
        return None;
    }
    let mut random = Random::of(seed, Stream::Combinations);
    let mut wide = equations.widened(further);
    // The first ones have one further unknown each, the others all of them.
    for (place, i) in curved.into_iter().enumerate() {
        for j in (0..further).filter(|&j| place >= further || place == j) {
            let unknown = |k: usize| i32::from(k == equations.unknowns + j);
            wide.supports[i].push((0..wide.unknowns).map(unknown).collect());
            wide.coefficients[i].push(random.unit());
        }
    }
    Some(wide)
}

/// The supports with the origin, as they are tracked.
fn with_origin(equations: &ScaledEquations) -> Vec<Vec<Vec<i32>>> {
    let mut with = equations.clone();
    for i in 0..with.len() {
        with.add_term(i, vec![0; equations.unknowns]);
    }
    with.supports
}

impl Slack {
    /// Leaves the further unknowns out of all ends. Those where they do not vanish solve the combined
    /// equations alone, as the given ones tell.
    pub(super) fn shorten(&self, ends: &mut Ends) {
        ends.regular.values_mut().for_each(|end| end.point.truncate(self.given));
        ends.singular.values_mut().for_each(|end| end.point.truncate(self.given));
    }
}
