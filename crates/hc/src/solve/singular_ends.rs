//! Ends that the tracker alone cannot tell: singular ends, and regular ends for coefficients that were
//! rounded.

use super::classify::Tracked;
use super::cluster::{clustered, distributed, is_known, is_same};
use super::ends::{End, Ends};
use super::excess::Excess;
use super::solutions::{Solution, Unresolved};
use crate::distinct::{groups, relative_distance};
use crate::endgame::SingularEnd;
use crate::exact::SmallSystem;
use crate::refine::Refiner;
use crate::singular::{self, Effort, LocalStructure, UnresolvedReason};
use crate::threads::IntoParallelRefIterator;
#[cfg(feature = "threads")]
use crate::threads::ParallelIterator;
use crate::tolerances::{ends, same};
use num_complex::Complex64;

impl Ends {
    /// Judges the singular ends, and the `doubtful` ones among the regular ends.
    pub(super) fn add_singular(
        &mut self,
        tracked: &Tracked<'_>,
        doubtful: Vec<(usize, SingularEnd)>,
        excess: &Excess<'_>,
    ) {
        let ends: Vec<(usize, SingularEnd)> = std::mem::take(&mut self.singular).into_iter().chain(doubtful).collect();
        let points = ends.iter().enumerate().map(|(k, (_, end))| (k, &end.point[..]));
        let groups = groups(points, same::SINGULAR);
        let spare = self.lost();
        let structures = structures_of_ends(tracked, &ends, &groups, &self.solutions, spare);
        self.by_digits = structures.iter().any(|(_, structure)| structure.is_singular_by_digits());
        let are_simple = || {
            let by_count = tracked.census().is_some_and(|census| census.keys().all(|&multiplicity| multiplicity == 1));
            by_count || tracked.expanded.small().is_some_and(SmallSystem::are_simple)
        };
        let simple = self.by_digits && are_simple();
        // Multiple solutions, with the paths that end there, and the number of lost paths that end at others.
        let mut multiple: Vec<(Solution, Vec<usize>)> = Vec::new();
        let mut further = 0;
        let mut refiner = Refiner::new(tracked.system);
        let mut condition = |point: &[Complex64]| refiner.judged(tracked.target, point).condition;
        for (group, structure) in structures {
            let paths: Vec<usize> = group.iter().map(|&k| ends[k].0).collect();
            match structure {
                LocalStructure::Isolated { point, .. } | LocalStructure::Regular { point, .. }
                    if excess.outside(&point) =>
                {
                    self.assign(&paths, End::EXCESS);
                }
                LocalStructure::Isolated { multiplicity, point, residual, .. } => {
                    self.assign(&paths, End::SOLUTION);
                    let winding = group.iter().map(|&k| ends[k].1.winding).max().unwrap_or(1);
                    match multiple.iter_mut().find(|(m, _)| relative_distance(&m.value, &point) <= ends::ONE_POINT) {
                        Some((known, known_paths)) => {
                            known_paths.extend(paths);
                            known.winding_number = known.winding_number.max(winding);
                        }
                        None => {
                            let condition = condition(&point);
                            let solution = Solution::new(point, multiplicity, winding, true, residual, condition);
                            multiple.push((solution, paths));
                        }
                    }
                }
                LocalStructure::Regular { point, residual } => {
                    self.assign(&paths, End::LOST);
                    // One path ends at a regular solution; any other has jumped.
                    if !is_known(&tracked.expanded.given, &self.solutions, &point) {
                        match paths.first() {
                            Some(&path) => self.set(path, End::SOLUTION),
                            None => further += 1,
                        }
                        let condition = condition(&point);
                        self.solutions.push(Solution::new(point, 1, 1, false, residual, condition));
                    }
                }
                LocalStructure::OnComponent { point, .. } if simple => {
                    self.unresolved(&point, &paths, UnresolvedReason::Unclear)
                }
                LocalStructure::OnComponent { point, .. } => {
                    self.assign(&paths, End::COMPONENT);
                    self.component_points.push(point);
                }
                LocalStructure::NotASolution => {
                    self.assign(&paths, if excess.overdetermined() { End::EXCESS } else { End::LOST });
                }
                LocalStructure::Unresolved(why) => {
                    if let Some(&end) = group.first() {
                        self.unresolved(&ends[end].1.point, &paths, why);
                    }
                }
            }
        }
        self.reassign(further, End::LOST, End::SOLUTION);
        let is_conserved = excess.overdetermined() || tracked.expanded.given.len() <= tracked.expanded.given.unknowns();
        self.add_multiple(multiple, simple, is_conserved, excess);
        if self.lost() == 0 {
            self.unresolved.clear();
        }
    }

    /// Adds multiple solutions with the paths that end there; as many `simple` ones in place of each if all
    /// solutions are known to be simple. As many paths as the multiplicity end there if the number of solutions
    /// `is_conserved`; from the solutions of more equations than unknowns alone there may be fewer.
    fn add_multiple(
        &mut self,
        multiple: Vec<(Solution, Vec<usize>)>,
        simple: bool,
        is_conserved: bool,
        excess: &Excess<'_>,
    ) {
        let mut missing = 0;
        for (solution, paths) in multiple {
            // As many paths as the multiplicity, or more where equations were combined. Where they
            // are fewer others are lost, else some have gone astray.
            let here = if excess.overdetermined() { paths.len() } else { solution.multiplicity.min(paths.len()) };
            self.assign(&paths[here..], End::LOST);
            if is_conserved {
                missing += solution.multiplicity.saturating_sub(paths.len());
            }
            if simple {
                // They are one point to all digits of a double.
                let Solution { value, multiplicity, residual, condition, .. } = solution;
                let one = Solution::new(value, 1, 1, false, residual, condition);
                self.solutions.extend(std::iter::repeat_n(one, multiplicity));
            } else {
                self.solutions.push(solution);
            }
        }
        // Lost paths end there, if they are as many at least.
        if missing <= self.lost() {
            self.reassign(missing, End::LOST, End::SOLUTION);
        } else {
            self.missing = missing;
        }
    }

    fn unresolved(&mut self, end: &[Complex64], paths: &[usize], why: UnresolvedReason) {
        self.assign(paths, End::LOST);
        self.unexamined += if why == UnresolvedReason::TooMuch { paths.len() } else { 0 };
        self.unresolved.push(Unresolved { value: end.to_vec(), paths: paths.len(), reason: why.to_string() });
    }

    /// Adds regular solutions with their paths: those of the given equations, if rounded coefficients move
    /// them or doubles have too few digits. Returns the ends that are not clearly regular, to be examined
    /// like singular ones.
    pub(super) fn correct_rounded(
        &mut self,
        solutions: Vec<(usize, Solution)>,
        tracked: &Tracked<'_>,
    ) -> Vec<(usize, SingularEnd)> {
        let mut doubtful = Vec::new();
        for (path, mut solution) in solutions {
            // The condition does not tell of rounded coefficients: it is that of scaled rows.
            let steady = tracked.expanded.exact
                && solution.condition < ends::EXACT_CONDITION
                && solution.residual < ends::EXACT_RESIDUAL;
            if steady || !singular::is_moved(&tracked.expanded.given, &solution.value) {
                if solution.residual >= ends::EXACT_RESIDUAL {
                    solution.residual = singular::residual(&tracked.expanded.given, &solution.value);
                }
                self.solutions.push(solution);
                continue;
            }
            let point = solution.value;
            let LocalStructure::Regular { point: exact, residual } =
                singular::local_structure(&tracked.expanded.given, &point, 1, 1, ends::ROUNDED, Effort::Little)
            else {
                self.set(path, End::SINGULAR);
                doubtful.push((path, SingularEnd { point, winding: 1, error: ends::ROUNDED }));
                continue;
            };
            if is_known(&tracked.expanded.given, &self.solutions, &exact) {
                self.set(path, End::LOST);
            } else {
                self.solutions.push(Solution::new(exact, 1, 1, false, residual, solution.condition));
            }
        }
        doubtful
    }
}

/// Groups that are examined at a time.
const BATCH: usize = 16;
/// One of several may take this share of the work that is left.
const SHARE: usize = 4;
/// At first each of many may take so many times its even share.
const EASY: usize = 4;
/// The least work that a solve may spend on its ends, in products of complex double-doubles: about
/// a processor second. And the work for each path and factor, about as much as tracking.
const WORK: u64 = 200_000_000;
const WORK_OF_FACTORS: u64 = 100;

/// The local structure at all groups of ends, until the work that one solve may take is done, or the solve is
/// cancelled.
///
/// Among many groups, those that take little come first, and the small ones among these: ends on a component may be
/// thousands, and a few that take all the work there is would leave the others unexamined.
fn structures_of_ends(
    tracked: &Tracked<'_>,
    ends: &[(usize, SingularEnd)],
    groups: &[Vec<usize>],
    known: &[Solution],
    spare: usize,
) -> Vec<(Vec<usize>, LocalStructure)> {
    let mut found: Vec<Vec<(Vec<usize>, LocalStructure)>> = vec![Vec::new(); groups.len()];
    let mut open: Vec<usize> = (0..groups.len()).collect();
    open.sort_by_key(|&k| groups[k].len());
    let few = groups.len() <= SHARE;
    let shares = if few { vec![groups.len().max(1)] } else { vec![SHARE.max(groups.len() / EASY), SHARE] };
    for (round, &share) in shares.iter().enumerate() {
        let (mut hard, easily) = (Vec::new(), round + 1 < shares.len());
        for batch in open.chunks(BATCH) {
            let left = tracked.work.saturating_sub(tracked.expanded.given.spent());
            let stop = if tracked.monitor.is_cancelled() {
                Some(UnresolvedReason::Interrupted)
            } else {
                (left == 0).then_some(UnresolvedReason::TooMuch)
            };
            if let Some(why) = stop {
                batch.iter().for_each(|&k| found[k] = vec![(groups[k].clone(), LocalStructure::Unresolved(why))]);
                continue;
            }
            // Each has its own, so that it does not matter which is done first.
            let of = |&k: &usize| {
                let given = tracked.expanded.given.limited(left / share as u64);
                let structures = structures_of_group(tracked, &given, ends, &groups[k], (known, spare), easily);
                tracked.expanded.given.spend(given.spent());
                (k, structures)
            };
            let structures: Vec<(usize, Vec<_>)> = batch.par_iter().map(of).collect();
            for (k, structures) in structures {
                let is_open = |(_, found): &(_, LocalStructure)| matches!(found, LocalStructure::Unresolved(_));
                if easily && structures.iter().any(is_open) {
                    hard.push(k);
                } else {
                    found[k] = structures;
                }
            }
        }
        open = hard;
    }
    found.concat()
}

/// The work that a solve may spend on the ends of this many paths.
pub(super) fn work(given: &singular::ExactEquations, paths: usize) -> u64 {
    WORK.saturating_add(WORK_OF_FACTORS.saturating_mul(paths as u64).saturating_mul(given.factors() as u64))
}

/// The local structure at ends that nearly coincide: of all at once, or of each if they are not a
/// multiple solution. `spare` more paths may end there; other paths end at the `known` solutions. If they are to be told
/// `easily`, what exhausts the work is left as it is.
fn structures_of_group(
    tracked: &Tracked<'_>,
    given: &singular::ExactEquations,
    ends: &[(usize, SingularEnd)],
    group: &[usize],
    (known, spare): (&[Solution], usize),
    easily: bool,
) -> Vec<(Vec<usize>, LocalStructure)> {
    let (paths, most) = (group.len() + spare, ends.len() + spare);
    let structure = |k: usize, effort: Effort| {
        singular::local_structure(given, &ends[k].1.point, paths, most, ends[k].1.error, effort)
    };
    // The most accurate of the ends stands for all.
    let Some(&best) = group.iter().min_by(|&&a, &&b| ends[a].1.error.total_cmp(&ends[b].1.error)) else {
        return Vec::new();
    };
    // Combinations of equations have higher multiplicities.
    let combined = given.len() > given.unknowns();
    let own = structure(best, Effort::Little);
    match own {
        LocalStructure::Isolated { multiplicity, .. } if combined || multiplicity >= group.len() => {
            return vec![(group.to_vec(), own)];
        }
        LocalStructure::OnComponent { .. } => return vec![(group.to_vec(), own)],
        LocalStructure::Regular { ref point, .. } if group.len() == 1 => {
            // Near a set of positive dimension Newton's method leads to a solution off it.
            let on_set = || singular::on_set_nearby(given, &ends[best].1.point, paths, ends[best].1.error);
            let other = if is_known(given, known, point) { on_set() } else { None };
            return vec![(group.to_vec(), other.unwrap_or(own))];
        }
        LocalStructure::NotASolution if group.len() == 1 => return vec![(group.to_vec(), own)],
        LocalStructure::Unresolved(_) if easily && given.is_exhausted() => return vec![(group.to_vec(), own)],
        _ => {}
    }
    let is_apart = |&k: &usize| k == best || relative_distance(&ends[k].1.point, &ends[best].1.point) > ends::ONE_POINT;
    if group.iter().all(is_apart) && !matches!(own, LocalStructure::Isolated { .. }) {
        let each = |&k: &usize| (vec![k], if k == best { own.clone() } else { structure(k, Effort::Little) });
        let each: Vec<(Vec<usize>, LocalStructure)> = group.iter().map(each).collect();
        if are_told_apart(given, &each, combined) {
            return each;
        }
    }
    // Solutions so close to each other that the paths seemed to end between them.
    let (mut all, left) = distributed(group, clustered(tracked, given, &ends[best].1.point, group.len(), most, known));
    if left.is_empty() {
        return all;
    }
    match if matches!(own, LocalStructure::Unresolved(_)) { structure(best, Effort::Much) } else { own } {
        whole @ (LocalStructure::Isolated { .. } | LocalStructure::OnComponent { .. }) => vec![(group.to_vec(), whole)],
        regular @ LocalStructure::Regular { .. } if all.is_empty() => {
            let others = group.iter().filter(|&&k| k != best).copied().collect();
            vec![(vec![best], regular), (others, LocalStructure::Unresolved(UnresolvedReason::NoSolution))]
        }
        LocalStructure::Unresolved(why) => {
            all.push((left, LocalStructure::Unresolved(why)));
            all
        }
        _ => {
            all.push((left, LocalStructure::Unresolved(UnresolvedReason::NoSolution)));
            all
        }
    }
}

/// Whether every end has a structure of its own.
fn are_told_apart(
    given: &singular::ExactEquations,
    each: &[(Vec<usize>, LocalStructure)],
    overdetermined: bool,
) -> bool {
    let mut regular: Vec<&[Complex64]> = Vec::new();
    each.iter().all(|(_, structure)| match structure {
        LocalStructure::Regular { point, .. } => {
            let fresh = regular.iter().all(|known| !is_same(given, known, point));
            regular.push(point);
            fresh
        }
        LocalStructure::Unresolved(_) => false,
        LocalStructure::NotASolution => overdetermined,
        LocalStructure::Isolated { .. } | LocalStructure::OnComponent { .. } => true,
    })
}
