//! The paper's own route: a family solved from scratch, by a polyhedral start system.
//!
//! First the member at the data is solved directly, as in the paper. Far more paths leave the torus
//! than end in it, and roots with large coordinates look like such paths for a long time. If this
//! leaves roots missing, a member at random complex parameters, whose roots are of ordinary size,
//! is solved by a polyhedral start system too, and its roots are tracked to the data.

use super::error::MinimalError;
use super::formulation::Formulation;
use super::solution::PathCounts;
use hc::random::Random;
use hc::{Fibre, Monitor, Run, SolveOptions, Start};
use num_complex::Complex64;

/// So many random members are tried until all roots of one are found.
const MEMBERS: u64 = 4;

/// The roots of one member, and the paths that led to them.
pub(crate) struct Roots {
    /// The parameters, and the roots in the torus. In the families of this crate the spurious roots
    /// and components lie outside it.
    pub(crate) fibre: Fibre,
    pub(crate) paths: PathCounts,
    /// Whether there are as many as a generic member has.
    pub(crate) whole: bool,
}

/// The roots at the data, from a polyhedral start system, which heeds the monitor.
pub(crate) fn at_data<F: Formulation>(target: &[Complex64], monitor: &Monitor) -> Result<Roots, MinimalError> {
    roots::<F>(target, seed(target), 0, monitor)
}

/// All roots of a random member, another one for other data, with the number of paths it took; none
/// if some stay missing in every member that is tried.
pub(crate) fn at_random<F: Formulation>(
    target: &[Complex64],
    monitor: &Monitor,
) -> Result<(Option<Fibre>, usize), MinimalError> {
    let mut tracked = 0;
    for member in 0..MEMBERS {
        let seed = seed(target).wrapping_add(member);
        let parameters = Random::new(seed, 0).normals(target.len());
        let found = roots::<F>(&parameters, seed, 2, monitor)?;
        tracked += found.paths.tracked + found.paths.retracked;
        if found.whole {
            return Ok((Some(found.fibre), tracked));
        }
    }
    Ok((None, tracked))
}

/// A seed that is another one for other data.
fn seed(target: &[Complex64]) -> u64 {
    target.iter().fold(0, |seed: u64, f| seed.rotate_left(7) ^ f.re.to_bits())
}

fn roots<F: Formulation>(
    parameters: &[Complex64],
    seed: u64,
    retries: u32,
    monitor: &Monitor,
) -> Result<Roots, MinimalError> {
    let refused = |error: &dyn std::fmt::Display| MinimalError::Polyhedral(error.to_string());
    let family = hc::poly::parse::family(F::FAMILY).map_err(|e| refused(&e))?;
    let system = family.system.at(parameters).map_err(|e| refused(&e))?;
    let mut options = SolveOptions::default();
    options.seed = seed;
    options.start = Start::Polyhedral;
    options.torus_only = true;
    // No member has more isolated roots than the generic one: once as many are found the other
    // paths lead out of the torus.
    options.known = family.roots;
    // Paths that need many steps or more than one small loop of the endgame nearly all lead out of
    // the torus.
    options.endgame.min_radius = options.endgame.radius;
    options.endgame.turns = 2;
    options.paths.tracker.max_steps = 1_000;
    options.paths.retries = retries;
    options.restarts = 0;
    let found = Run::new().watched(monitor).solve(&system, &options).map_err(|e| refused(&e))?;
    if found.interrupted {
        return Err(MinimalError::Cancelled);
    }
    let solutions = found.nonsingular().flat_map(|s| s.value.iter().copied()).collect();
    let fibre = Fibre::new(parameters.to_vec(), F::WEIGHTS.len(), solutions);
    let missing = family.roots.map_or(0, |known| known.saturating_sub(fibre.len()));
    let mut paths = PathCounts { finite: fibre.len(), dropped: 0, ..found.paths };
    // Special data may have fewer paths than a generic member has roots.
    let others = paths.tracked.saturating_sub(paths.finite);
    paths.failed = if missing > 0 { found.paths.failed.max(missing).min(others) } else { 0 };
    paths.at_infinity = others - paths.failed;
    let whole = missing == 0;
    Ok(Roots { fibre, paths, whole })
}
