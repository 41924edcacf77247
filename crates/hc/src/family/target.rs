//! One target of a family: its solutions from those of a fibre, within the limits of effort.
//!
//! A path that struggles passes close to a branch point. Paths on a detour, from a fibre for other parameters, keep
//! their distance from that point, and take as few steps as usual. In a symmetric family one solution of each orbit is
//! tracked, and the others are its images.

use super::compiled::Family;
use super::error::FamilyError;
use super::fibre::{Fibre, FibreOptions, Limit, TargetLimits};
use super::symmetry::Symmetry;
use super::track::{moved as moved_fibre, track_fibre};
use super::verdict::Verdict;
use crate::distinct::{coincidences, is_real};
use crate::monitor::Monitor;
use crate::moving::MovingTrackers;
use crate::random::{Random, Stream};
use crate::refine::LaneRefiners;
use crate::solve::{Solution, Solutions, SolveOptions, Stray, solve_member};
// One thread needs no trait for `map`.
#[cfg_attr(not(feature = "threads"), allow(unused_imports))]
use crate::threads::{IntoParallelRefIterator, ParallelIterator};
use crate::tolerances::{ends, same};
use crate::tracker::Trackers;
use num_complex::Complex64;
use poly::Interpreter;
use std::time::Duration;

/// How a fibre is tracked again as long as paths are lost: by the detours of these numbers, and then straight, with
/// shorter steps for lost paths.
const AGAIN: [Option<u64>; 3] = [Some(0), Some(1), None];

/// How each target is tracked.
pub(super) struct TargetTracking<'a> {
    pub(super) family: &'a Family,
    pub(super) fibre: &'a Fibre,
    pub(super) options: SolveOptions,
    pub(super) limits: TargetLimits,
    pub(super) only_real: bool,
    pub(super) up_to_symmetry: bool,
    pub(super) monitor: Monitor,
}

/// Trackers of the equations as they are given, what refines their ends, and trackers of those that are split, if that saves
/// operations.
pub(super) struct FamilyTrackers<'a> {
    given: Trackers<'a, Interpreter>,
    refiners: LaneRefiners<'a, Interpreter>,
    moving: Option<MovingTrackers<'a>>,
}

impl<'a> TargetTracking<'a> {
    /// Trackers of paths from the fibre.
    pub(super) fn trackers(&self) -> FamilyTrackers<'a> {
        let (p, solutions) = (&self.fibre.parameters, &self.fibre.solutions);
        FamilyTrackers {
            given: Trackers::from_solutions(&self.family.program, p, solutions),
            refiners: LaneRefiners::new(&self.family.program),
            moving: self.family.split().map(|split| MovingTrackers::new(split, p, solutions)),
        }
    }

    /// The solutions for a target from a fibre. Where paths are lost, detours are tried, and then shorter steps, as far
    /// as the limits allow.
    fn from(&self, trackers: &FamilyTrackers<'_>, fibre: &Fibre, target: &[Complex64], monitor: &Monitor) -> Solutions {
        let (system, given) = (&self.family.program, &self.options.paths);
        let solve = |from: &Fibre, retries: u32, again: usize| {
            let paths = FibreOptions { retries, again: Some(again), ..given.clone() };
            let options = SolveOptions { paths, ..self.options.clone() };
            let systems = [self.family.system(), self.family.square()];
            let misses = |x: &[Complex64]| matches!(self.family.verdict(target, x), Verdict::Misses(_));
            let stray = self.family.overdetermined.as_ref().map(|_| &misses as &Stray<'_>);
            let FamilyTrackers { given, refiners, moving } = trackers;
            let with = (given, refiners, moving.as_ref());
            let mut found = solve_member(systems, with, from, target, stray, &options, monitor);
            self.family.keep_own(target, &mut found);
            self.family.keep_solving(target, &mut found);
            found
        };
        let (count, again) = (fibre.len(), given.again.unwrap_or(usize::MAX));
        let most = ((self.limits.again * count as f64) as usize).min(again);
        let by_detours = given.retries > 0 && most >= 2 * count;
        let mut found = if by_detours { solve(fibre, 0, 0) } else { solve(fibre, given.retries, most) };
        let (mut again, mut bounded) = (found.paths.retracked, given.retries > 0 && !by_detours);
        for detour in AGAIN.iter().filter(|_| by_detours) {
            let needed = if detour.is_some() { 2 * count } else { count };
            let left = most.checked_sub(again + needed);
            bounded |= left.is_none();
            let Some(left) = left.filter(|_| found.paths.failed > 0) else { continue };
            let other = match detour {
                Some(_) if monitor.is_cancelled() => continue,
                Some(number) => {
                    let corner = corner(fibre, target, *number);
                    let paths = FibreOptions { again: Some(left), ..given.clone() };
                    let tracked = track_fibre(system, fibre, &corner, &paths, monitor);
                    again += count + tracked.1.retracked;
                    let Some(moved) = moved_fibre(system, fibre, &corner, &tracked) else { continue };
                    solve(&moved, 0, 0)
                }
                None => solve(fibre, given.retries, left),
            };
            again += other.paths.tracked + other.paths.retracked;
            bounded |= other.limited.is_some();
            // With shorter steps, the ends are surer.
            if other.paths.failed < found.paths.failed + usize::from(detour.is_none()) {
                found = other;
            }
        }
        found.limited = (bounded && found.paths.failed > 0).then_some(Limit::Again);
        found.paths.retracked = again;
        found
    }

    /// The solutions for one target; `None` if the work was cancelled before.
    fn solve(&self, trackers: &FamilyTrackers<'_>, orbits: Option<&Orbits>, target: &[Complex64]) -> Option<Solutions> {
        if self.monitor.is_cancelled() {
            return None;
        }
        let time = self.limits.seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        let limited = time.map(|time| self.monitor.within(time));
        let monitor = limited.as_ref().unwrap_or(&self.monitor);
        let from = |fibre: &Fibre| self.from(trackers, fibre, target, monitor);
        let expanded = orbits.and_then(|orbits| {
            let mut found = from(&orbits.tracked);
            let same = self.options.paths.coincidence;
            found.solutions = orbits.expand(&self.family.symmetry, target, same, &found)?;
            Some(found)
        });
        let mut found = expanded.unwrap_or_else(|| from(self.fibre));
        if found.interrupted {
            found.interrupted = self.monitor.is_cancelled();
            found.limited = (!found.interrupted).then_some(Limit::Time);
        }
        Some(found)
    }

    /// The solutions for some of the targets, with their numbers, up to the first that was not begun.
    pub(super) fn solved(
        &self,
        trackers: &FamilyTrackers<'_>,
        orbits: Option<&Orbits>,
        targets: &[Vec<Complex64>],
        numbers: &[usize],
    ) -> Vec<(usize, Solutions)> {
        let solve = |&k: &usize| Some((k, self.solve(trackers, orbits, &targets[k])?));
        let solved: Vec<Option<(usize, Solutions)>> = numbers.par_iter().map(solve).collect();
        solved.into_iter().map_while(|found| found).collect()
    }

    /// What was asked for of the solutions for a target.
    pub(super) fn finished(&self, found: Solutions, target: &[Complex64]) -> Solutions {
        let mut found = found.of_member(self.family.system(), target);
        if self.options.certify && found.certify().is_err() {
            // The family compiles and is square, which is all that can be wrong; nothing is proved
            // if not.
            for s in found.solutions.iter_mut() {
                s.certified = Some(false);
            }
        }
        if self.only_real {
            found.solutions.retain(|s| s.is_real);
        }
        if self.up_to_symmetry {
            self.list_once(&mut found, target);
        }
        found
    }

    /// Leaves one solution of each orbit: a real one if there is one, certified if all are.
    fn list_once(&self, found: &mut Solutions, target: &[Complex64]) {
        let all = std::mem::take(&mut found.solutions);
        let points: Vec<&[Complex64]> = all.iter().map(|s| s.value.as_slice()).collect();
        let regular = self.options.paths.coincidence;
        let tolerance = |k: usize| if all[k].singular { same::SINGULAR.max(regular) } else { regular };
        for orbit in self.family.symmetry.orbits(target, &points, tolerance) {
            let real = orbit.iter().find(|&&k| all[k].is_real);
            let mut listed = all[*real.unwrap_or(&orbit[0])].clone();
            if orbit.iter().any(|&k| all[k].certified == Some(false)) {
                listed.certified = Some(false);
            }
            found.solutions.push(listed);
            found.represents.push(orbit.len());
        }
    }
}

/// Parameters of a detour: about as far from a fibre and a target as these are from each other; parameters that
/// stay on the straight way stay on the detour.
fn corner(fibre: &Fibre, target: &[Complex64], number: u64) -> Vec<Complex64> {
    let start = &fibre.parameters;
    let normals = Random::of(0, Stream::Detour(number)).normals(start.len());
    let corner = |((a, b), z): ((&Complex64, &Complex64), Complex64)| (a + b) / 2.0 + z * (b - a).norm();
    start.iter().zip(target).zip(normals).map(corner).collect()
}

/// The representatives of a fibre, and how many solutions each stands for.
pub(super) struct Orbits {
    /// The representatives as a fibre of their own.
    tracked: Fibre,
    /// The sizes of the orbits, ascending.
    sizes: Vec<usize>,
}

impl Orbits {
    /// The orbits of a fibre that notes its representatives; `None` if it does not.
    ///
    /// # Errors
    /// If a map of the family takes one of its solutions to a point that is none.
    pub(super) fn of(family: &Family, fibre: &Fibre) -> Result<Option<Orbits>, FamilyError> {
        if fibre.representatives.is_none() {
            return Ok(None);
        }
        family.check_symmetry(fibre)?;
        let tracked = fibre.tracked();
        let size = |x| family.symmetry.orbit(&fibre.parameters, x, same::REGULAR).len();
        let mut sizes: Vec<usize> = tracked.iter().map(size).collect();
        sizes.sort_unstable();
        Ok(Some(Orbits { tracked, sizes }))
    }

    /// All solutions for a target, from those to which the representatives lead. `None` where they
    /// do not tell how many paths end where, so that all have to be tracked: where one is singular
    /// or lost (of the paths that share a singular end some are missing), where two lie in one
    /// orbit, and where an orbit is smaller than for generic parameters.
    fn expand(
        &self,
        symmetry: &Symmetry,
        target: &[Complex64],
        tolerance: f64,
        found: &Solutions,
    ) -> Option<Vec<Solution>> {
        let lost = found.paths.failed > 0 && !found.interrupted;
        if lost || found.iter().any(|s| s.singular || s.multiplicity > 1) {
            return None;
        }
        let orbits: Vec<Vec<Vec<Complex64>>> =
            found.iter().map(|s| symmetry.orbit(target, &s.value, tolerance)).collect();
        let mut sizes: Vec<usize> = orbits.iter().map(Vec::len).collect();
        sizes.sort_unstable();
        // If all orbits have one size, the comparison can do without the paths at infinity.
        let equal = self.sizes.first() == self.sizes.last();
        let generic = if equal { sizes.iter().all(|n| self.sizes.first() == Some(n)) } else { sizes == self.sizes };
        let points = || orbits.iter().flatten().map(Vec::as_slice).enumerate();
        if !generic || !coincidences(points(), tolerance).is_empty() {
            return None;
        }
        let images = |(s, orbit): (&Solution, Vec<Vec<Complex64>>)| {
            let image = |value: Vec<Complex64>| {
                let is_real = is_real(&value, ends::REAL);
                Solution { value, is_real, ..s.clone() }
            };
            orbit.into_iter().map(image).collect::<Vec<_>>()
        };
        Some(found.iter().zip(orbits).flat_map(images).collect())
    }
}
