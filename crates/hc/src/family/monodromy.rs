//! Filling a fibre: all solutions of a family for one generic parameter point, from a single
//! solution.
//!
//! Parameters go round random triangles, and solutions return as other solutions of the same
//! irreducible component (Duff, Hill, Jensen, Lee, Leykin, Sommars 2018, arXiv:1609.08722). Whether
//! a fibre is whole is never guessed: a known count or the [trace test](crate::Family::trace_test)
//! shows it, and the result says which.

use super::fibre::Fibre;
use super::reach::Reach;
use super::search::{Monodromy, MonodromyOptions, Stopped};
use super::sides::Searched;
use super::symmetry::Symmetry;
use crate::checkpoint::{Piece, Pieces};
use crate::distinct::{coincidences, relative_distance};
use crate::monitor::{Monitor, Stage};
use crate::random::{Random, Stream};
use crate::refine::Refiner;
use crate::tolerances::families;
use crate::tracker::PathEnd;
use num_complex::Complex64;
use poly::Evaluate;

/// All solutions of a program without symmetries that loops join to those of `start`.
pub(crate) fn monodromy<E: Evaluate>(
    system: &E,
    start: &Fibre,
    options: &MonodromyOptions,
    monitor: &Monitor,
) -> Monodromy {
    let (searched, symmetry) = (&Searched { system, enlarged: false }, &Symmetry::default());
    LoopSearch { searched, accept: &|_, _| true, symmetry, options }.fill(start, Pieces::alone(monitor))
}

/// A search for solutions by loops in parameter space; of a symmetric family one solution of each orbit goes
/// round.
pub(super) struct LoopSearch<'a, E> {
    pub(super) searched: &'a Searched<'a, E>,
    /// Asked about every new solution; solutions that it refuses (degenerate ones) are dropped.
    pub(super) accept: &'a dyn Fn(&[Complex64], &[Complex64]) -> bool,
    pub(super) symmetry: &'a Symmetry,
    pub(super) options: &'a MonodromyOptions,
}

impl<E: Evaluate> LoopSearch<'_, E> {
    /// The fibre with the solutions to which those of other fibres lead; `None` if it has them all.
    pub(super) fn joined(&self, fibre: &Fibre, others: &[Fibre], monitor: &Monitor) -> Option<Fibre> {
        let pieces = Pieces::alone(monitor);
        let mut filling = Filling { search: self, pieces, fibre: fibre.clone() };
        for other in others {
            let (ends, _) = self.searched.track(other, &fibre.parameters, &self.options.fibre, pieces);
            let regular = ends.iter().filter(|(r, _)| r.end == PathEnd::Success);
            filling.add_accepted(regular.map(|(_, x)| x));
        }
        (filling.fibre.len() > fibre.len()).then_some(filling.fibre)
    }

    /// Completes `start` (one or several solutions for generic parameters). Each loop is a piece.
    pub(super) fn fill(&self, start: &Fibre, pieces: Pieces<'_>) -> Monodromy {
        let LoopSearch { searched, symmetry, options, .. } = self;
        let mut filling = Filling { search: self, pieces, fibre: start.clone() };
        if !symmetry.is_trivial() {
            filling.fibre.solutions.clear();
            filling.fibre.representatives = Some(Vec::new());
            filling.add(start.solutions.chunks_exact(start.dimension.max(1)));
        }
        // Loops have each of these sizes in turn.
        let Reach { natural, wide, .. } = Reach::new(searched.system, start);
        let mut sizes = vec![wide.parameters, natural.parameters];
        sizes.dedup();
        let (mut loops, mut idle, mut paths) = (0, 0, 0);
        let stopped = loop {
            if pieces.are_stopped() {
                break Stopped::Cancelled;
            }
            let known = filling.fibre.len();
            if options.roots.is_some_and(|roots| known >= roots) {
                break Stopped::RootsReached;
            }
            let turns = idle / sizes.len();
            if turns >= options.patience && turns * known >= CHANCES {
                break Stopped::NoProgress;
            }
            if known > options.max_solutions {
                break Stopped::TooMany;
            }
            let mut random = Random::of(options.seed, Stream::Loop(loops as u64));
            let scale = scale(turns, options.patience);
            let sizes = &sizes[loops % sizes.len()];
            let corner = |z: Complex64, size: f64| z * size * scale;
            let corners = [0, 1]
                .map(|_| random.normals(sizes.len()).into_iter().zip(sizes).map(|(z, &s)| corner(z, s)).collect());
            paths += filling.go_round(loops, &corners);
            loops += 1;
            idle = if filling.fibre.len() > known { 0 } else { idle + 1 };
        };
        let fibre = Fibre { is_partial: !stopped.is_complete(), ..filling.fibre };
        Monodromy { fibre, stopped, loops, paths, trace: None }
    }
}

/// In loops with more paths than this, every side is recorded.
const LONG: usize = 1 << 12;

/// Least number of loops times solutions before a search ends for want of a new solution.
const CHANCES: usize = 128;
/// Scales above one, and below: branch points may lie close together about zero.
const LARGER: usize = 8;
const SMALLER: usize = 12;

/// The scale of the next loop. Loops of one scale may all miss the branch points; after half the
/// patience, therefore, every two larger loops are followed by a smaller one.
fn scale(idle: usize, patience: usize) -> f64 {
    let Some(k) = idle.checked_sub(patience.div_ceil(2)) else { return 1.0 };
    let turn = k / 3;
    let steps = if k % 3 < 2 { (turn % LARGER + 1) as i32 } else { -((turn % SMALLER + 1) as i32) };
    families::LOOP_SCALE.powi(steps)
}

/// A fibre that is being filled.
struct Filling<'a, E> {
    search: &'a LoopSearch<'a, E>,
    pieces: Pieces<'a>,
    fibre: Fibre,
}

impl<E: Evaluate> Filling<'_, E> {
    /// Tracks the fibre round one triangle and adds new solutions, or takes them from a record.
    /// Returns the number of paths.
    fn go_round(&mut self, number: usize, corners: &[Vec<Complex64>; 2]) -> usize {
        let (n, known) = (self.fibre.dimension.max(1), self.fibre.len());
        let represented = self.fibre.representatives.as_ref().map(Vec::len);
        let paths = 3 * represented.unwrap_or(known);
        self.pieces.monitor.enter(Stage::Loop, paths as u64);
        // A record has the solutions that the loop has added, and those of them that represent orbits.
        let fits = |(solutions, representatives): &(Vec<Complex64>, Option<Vec<usize>>)| {
            let len = known + solutions.len() / n;
            let are_there = |which: &Vec<usize>| which.iter().all(|&k| k < len);
            solutions.len().is_multiple_of(n)
                && representatives.is_some() == represented.is_some()
                && representatives.as_ref().is_none_or(are_there)
        };
        if let Some((solutions, representatives)) = self.pieces.take(Piece::Whole(number), fits) {
            self.fibre.solutions.extend(solutions);
            if let (Some(all), Some(more)) = (&mut self.fibre.representatives, representatives) {
                all.extend(more);
            }
            return paths;
        }
        let back = self.carried(number, corners);
        self.add_accepted(back.chunks_exact(n));
        let new = |all: &Vec<usize>| all[represented.unwrap_or(0)..].to_vec();
        let representatives = self.fibre.representatives.as_ref().map(new);
        let added = (self.fibre.solutions[known * n..].to_vec(), representatives);
        self.pieces.record(Piece::Whole(number), self.fibre.len(), &added);
        paths
    }

    /// The points to which solutions come back after a loop.
    fn carried(&self, number: usize, corners: &[Vec<Complex64>; 2]) -> Vec<Complex64> {
        let n = self.fibre.dimension;
        let mut moving = self.fibre.tracked();
        let is_long = moving.len() > LONG;
        for (side, corner) in [&corners[0], &corners[1], &self.fibre.parameters].into_iter().enumerate() {
            let step = Piece::Step(2 * number + side);
            let fits = |solutions: &Vec<Complex64>| solutions.len().is_multiple_of(n.max(1));
            // The solutions of the last side are recorded with the loop.
            let is_recorded = is_long && side < corners.len();
            let solutions = match is_recorded.then(|| self.pieces.take(step, fits)).flatten() {
                Some(solutions) => solutions,
                None => {
                    let solutions = self.moved(&moving, corner);
                    if is_recorded {
                        self.pieces.record(step, self.fibre.len(), &solutions);
                    }
                    solutions
                }
            };
            moving = Fibre::new(corner.clone(), n, solutions);
        }
        moving.solutions
    }

    /// The solutions for other parameters at which paths end well.
    fn moved(&self, fibre: &Fibre, target: &[Complex64]) -> Vec<Complex64> {
        let LoopSearch { searched, options, .. } = self.search;
        let options = &options.fibre;
        let (ends, _) = searched.track(fibre, target, options, self.pieces);
        // Paths that share an end have been counted as failed; whichever is true is found by a
        // later loop.
        let regular = ends.iter().filter(|(r, _)| r.end == PathEnd::Success);
        let mut solutions: Vec<Complex64> = regular.flat_map(|(_, x)| x.iter().copied()).collect();
        let drop = repeated(&solutions, fibre.dimension, 0, options.coincidence);
        remove(&mut solutions, fibre.dimension, &drop);
        solutions
    }

    /// Adds points that are refined to solutions that are wanted and not known yet.
    fn add_accepted<'x>(&mut self, points: impl Iterator<Item = &'x [Complex64]>) {
        let LoopSearch { searched, accept, .. } = self.search;
        let mut refiner = Refiner::new(searched.system);
        let mut new = Vec::new();
        for x in points {
            let refined = refiner.refine(&self.fibre.parameters, x);
            if refined.accuracy < families::ACCURATE && accept(&self.fibre.parameters, &refined.point) {
                new.push(refined.point);
            }
        }
        self.add(new.iter().map(Vec::as_slice));
    }

    /// Adds points that are not known yet, each with its orbit.
    fn add<'x>(&mut self, points: impl Iterator<Item = &'x [Complex64]>) {
        let LoopSearch { searched, symmetry, options, .. } = self.search;
        let (n, known, tolerance) = (self.fibre.dimension, self.fibre.len(), options.fibre.coincidence);
        let mut first = Vec::new();
        let mut refiner = Refiner::new(searched.system);
        for x in points {
            if symmetry.is_trivial() {
                self.fibre.solutions.extend_from_slice(x);
                continue;
            }
            first.push(self.fibre.len());
            self.fibre.solutions.extend_from_slice(x);
            for image in symmetry.orbit(&self.fibre.parameters, x, tolerance).into_iter().skip(1) {
                // A point that is no solution is no image under a symmetry.
                let refined = refiner.refine(&self.fibre.parameters, &image);
                if refined.accuracy < families::ACCURATE && relative_distance(&refined.point, &image) < tolerance {
                    self.fibre.solutions.extend(refined.point);
                }
            }
        }
        let drop = repeated(&self.fibre.solutions, n, known, tolerance);
        remove(&mut self.fibre.solutions, n, &drop);
        if let Some(representatives) = &mut self.fibre.representatives {
            // Numbers once the points that are dropped before them are left out.
            let before = |k: usize| drop[..k].iter().filter(|&&dropped| dropped).count();
            representatives.extend(first.into_iter().filter(|&k| !drop[k]).map(|k| k - before(k)));
        }
    }
}

/// Which points after the first `keep` coincide with an earlier one.
fn repeated(solutions: &[Complex64], n: usize, keep: usize, tolerance: f64) -> Vec<bool> {
    let mut drop = vec![false; solutions.len() / n.max(1)];
    for group in coincidences(solutions.chunks_exact(n.max(1)).enumerate(), tolerance) {
        for &k in group[1..].iter().filter(|&&k| k >= keep) {
            drop[k] = true;
        }
    }
    drop
}

/// Drops points.
fn remove(solutions: &mut Vec<Complex64>, n: usize, drop: &[bool]) {
    let mut k = 0;
    solutions.retain(|_| {
        k += 1;
        !drop[(k - 1) / n]
    });
}
