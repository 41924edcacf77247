//! A member of a family, solved by a start system. Its paths know nothing of loops: they lead to the solutions of all
//! orbits.

use super::compiled::Family;
use super::fibre::Fibre;
use super::pair::{Pairs, TRIES};
use super::search::Multiple;
use crate::monitor::{Monitor, Stage};
use crate::random::{Random, Stream};
use crate::run::Run;
use crate::solve::{Solution, SolveOptions};
use crate::start::bezout_number;
use crate::tolerances::families;
use num_complex::Complex64;
use poly::{Evaluate, System};
use serde::{Deserialize, Serialize};

/// So many paths are always worth it; never more than so many.
const FEW: u64 = 64;
const MOST: u64 = 10_000;
/// The largest product of degrees of members whose mixed volume is computed.
const LARGEST: u64 = 10_000_000;
/// Steps of a path, at most, as in loops.
const MAX_STEPS: usize = 2_000;

/// The solutions of a member.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Member {
    /// Number of paths.
    pub(super) paths: usize,
    /// Whether every path is accounted for.
    pub(super) whole: bool,
    /// The regular solutions at which no factor vanishes that must not.
    pub(super) regular: Vec<Vec<Complex64>>,
    /// The others of these.
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
        if bezout_number(&self.square().degrees_as_written()?)? > LARGEST {
            return None;
        }
        let found = self.member_with(&system, parameters, &quick(most).seed(seed), monitor)?;
        if found.whole || found.paths as u64 > FEW {
            return Some(found);
        }
        self.member_with(&system, parameters, &SolveOptions::new().max_paths(most).seed(seed), monitor)
    }

    /// First pairs that the member for random parameters gives, if it takes no more paths than are always worth it.
    pub(super) fn pairs_of_member(&self, pairs: &Pairs, seed: u64) -> Vec<Fibre> {
        let parameters = Random::of(seed, Stream::Member(TRIES)).normals(self.program.parameters());
        let member = self.member(&parameters, FEW, seed, &Monitor::default());
        let accept = |p: &[Complex64], x: &[Complex64]| self.accepts(p, x);
        let solutions = member.iter().flat_map(|member| &member.regular);
        solutions.filter_map(|x| pairs.at(&parameters, x, accept)).collect()
    }

    /// The member solved with these options.
    fn member_with(
        &self,
        system: &System,
        parameters: &[Complex64],
        options: &SolveOptions,
        monitor: &Monitor,
    ) -> Option<Member> {
        let (outer, most) = (monitor.clone(), options.max_paths);
        // Mixed cells are not counted to the end where they are too many.
        let limited = Monitor::asking(move |progress| {
            outer.is_cancelled() || (progress.stage == Stage::MixedCells && progress.counted > most)
        });
        let found = Run::new().watched(&limited).solve(system, options).ok().filter(|found| !found.interrupted)?;
        let accepted = |s: &&Solution| {
            let tolerance = if s.singular { families::VANISHES_SINGULAR } else { families::VANISHES };
            self.is_inside(parameters, &s.value, tolerance)
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

/// Settings with which paths take about as much work as those of loops. Those of degenerate members, most of which
/// go to infinity or to components, could take a hundred times as much.
fn quick(most: u64) -> SolveOptions {
    let mut options = SolveOptions::new().max_paths(most).restarts(0);
    (options.paths.tracker.max_steps, options.paths.retries) = (MAX_STEPS, 1);
    options
}
