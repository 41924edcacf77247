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
    /// The program ends with status 1: the list is said to be incomplete, or is empty.
    Unknown,
    /// Anything else.
    Wrong,
}

/// Solves a system from this seed.
pub(crate) fn answer(case: &Case, seed: u64) -> Answer {
    let system = hc::poly::parse::phcpack(&case.text).expect("a system");
    let found = solve(&system, &SolveOptions::new().seed(seed)).expect("a system that can be solved");
    if found.paths.failed > 0 || found.is_empty() {
        return Answer::Unknown;
    }
    let is_there = |(point, multiplicity): &(Vec<f64>, usize)| {
        let at = |value: &[Complex64]| value.iter().zip(point).all(|(z, p)| (z - p).norm() < 1e-9);
        found.solutions.iter().any(|s| s.multiplicity == *multiplicity && at(&s.value))
    };
    let right = found.solutions.len() == case.solutions.len()
        && case.solutions.iter().all(is_there)
        && (found.on_components > 0) == case.component;
    if right { Answer::Right } else { Answer::Wrong }
}
