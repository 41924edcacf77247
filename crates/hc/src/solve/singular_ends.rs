//! Ends that the tracker alone cannot tell: singular ends, and regular ends for coefficients that were
//! rounded.

use super::classify::{Classified, Tracked};
use super::cluster::{clustered, distributed, is_known, is_same};
use super::ends::Ends;
use super::excess::Excess;
use super::graph::Graph;
use super::record::SingularEnd;
use super::solutions::{Solution, Unresolved, is_real};
use crate::distinct::{groups, relative_distance};
use crate::refine::Refiner;
use crate::singular::{self, Effort, LocalStructure, Why};
use crate::threads::IntoParallelRefIterator;
#[cfg(feature = "threads")]
use crate::threads::ParallelIterator;
use crate::tolerances::ENDS;
use num_complex::Complex64;
use poly::{Exact, Polynomial};
use std::cell::LazyCell;

/// A singular solution and the paths that end there.
struct Multiple {
    point: Vec<Complex64>,
    multiplicity: usize,
    residual: f64,
    paths: usize,
    winding: usize,
}

impl Classified {
    /// Adds what the singular ends are, and the doubtful ones among the regular ends.
    pub(super) fn add_singular(
        &mut self,
        tracked: &Tracked<'_>,
        all: &Ends,
        doubtful: &[SingularEnd],
        excess: &Excess<'_>,
    ) {
        let ends: Vec<&SingularEnd> = all.singular.values().chain(doubtful).collect();
        let points = ends.iter().enumerate().map(|(k, end)| (k, &end.point[..]));
        let groups = groups(points, ENDS.cluster);
        let spare = self.lost;
        let structures = structures_of_ends(tracked, &ends, &groups, &self.solutions, spare);
        let doubted = structures
            .iter()
            .any(|(_, s)| matches!(s, LocalStructure::Isolated { .. } | LocalStructure::OnComponent { .. }));
        let by_graph = || Graph::new(tracked.polynomials).is_some_and(|graph| graph.are_simple());
        let simple = doubted && (singular::all_simple(tracked.polynomials) || by_graph());
        let mut multiple: Vec<Multiple> = Vec::new();
        let mut further = 0;
        let mut refiner = Refiner::new(tracked.system);
        for (group, structure) in structures {
            let paths = group.len();
            match structure {
                LocalStructure::Isolated { point, .. } if excess.outside(&point) => self.excess += paths,
                LocalStructure::Regular { point, .. } if excess.outside(&point) => self.excess += paths,
                LocalStructure::Isolated { multiplicity, point, residual } => {
                    let winding = group.iter().map(|&k| ends[k].winding).max().unwrap_or(1);
                    match multiple.iter_mut().find(|m| relative_distance(&m.point, &point) <= ENDS.one_point) {
                        Some(known) => {
                            known.paths += paths;
                            known.winding = known.winding.max(winding);
                        }
                        None => multiple.push(Multiple { point, multiplicity, residual, paths, winding }),
                    }
                }
                LocalStructure::Regular { point, residual } => {
                    // One path ends at a regular solution; any other has jumped.
                    let known = is_known(tracked.given, &self.solutions, &point);
                    self.lost += paths.saturating_sub(usize::from(!known));
                    if !known {
                        // A path that is counted as lost ends there.
                        further += usize::from(paths == 0);
                        let condition = refiner.judged(tracked.target, &point).condition;
                        self.solutions.push(solution(&point, 1, 1, residual, condition, is_real(&point, ENDS.real)));
                    }
                }
                LocalStructure::OnComponent { point, .. } if simple => self.unresolved(&point, paths, Why::Unclear),
                LocalStructure::OnComponent { point, .. } => {
                    self.on_components += paths;
                    self.component_points.push(point);
                }
                LocalStructure::NotASolution if excess.overdetermined() => self.excess += paths,
                LocalStructure::NotASolution => self.lost += paths,
                LocalStructure::Unresolved(why) => {
                    if let Some(&end) = group.first() {
                        self.unresolved(&ends[end].point, paths, why);
                    }
                }
            }
        }
        self.lost = self.lost.saturating_sub(further);
        let mut missing = 0;
        for found in multiple {
            // As many paths as the multiplicity, or more where equations were combined. Where they
            // are fewer others are lost, else some have gone astray.
            let surplus = if excess.overdetermined() { 0 } else { found.paths.saturating_sub(found.multiplicity) };
            missing += found.multiplicity.saturating_sub(found.paths);
            self.lost += surplus;
            let condition = refiner.judged(tracked.target, &found.point).condition;
            let one = |multiplicity: usize, winding: usize, real: f64| {
                let real = is_real(&found.point, real);
                solution(&found.point, multiplicity, winding, found.residual, condition, real)
            };
            if simple {
                // As many solutions that are one point to all digits of a double.
                self.solutions.extend((0..found.multiplicity).map(|_| one(1, 1, ENDS.real)));
            } else {
                let solution = one(found.multiplicity, found.winding, ENDS.real_singular);
                self.solutions.push(Solution { singular: true, ..solution });
            }
        }
        // Lost paths end there, if they are as many at least.
        self.lost = if missing <= self.lost { self.lost - missing } else { missing };
        if self.lost == 0 {
            self.unresolved.clear();
        }
    }

    /// The same, together with all solutions from other methods, if some of the `paths` are lost or
    /// some ends are singular.
    pub(super) fn checked(
        mut self,
        polynomials: &[Polynomial<Exact>],
        units: &[i64],
        tracked: &Tracked<'_>,
        paths: usize,
    ) -> Classified {
        let graph = LazyCell::new(|| Graph::new(polynomials));
        let singular = self.on_components > 0 || self.solutions.iter().any(|s| s.singular);
        let count = |found: &Classified| found.solutions.iter().map(|s| s.multiplicity).sum::<usize>();
        if self.lost == 0 && !singular {
            // Paths may seem to go to infinity that do not.
            let is_right = |all: usize| all == count(&self);
            let all = || singular::finite_solutions(polynomials).or_else(|| graph.as_ref()?.count());
            if self.infinite == 0 || all().is_none_or(is_right) {
                return self;
            }
        }
        if let Some(graph) = &*graph {
            if let Some(all) = graph.count() {
                // There are no components. Paths that are not accounted for go to infinity, however
                // they seem to end, or solutions are missing.
                let found = count(&self);
                let unknown = self.lost + std::mem::take(&mut self.on_components);
                self.component_points.clear();
                self.lost = if found == all { 0 } else { unknown.max(found.abs_diff(all)) };
            }
            if self.lost > 0
                && let Some(solutions) = graph.solutions(units, tracked)
            {
                return Classified::complete(solutions, paths);
            }
        }
        if self.lost == 0 {
            self.unresolved.clear();
        }
        self
    }

    /// All solutions, independently of the paths; paths that end at none of them go to infinity.
    fn complete(solutions: Vec<Solution>, paths: usize) -> Classified {
        let ends: usize = solutions.iter().map(|s| s.multiplicity).sum();
        Classified { solutions, infinite: paths.saturating_sub(ends), ..Classified::default() }
    }

    fn unresolved(&mut self, end: &[Complex64], paths: usize, why: Why) {
        self.lost += paths;
        self.unresolved.push(Unresolved { value: end.to_vec(), paths, reason: why.to_string() });
    }

    /// Replaces regular solutions by those of the given equations, if rounded coefficients move
    /// them or doubles have too few digits. Returns the solutions that are not clearly regular, to
    /// be examined like singular ends.
    pub(super) fn correct_rounded(&mut self, tracked: &Tracked<'_>) -> Vec<SingularEnd> {
        let mut kept: Vec<Solution> = Vec::with_capacity(self.solutions.len());
        let mut doubtful = Vec::new();
        for mut solution in std::mem::take(&mut self.solutions) {
            // The condition does not tell of rounded coefficients: it is that of scaled rows.
            let steady =
                tracked.exact && solution.condition < ENDS.exact_condition && solution.residual < ENDS.exact_residual;
            if steady || !singular::is_moved(tracked.given, &solution.value) {
                if solution.residual >= ENDS.exact_residual {
                    solution.residual = singular::residual(tracked.given, &solution.value);
                }
                kept.push(solution);
                continue;
            }
            let point = std::mem::take(&mut solution.value);
            let LocalStructure::Regular { point: exact, residual } =
                singular::local_structure(tracked.given, &point, 1, 1, ENDS.rounded, Effort::Little)
            else {
                doubtful.push(SingularEnd { point, winding: 1, error: ENDS.rounded });
                continue;
            };
            solution.residual = residual;
            solution.is_real = is_real(&exact, ENDS.real);
            if is_known(tracked.given, &kept, &exact) {
                self.lost += 1;
            } else {
                kept.push(Solution { value: exact, ..solution });
            }
        }
        self.solutions = kept;
        doubtful
    }
}

/// Groups that are examined at a time.
const BATCH: usize = 16;
/// One of several may take this share of the work that is left.
const SHARE: usize = 4;
/// The least work that a solve may spend on its ends, in products of complex double-doubles: about
/// a processor second. And the work for each path and factor, about as much as tracking.
const WORK: u64 = 200_000_000;
const WORK_OF_FACTORS: u64 = 100;

/// The local structure at all groups of ends, until the work that one solve may take is done, or the solve is
/// cancelled.
fn structures_of_ends(
    tracked: &Tracked<'_>,
    ends: &[&SingularEnd],
    groups: &[Vec<usize>],
    known: &[Solution],
    spare: usize,
) -> Vec<(Vec<usize>, LocalStructure)> {
    let mut found = Vec::new();
    for batch in groups.chunks(BATCH) {
        let left = tracked.work.saturating_sub(tracked.given.spent());
        let stop =
            if tracked.monitor.is_cancelled() { Some(Why::Interrupted) } else { (left == 0).then_some(Why::TooMuch) };
        if let Some(why) = stop {
            found.extend(batch.iter().map(|group| (group.clone(), LocalStructure::Unresolved(why))));
            continue;
        }
        // Each has its own, so that it does not matter which is done first.
        let of = |group: &Vec<usize>| {
            let given = tracked.given.limited(left / groups.len().clamp(1, SHARE) as u64);
            let structures = structures_of_group(tracked, &given, ends, group, known, spare);
            tracked.given.spend(given.spent());
            structures
        };
        let structures: Vec<Vec<_>> = batch.par_iter().map(of).collect();
        found.extend(structures.into_iter().flatten());
    }
    found
}

/// The work that a solve may spend on the ends of this many paths.
pub(super) fn work(given: &singular::Given, paths: usize) -> u64 {
    WORK.saturating_add(WORK_OF_FACTORS.saturating_mul(paths as u64).saturating_mul(given.factors() as u64))
}

/// The local structure at ends that nearly coincide: of all at once, or of each if they are not a
/// multiple solution. `spare` more paths may end there; other paths end at the `known` solutions.
fn structures_of_group(
    tracked: &Tracked<'_>,
    given: &singular::Given,
    ends: &[&SingularEnd],
    group: &[usize],
    known: &[Solution],
    spare: usize,
) -> Vec<(Vec<usize>, LocalStructure)> {
    let (paths, most) = (group.len() + spare, ends.len() + spare);
    let structure =
        |k: usize, effort: Effort| singular::local_structure(given, &ends[k].point, paths, most, ends[k].error, effort);
    // The most accurate of the ends stands for all.
    let Some(&best) = group.iter().min_by(|&&a, &&b| ends[a].error.total_cmp(&ends[b].error)) else {
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
            let beside = || singular::beside(given, &ends[best].point, paths, ends[best].error);
            let other = if is_known(given, known, point) { beside() } else { None };
            return vec![(group.to_vec(), other.unwrap_or(own))];
        }
        LocalStructure::NotASolution if group.len() == 1 => return vec![(group.to_vec(), own)],
        _ => {}
    }
    let is_apart = |&k: &usize| k == best || relative_distance(&ends[k].point, &ends[best].point) > ENDS.one_point;
    if group.iter().all(is_apart) && !matches!(own, LocalStructure::Isolated { .. }) {
        let each = |&k: &usize| (vec![k], if k == best { own.clone() } else { structure(k, Effort::Little) });
        let each: Vec<(Vec<usize>, LocalStructure)> = group.iter().map(each).collect();
        if are_told_apart(given, &each, combined) {
            return each;
        }
    }
    // Solutions so close to each other that the paths seemed to end between them.
    let (mut all, left) = distributed(group, clustered(tracked, given, &ends[best].point, group.len(), most, known));
    if left.is_empty() {
        return all;
    }
    match if matches!(own, LocalStructure::Unresolved(_)) { structure(best, Effort::Much) } else { own } {
        whole @ (LocalStructure::Isolated { .. } | LocalStructure::OnComponent { .. }) => vec![(group.to_vec(), whole)],
        regular @ LocalStructure::Regular { .. } if all.is_empty() => {
            let others = group.iter().filter(|&&k| k != best).copied().collect();
            vec![(vec![best], regular), (others, LocalStructure::Unresolved(Why::NoSolution))]
        }
        LocalStructure::Unresolved(why) => {
            all.push((left, LocalStructure::Unresolved(why)));
            all
        }
        _ => {
            all.push((left, LocalStructure::Unresolved(Why::NoSolution)));
            all
        }
    }
}

/// Whether every end has a structure of its own.
fn are_told_apart(given: &singular::Given, each: &[(Vec<usize>, LocalStructure)], overdetermined: bool) -> bool {
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

fn solution(
    point: &[Complex64],
    multiplicity: usize,
    winding_number: usize,
    residual: f64,
    condition: f64,
    is_real: bool,
) -> Solution {
    Solution {
        value: point.to_vec(),
        multiplicity,
        winding_number,
        singular: false,
        is_real,
        residual,
        condition,
        certified: None,
    }
}
