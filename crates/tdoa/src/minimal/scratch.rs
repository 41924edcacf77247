//! The paper's own route: a family solved from nothing for one matrix, by a polyhedral start system.

use super::SolveError;
use super::formulation::Formulation;
use crate::network::PathCounts;
use hc::distinct::relative_distance;
use hc::monitor::Monitor;
use hc::solve::{SolveOptions, Start, solve};
use num_complex::Complex64;

/// How often paths that fail are tracked again, for each of the start systems that are tried while roots are missing.
const RETRIES: [u32; 4] = [2, 2, 2, 4];

/// Relative distance up to which roots from different start systems are the same.
const SAME: f64 = 1e-8;

/// All roots in the torus for the real parameters `f`, with the paths that led to them, which heed the monitor. In the families of this
/// crate the spurious roots and components lie outside the torus.
pub(crate) fn roots<F: Formulation>(
    f: &[f64],
    monitor: &Monitor,
) -> Result<(Vec<Vec<Complex64>>, PathCounts), SolveError> {
    let refused = |error: &dyn std::fmt::Display| SolveError::Polyhedral(error.to_string());
    let family = hc::poly::parse::family(F::FAMILY).map_err(|e| refused(&e))?;
    let system = family.system.at(f).map_err(|e| refused(&e))?;
    let polynomials = system.expand(&Default::default()).map_err(|e| refused(&e))?;
    let mut roots: Vec<Vec<Complex64>> = Vec::new();
    let mut paths = PathCounts::default();
    for (seed, retries) in (0..).zip(RETRIES) {
        let mut options = SolveOptions::default();
        options.seed = seed;
        options.set_monitor(monitor.clone());
        // Most paths that need more than the first loop of the endgame lead out of the torus: only the last start system spends that.
        if seed as usize + 1 < RETRIES.len() {
            options.endgame.min_radius = options.endgame.radius;
        }
        options.paths.retries = retries;
        // No member has more isolated roots than the generic one: once as many are found the other paths lead out of the torus.
        options.known = family.roots;
        options.start = Start::Polyhedral;
        options.torus_only = true;
        // Paths that lead out of the torus may end badly; the known number of roots tells whether one in it is missing.
        options.restarts = 0;
        let found = solve(&polynomials, &options).map_err(|e| refused(&e))?;
        if found.interrupted {
            return Err(SolveError::Cancelled);
        }
        let regular = found.solutions.iter().filter(|s| !s.singular);
        for root in regular.map(|s| s.value.iter().map(|&[re, im]| Complex64::new(re, im)).collect::<Vec<_>>()) {
            if roots.iter().all(|other| relative_distance(other, &root) > SAME) {
                roots.push(root);
            }
        }
        paths.retracked += found.paths.retracked + if seed > 0 { found.paths.tracked } else { 0 };
        paths = PathCounts { retracked: paths.retracked, ..found.paths };
        if family.roots.is_some_and(|known| roots.len() >= known) {
            paths.finite = roots.len();
            paths.at_infinity = paths.tracked - roots.len();
            (paths.failed, paths.dropped) = (0, 0);
            break;
        }
    }
    Ok((roots, paths))
}
