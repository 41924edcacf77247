//! Solutions so close together that paths end between them.

use super::classify::Tracked;
use super::solutions::Solution;
use crate::distinct::relative_distance;
use crate::singular::{Found, Verdict, Zoom};
use num_complex::Complex64;
use poly::{Exact, Polynomial};

/// Relative distance below which two refined solutions are one.
pub(super) const SAME: f64 = 1e-12;

/// Ways to look at a cluster at most.
const WAYS: usize = 12;
/// Bezout's number of the equations of a zoom at most, and about what a path takes for a term, in
/// products of complex double-doubles.
const PATHS: u64 = 600;
const WORK: u64 = 20;
/// Solutions this many times further from the centre than the cluster is wide are none of it.
const OUTSIDE: f64 = 64.0;

/// The solutions around the end of `paths` paths that are not among the `known` ones: all, or as
/// many as are found. `most` may end at any one point.
pub(super) fn clustered(
    tracked: &Tracked<'_>,
    end: &[Complex64],
    paths: usize,
    most: usize,
    known: &[Solution],
) -> Vec<Verdict> {
    let Some(solve) = tracked.zoomed else { return Vec::new() };
    let mut best: Vec<Verdict> = Vec::new();
    for zoom in Zoom::all(tracked.given, end).take(WAYS) {
        let degree = |p: &Polynomial<Exact>| p.degree().and_then(|d| u64::try_from(d).ok()).unwrap_or(0);
        let bezout = zoom.polynomials.iter().take(zoom.unknowns()).map(degree).fold(1, u64::saturating_mul);
        if bezout > PATHS {
            continue;
        }
        zoom.spend(bezout * zoom.polynomials.iter().map(|p| p.terms().len() as u64).sum::<u64>() * WORK);
        let Some(solved) = solve(&zoom.polynomials) else { continue };
        let mut found: Vec<Found> = Vec::new();
        let regular = solved.solutions.iter().map(|s| (&s.value, s.multiplicity));
        let components = solved.component_points.iter().map(|point| (point, 1));
        for (point, multiplicity) in regular.chain(components) {
            if point.iter().all(|z| z.norm() <= OUTSIDE) {
                zoom.add(&mut found, point, multiplicity, most);
            }
        }
        let mut found: Vec<Verdict> = found.into_iter().map(|f| f.verdict).collect();
        found.retain(|verdict| match verdict {
            Verdict::Regular { point, .. } => known.iter().all(|s| relative_distance(&s.value, point) > SAME),
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

/// How many paths end at these solutions, at least.
fn multiplicity(found: &[Verdict]) -> usize {
    let paths = |verdict: &Verdict| match verdict {
        Verdict::Isolated { multiplicity, .. } => *multiplicity,
        _ => 1,
    };
    found.iter().map(paths).sum()
}

/// The ends of a group distributed over the solutions that are found around them, and those for
/// which none is left.
pub(super) fn distributed(group: &[usize], found: Vec<Verdict>) -> (Vec<(Vec<usize>, Verdict)>, Vec<usize>) {
    let mut left = group.to_vec();
    let (components, points): (Vec<Verdict>, Vec<Verdict>) =
        found.into_iter().partition(|verdict| matches!(verdict, Verdict::OnComponent { .. }));
    let mut all = Vec::new();
    for verdict in points {
        let paths = multiplicity(std::slice::from_ref(&verdict)).min(left.len());
        // Regular solutions are listed, whether paths are left for them or not.
        if paths > 0 || matches!(verdict, Verdict::Regular { .. }) {
            all.push((left.drain(..paths).collect(), verdict));
        }
    }
    for verdict in components.into_iter().take(1) {
        if !left.is_empty() {
            all.push((std::mem::take(&mut left), verdict));
        }
    }
    (all, left)
}
