//! What paths have found beside the numbers of all solutions, where these are counted exactly.

use super::classify::Tracked;
use super::ends::{End, Ends};
use super::solutions::{Solution, Unresolved};
use crate::exact::SmallSystem;
use crate::singular::{Census, ExactEquations, UnresolvedReason};

/// The least number of products modulo a prime by which all solutions are counted, and what is added for each path and
/// factor.
const CENSUS: u64 = 4_000_000;
const CENSUS_OF_FACTORS: u64 = 30;

/// Products modulo a prime that a solve may spend on the number of all solutions.
pub(super) fn census_work(given: &ExactEquations, paths: usize) -> u64 {
    let factors = given.factors() as u64;
    CENSUS.saturating_add(CENSUS_OF_FACTORS.saturating_mul(paths as u64).saturating_mul(factors))
}

impl Ends {
    /// Adds what other methods tell, if some paths are lost or some ends are singular.
    pub(super) fn checked(mut self, tracked: &Tracked<'_>) -> Ends {
        let found: usize = self.solutions.iter().map(|s| s.multiplicity).sum();
        let singular = !self.component_points.is_empty() || self.solutions.iter().any(|s| s.singular);
        // Paths may seem to go to infinity that do not.
        if self.lost() == 0 && !singular && self.infinite() == 0 {
            return self;
        }
        // Paths were followed far out; coefficients may be so different that solutions are farther.
        let counts =
            self.lost() > 0 || self.by_digits || self.infinite() > 0 && tracked.expanded.may_have_far_solutions();
        if counts && let Some(census) = tracked.census() {
            self.compare(census, tracked.expanded.elsewhere());
        } else if let Some(all) = tracked.expanded.small().and_then(SmallSystem::count) {
            if self.lost() == 0 && !singular && all == found {
                return self;
            }
            // There are no components. Paths that are not accounted for go to infinity, however they seem to
            // end, or solutions are missing.
            self.component_points.clear();
            self.reassign(self.paths, End::COMPONENT, End::LOST);
            self.missing = all.abs_diff(found);
            if self.missing == 0 {
                self.reassign(self.paths, End::LOST, End::SOLUTION);
            }
        }
        if self.lost() > 0
            && let Some(solutions) = tracked.solutions()
        {
            return self.with_all(solutions);
        }
        if self.lost() == 0 {
            self.unresolved.clear();
        }
        self
    }

    /// How many solutions of each multiplicity were found.
    fn census(&self) -> Census {
        let mut found = Census::new();
        self.solutions.iter().for_each(|s| *found.entry(s.multiplicity).or_default() += 1);
        found
    }

    /// Whether the solutions that were found are all there are. Paths that are not accounted for then have this end,
    /// however they seem to end.
    pub(super) fn accept(&mut self, census: &Census, elsewhere: End) -> bool {
        let is_whole = self.census() == *census;
        if is_whole {
            self.missing = 0;
            let here = self.count(|end| end == End::SOLUTION);
            let all: usize = self.solutions.iter().map(|s| s.multiplicity).sum();
            self.reassign(all.saturating_sub(here), End::LOST, End::SOLUTION);
            self.reassign(self.paths, End::LOST, elsewhere);
            self.unresolved.clear();
        }
        is_whole
    }

    /// Compares what paths have found with the numbers of all solutions, which are finitely many.
    fn compare(&mut self, census: &Census, elsewhere: End) {
        self.component_points.clear();
        self.reassign(self.paths, End::COMPONENT, End::LOST);
        if self.accept(census, elsewhere) {
            return;
        }
        let found = self.census();
        // Multiple solutions of which there are not as many are not what they seem.
        let is_right = |s: &Solution| s.multiplicity == 1 || found.get(&s.multiplicity) == census.get(&s.multiplicity);
        let (right, wrong): (Vec<_>, Vec<_>) = std::mem::take(&mut self.solutions).into_iter().partition(is_right);
        for Solution { value, multiplicity: paths, .. } in wrong {
            self.unresolved.push(Unresolved { value, paths, reason: UnresolvedReason::Count.to_string() });
        }
        let all: usize = census.iter().map(|(multiplicity, points)| multiplicity * points).sum();
        self.missing = all.abs_diff(right.iter().map(|s| s.multiplicity).sum()).max(1);
        self.solutions = right;
    }
}
