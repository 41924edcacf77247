//! Separates nearby solutions by a nested solve.

use super::classify::Tracked;
use super::solutions::Solution;
use crate::distinct::relative_distance;
use crate::singular::{self, ClusterEquations, Effort, ExactEquations, LocalStructure};
use crate::tolerances::clusters;
use num_complex::Complex64;
use poly::{Exact, Polynomial};

/// Largest number of ways to look at a cluster.
const WAYS: usize = 12;
/// Largest Bezout number of the equations of a cluster; and about what a path costs per term, in
/// products of complex double-doubles.
const PATHS: u64 = 600;
const WORK: u64 = 20;

/// The solutions around the end of `paths` paths that are not among the `known` ones: all, or as
/// many as are found. At most `most` paths may end at any one point.
pub(super) fn clustered(
    tracked: &Tracked<'_>,
    given: &ExactEquations,
    end: &[Complex64],
    paths: usize,
    most: usize,
    known: &[Solution],
) -> Vec<LocalStructure> {
    let Some(solve) = tracked.solve_cluster else { return Vec::new() };
    let mut best: Vec<LocalStructure> = Vec::new();
    for cluster in ClusterEquations::all(given, end).take(WAYS) {
        let degree = |p: &Polynomial<Exact>| p.degree().and_then(|d| u64::try_from(d).ok()).unwrap_or(0);
        let bezout = cluster.polynomials.iter().take(cluster.unknowns()).map(degree).fold(1, u64::saturating_mul);
        if bezout > PATHS {
            continue;
        }
        given.spend(bezout * cluster.polynomials.iter().map(|p| p.terms().len() as u64).sum::<u64>() * WORK);
        let Some(solved) = solve(&cluster.polynomials, given) else { continue };
        let regular = solved.solutions.iter().map(|s| (&s.value, s.multiplicity));
        let all = regular.chain(solved.component_points.iter().map(|point| (point, 1)));
        let inside = all.filter(|(point, _)| point.iter().all(|z| z.norm() <= clusters::OUTSIDE));
        let mut found = cluster.structures(inside, most);
        found.retain(|structure| match structure {
            LocalStructure::Regular { point, .. } => !is_known(given, known, point),
            _ => true,
        });
        if multiplicity(&found) > multiplicity(&best) {
            best = found;
        }
        if multiplicity(&best) >= paths {
            break;
        }
    }
    best
}

/// Whether a regular solution, rounded from many digits, is among the known ones.
pub(super) fn is_known(given: &ExactEquations, known: &[Solution], point: &[Complex64]) -> bool {
    known.iter().filter(|s| !s.singular).any(|s| is_same(given, &s.value, point))
}

/// Whether two regular solutions are the same, the second rounded from many digits.
pub(super) fn is_same(given: &ExactEquations, known: &[Complex64], point: &[Complex64]) -> bool {
    let distance = relative_distance(known, point);
    if distance <= clusters::SAME_PRECISE || distance > clusters::SAME_REGULAR {
        return distance <= clusters::SAME_PRECISE;
    }
    match singular::local_structure(given, known, 1, 1, clusters::SAME_REGULAR, Effort::Little) {
        LocalStructure::Regular { point: refined, .. } => relative_distance(&refined, point) <= clusters::SAME_PRECISE,
        _ => true,
    }
}

/// The least number of paths that end at these solutions.
fn multiplicity(found: &[LocalStructure]) -> usize {
    let paths = |structure: &LocalStructure| match structure {
        LocalStructure::Isolated { multiplicity, .. } => *multiplicity,
        _ => 1,
    };
    found.iter().map(paths).sum()
}

/// The ends of a group, distributed over the solutions that were found around them, and the ends
/// for which no solution is left.
pub(super) fn distributed(
    group: &[usize],
    found: Vec<LocalStructure>,
) -> (Vec<(Vec<usize>, LocalStructure)>, Vec<usize>) {
    let mut left = group.to_vec();
    let (components, points): (Vec<LocalStructure>, Vec<LocalStructure>) =
        found.into_iter().partition(|structure| matches!(structure, LocalStructure::OnComponent { .. }));
    let mut all = Vec::new();
    for structure in points {
        let paths = multiplicity(std::slice::from_ref(&structure)).min(left.len());
        // Regular solutions are listed, whether paths are left for them or not.
        if paths > 0 || matches!(structure, LocalStructure::Regular { .. }) {
            all.push((left.drain(..paths).collect(), structure));
        }
    }
    for structure in components.into_iter().take(1) {
        if !left.is_empty() {
            all.push((std::mem::take(&mut left), structure));
        }
    }
    (all, left)
}
