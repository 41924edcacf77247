//! Whether a result is what is known by construction.

use super::families::Case;
use hc::poly::Complex64;
use hc::{SolveOptions, solve};

/// What a result is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// All isolated solutions with their multiplicities, no others, and a component if there is
    /// one.
    Right,
    /// The program ends with status 1: the list is said to be incomplete, or is empty though there
    /// are solutions.
    Unknown,
    /// Anything else.
    Wrong,
}

/// Solves a system from this seed.
pub(crate) fn answer(case: &Case, seed: u64) -> Answer {
    let system = hc::poly::parse::phcpack(&case.text).expect("a system");
    let found = solve(&system, &SolveOptions::new().seed(seed)).expect("a system that can be solved");
    let expected = case.solutions.len() + case.others.len();
    if found.paths.failed > 0 || (found.is_empty() && expected > 0) {
        return Answer::Unknown;
    }
    let mut listed: Vec<_> = found.solutions.iter().collect();
    let mut complete = listed.len() == expected && (found.on_components > 0) == case.component;
    for (k, (point, multiplicity)) in case.solutions.iter().enumerate() {
        let tolerance = tolerance(case, k);
        let nearest = (0..listed.len())
            .min_by(|&a, &b| distance(&listed[a].value, point).total_cmp(&distance(&listed[b].value, point)));
        // Each is listed once: it is not there for the next.
        let nearest = nearest.map(|at| listed.swap_remove(at));
        complete &= nearest.is_some_and(|s| s.multiplicity == *multiplicity && distance(&s.value, point) <= tolerance);
    }
    let mut others: Vec<usize> = listed.iter().map(|s| s.multiplicity).collect();
    others.sort_unstable();
    complete &= others == case.others && listed.iter().all(|s| s.residual < 1e-12);
    complete &= case.real.is_none_or(|real| found.n_real() == real);
    if complete { Answer::Right } else { Answer::Wrong }
}

/// How near to a point its double must be: 1e-9 of its size, and 1e-3 of the distance to the next
/// one unless doubles do not tell that.
fn tolerance(case: &Case, k: usize) -> f64 {
    let point = &case.solutions[k].0;
    let size = point.iter().fold(1.0, |size: f64, c| size.max(c.norm()));
    let others = case.solutions.iter().enumerate().filter(|(other, _)| *other != k);
    let next = others.map(|(_, (other, _))| distance(other, point)).fold(f64::INFINITY, f64::min);
    (1e-9 * size).min((1e-3 * next).max(4.0 * f64::EPSILON * size))
}

fn distance(a: &[Complex64], b: &[Complex64]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest: f64, (a, b)| largest.max((a - b).norm()))
}
