//! Solutions of combinations of a [family's equations](super::overdetermined) that do not solve them all, and
//! solutions for special parameters: they are refused, dropped and counted.

use super::compiled::Family;
use super::error::FamilyError;
use super::fibre::{Fibre, FibreOptions};
use super::reach::natural_size;
use super::track::track_fibre;
use super::verdict::Verdict;
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use crate::solve::{Solutions, Unresolved};
use crate::tracker::PathEnd;
use num_complex::Complex64;
use poly::System;

/// Motions of the parameters that are tried, each smaller than the last by this factor.
const MOTIONS: u64 = 6;
const SMALLER: f64 = 1.0 / 64.0;

impl Family {
    /// As many equations as unknowns, which have all solutions of the family: those that are tracked.
    pub(super) fn square(&self) -> &System {
        self.overdetermined.as_ref().map_or(&self.given.system, |more| &more.square)
    }

    /// What all equations say of a regular solution of those that are tracked.
    pub(super) fn verdict(&self, p: &[Complex64], x: &[Complex64]) -> Verdict {
        self.overdetermined.as_ref().map_or(Verdict::Solves, |more| more.verdict(&self.program, p, x))
    }

    /// What the equations say of the point to which a solution of all of them moves with the parameters.
    fn verdict_beside(&self, p: &[Complex64], x: &[Complex64]) -> Verdict {
        let mut last = Verdict::Unclear(0);
        let mut reach = 1.0;
        for motion in 0..MOTIONS {
            let random = Random::of(motion, Stream::Elsewhere).normals(p.len());
            let moved = |(p, z): (&Complex64, Complex64)| p + z * (natural_size(p.norm()) * reach);
            let beside: Vec<Complex64> = p.iter().zip(random).map(moved).collect();
            reach *= SMALLER;
            let alone = Fibre { is_partial: true, ..Fibre::new(p.to_vec(), x.len(), x.to_vec()) };
            let options = FibreOptions::default();
            let (paths, _) = track_fibre(&self.program, &alone, &beside, &options, &Monitor::default());
            let Some((_, end)) = paths.iter().find(|(path, _)| path.end == PathEnd::Success) else { continue };
            last = self.verdict(&beside, end);
            if !matches!(last, Verdict::Unclear(_)) {
                break;
            }
        }
        last
    }

    /// Checks that the solutions of a fibre are not solutions for special parameters only.
    ///
    /// # Errors
    /// If one does not solve all equations where the parameters move.
    pub(super) fn check_generic(&self, fibre: &Fibre) -> Result<(), FamilyError> {
        if self.overdetermined.is_none() {
            return Ok(());
        }
        for (k, x) in fibre.iter().enumerate() {
            match self.verdict_beside(&fibre.parameters, x) {
                Verdict::Solves => {}
                Verdict::Misses(equation) => return Err(FamilyError::Special { equation: equation + 1 }),
                Verdict::Unclear(_) => return Err(FamilyError::FirstSingular { solution: k + 1 }),
            }
        }
        Ok(())
    }

    /// Checks that the solutions of a fibre solve all equations, as far as their digits tell.
    ///
    /// # Errors
    /// The first that does not.
    pub(crate) fn check_solutions(&self, fibre: &Fibre) -> Result<(), FamilyError> {
        if self.overdetermined.is_none() {
            return Ok(());
        }
        let mut refiner = Refiner::new(&self.program);
        for (k, x) in fibre.iter().enumerate() {
            let refined = refiner.refine(&fibre.parameters, x);
            if let Verdict::Misses(equation) = self.verdict(&fibre.parameters, &refined.point) {
                return Err(FamilyError::Misses { solution: k + 1, equation: equation + 1 });
            }
        }
        Ok(())
    }

    /// Drops regular ends that do not solve all equations, and moves those that cannot be judged to the unresolved
    /// ones. Paths to either count as failed: what began at a solution of all equations ends at one. Singular ends have
    /// been judged already.
    pub(super) fn keep_solving(&self, p: &[Complex64], found: &mut Solutions) {
        if self.overdetermined.is_none() {
            return;
        }
        let (mut excess, mut unclear) = (0, Vec::new());
        found.solutions.retain(|solution| {
            let verdict = if solution.singular { Verdict::Solves } else { self.verdict(p, &solution.value) };
            match verdict {
                Verdict::Solves => {}
                Verdict::Misses(_) => excess += 1,
                Verdict::Unclear(equation) => {
                    let reason = format!("whether it solves equation {} does not show in its digits", equation + 1);
                    unclear.push(Unresolved { value: solution.value.clone(), paths: 1, reason });
                }
            }
            verdict == Verdict::Solves
        });
        let paths = (excess + unclear.len()).min(found.paths.finite);
        found.paths.finite -= paths;
        found.paths.failed += paths;
        found.excess += excess;
        found.unresolved.extend(unclear);
    }
}

#[cfg(test)]
mod tests {
    use crate::family::verdict::Verdict;
    use crate::family::{Family, FamilyError, Fibre};
    use crate::random::Random;
    use crate::{MonodromyOptions, SolveOptions, solve};
    use num_complex::Complex64;

    /// Three conics that have the points `(r, b / r)` with `r^2 = a` in common.
    fn redundant() -> Family {
        Family::from_formulas(&["x", "y"], &["a", "b"], &["x^2 - a", "x*y - b", "a*y^2 - b^2"]).unwrap()
    }

    fn number(re: f64) -> Complex64 {
        Complex64::new(re, 0.0)
    }

    /// Combinations have as many solutions as two conics, four; two solve all equations.
    #[test]
    fn solutions_of_combinations_alone_are_told_apart() {
        let family = redundant();
        let p = Random::new(1, 5).normals(2);
        let found = solve(&family.square().at(&p).unwrap(), &SolveOptions::new()).unwrap();
        let verdicts: Vec<Verdict> = found.iter().map(|s| family.verdict(&p, &s.value)).collect();
        assert_eq!(verdicts.len(), 4, "{verdicts:?}");
        assert_eq!(verdicts.iter().filter(|&&v| v == Verdict::Solves).count(), 2, "{verdicts:?}");
        assert_eq!(verdicts.iter().filter(|v| matches!(v, Verdict::Misses(_))).count(), 2, "{verdicts:?}");
        // Neither begins a search, nor is tracked.
        let k = verdicts.iter().position(|v| *v != Verdict::Solves).unwrap();
        let excess = Fibre::new(p, 2, found.solutions[k].value.clone());
        let error = family.complete(&excess, &MonodromyOptions::new()).unwrap_err();
        assert!(matches!(error, FamilyError::Misses { solution: 1, .. }), "{error}");
        let error = family.track(&excess, &[[1.0, 2.0]]).run().unwrap_err();
        assert!(matches!(error, FamilyError::Misses { solution: 1, .. }), "{error}");
    }

    /// A start that solves all equations for special parameters alone, here `a = b`, leads to solutions for such only.
    #[test]
    fn paths_that_leave_the_equations_have_failed() {
        let family = Family::from_formulas(&["x"], &["a", "b"], &["x - a", "x - b"]).unwrap();
        let special = Fibre::new(vec![number(2.0); 2], 1, vec![number(2.0)]);
        let found = family.track(&special, &[[1.0, 3.0], [5.0, 5.0]]).run().unwrap();
        assert_eq!((found[0].len(), found[0].paths.failed, found[0].excess), (0, 1, 1));
        assert_eq!((found[1].len(), found[1].paths.failed, found[1].excess), (1, 0, 0));
        assert!((found[1].solutions[0].value[0] - 5.0).norm() < 1e-12);
        for error in [
            family.complete(&special, &MonodromyOptions::new()).unwrap_err(),
            family.monodromy(&MonodromyOptions::new()).unwrap_err(),
        ] {
            assert!(matches!(error, FamilyError::Special { .. }), "{error}");
            assert!(error.to_string().contains("write these in independent ones"), "{error}");
        }
    }

    #[test]
    fn equations_that_contradict_each_other_have_no_pair() {
        let family = Family::from_formulas(&["x"], &["a"], &["x - a", "x - a - 1", "x^2 - a"]).unwrap();
        assert_eq!(family.find_pair(0), Err(FamilyError::NoPair));
    }

    #[test]
    fn fewer_equations_than_unknowns_are_refused() {
        let error = Family::from_formulas(&["x", "y"], &["a"], &["x*y - a"]).unwrap_err();
        assert_eq!(error, FamilyError::Underdetermined { equations: 1, unknowns: 2 });
    }

    /// The origin and `(a, b)`, which meet where both parameters vanish. The square of the ideal of the origin has the
    /// multiplicity three there, more than the paths: there is no third.
    #[test]
    fn no_path_is_missing_where_the_multiplicity_is_larger_than_their_number() {
        let equations = ["x*(x - a)", "x*(y - b)", "y*(x - a)", "y*(y - b)"];
        let family = Family::from_formulas(&["x", "y"], &["a", "b"], &equations).unwrap();
        let found = family.monodromy(&MonodromyOptions::new()).unwrap();
        assert_eq!((found.fibre.len(), &found.orbits[..]), (2, &[1, 1][..]), "{}", found.stopped);
        let at = &family.track(&found.fibre, &[[0.0, 0.0]]).run().unwrap()[0];
        assert_eq!((at.len(), at.solutions[0].multiplicity, at.paths.failed), (1, 3, 0), "{at}");
    }

    /// All equations are multiples of the first, which is `(x + 1)^2` for these parameters.
    #[test]
    fn a_double_solution_counts_two_paths() {
        let family =
            Family::from_formulas(&["x"], &["a", "b"], &["x^2 + a*x + b", "x^3 + a*x^2 + b*x", "(x^2 + a*x + b)^2"]);
        let family = family.unwrap();
        let found = family.monodromy(&MonodromyOptions::new()).unwrap();
        assert_eq!(found.fibre.len(), 2, "{}", found.stopped);
        let at = &family.track(&found.fibre, &[[2.0, 1.0]]).run().unwrap()[0];
        assert_eq!((at.len(), at.solutions[0].multiplicity, at.paths.failed), (1, 2, 0), "{at}");
        assert!((at.solutions[0].value[0] + 1.0).norm() < 1e-7);
    }
}
