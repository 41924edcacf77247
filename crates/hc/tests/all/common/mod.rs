//! What the tests of the front door share.

pub(crate) mod conics;
pub(crate) mod generators;

use hc::poly::parse::phcpack;
use hc::{Solutions, SolveError, SolveOptions, solve};
use std::collections::BTreeMap;

pub(crate) fn options(seed: u64) -> SolveOptions {
    SolveOptions::new().seed(seed)
}

pub(crate) fn solve_text(text: &str, options: &SolveOptions) -> Result<Solutions, SolveError> {
    solve(&phcpack(text).expect("a system"), options)
}

/// Solves, and checks that no path is lost and every path accounted for.
pub(crate) fn solved(text: &str, options: &SolveOptions) -> Solutions {
    let found = solve_text(text, options).expect("solved");
    assert_eq!(found.paths.failed, 0, "{text}");
    assert_eq!(found.paths.tracked, found.paths.finite + found.paths.at_infinity, "{text}");
    if found.excess == 0 {
        let ends: usize = found.solutions.iter().map(|s| s.multiplicity).sum();
        assert_eq!(ends + found.on_components, found.paths.finite, "{text}");
    }
    found
}

/// Number of solutions of each multiplicity, such as `16x1 1x11`.
pub(crate) fn multiplicities(found: &Solutions) -> String {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    found.solutions.iter().for_each(|s| *counts.entry(s.multiplicity).or_default() += 1);
    counts.iter().map(|(m, count)| format!("{count}x{m}")).collect::<Vec<_>>().join(" ")
}

pub(crate) fn real(found: &Solutions) -> usize {
    found.solutions.iter().filter(|s| s.is_real).count()
}
