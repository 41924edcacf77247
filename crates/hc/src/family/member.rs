//! A member of a family, solved by a start system. Its paths know nothing of loops: they lead to the solutions of all
//! orbits.

use super::compiled::Family;
use super::search::Multiple;
use crate::monitor::{Monitor, Stage};
use crate::run::Run;
use crate::solve::{Solution, SolveOptions};
use crate::start::bezout_number;
use crate::tolerances::families;
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

/// So many paths are always worth it; never more than so many.
const FEW: u64 = 64;
const MOST: u64 = 10_000;
/// The largest product of degrees of members whose mixed volume is computed.
const LARGEST: u64 = 10_000_000;

/// The solutions of a member.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Member {
    /// Number of paths.
    pub(super) paths: usize,
    /// Whether every path is accounted for.
    pub(super) whole: bool,
    /// The regular solutions that the family accepts.
    pub(super) regular: Vec<Vec<Complex64>>,
    /// The others that it accepts.
    pub(super) multiple: Vec<Multiple>,
}

/// How many paths a start system may have beside loops of so many.
pub(super) fn most_paths(of_loops: usize) -> u64 {
    (of_loops as u64).clamp(FEW, MOST)
}

impl Family {
    /// The member with these parameters, unless that takes more than so many paths, or has no start system.
    pub(super) fn member(&self, parameters: &[Complex64], most: u64, seed: u64, monitor: &Monitor) -> Option<Member> {
        let system = self.system().at(parameters).ok()?;
        let degrees = system.degrees_as_written()?;
        let bezout = bezout_number(&degrees)?;
        if bezout > LARGEST {
            return None;
        }
        let outer = monitor.clone();
        let limited = Monitor::asking(move |progress| {
            outer.is_cancelled() || (progress.stage == Stage::MixedCells && progress.counted > most)
        });
        let options = SolveOptions::new().seed(seed).max_paths(most);
        let found = Run::new().watched(&limited).solve(&system, &options).ok().filter(|found| !found.interrupted)?;
        let accepted = |s: &&Solution| {
            let tolerance = if s.singular { families::VANISHES_SINGULAR } else { families::VANISHES };
            self.accepts_within(parameters, &s.value, tolerance)
        };
        let (singular, regular): (Vec<&Solution>, Vec<&Solution>) =
            found.iter().filter(accepted).partition(|s| s.singular);
        // What is singular, but no more than one solution, has not been judged well.
        let clear = singular.iter().all(|s| s.multiplicity > 1);
        let multiple =
            singular.iter().map(|s| Multiple { value: s.value.clone(), multiplicity: s.multiplicity }).collect();
        Some(Member {
            paths: found.paths.tracked,
            whole: clear && found.paths.failed == 0 && found.unresolved.is_empty() && found.limited.is_none(),
            regular: regular.iter().map(|s| s.value.clone()).collect(),
            multiple,
        })
    }
}
