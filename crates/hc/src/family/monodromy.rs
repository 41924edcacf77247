//! Filling a fibre: all solutions of a family for one generic parameter point, from a single
//! solution.
//!
//! Parameters go round random triangles, and solutions return as other solutions of the same
//! irreducible component (Duff, Hill, Jensen, Lee, Leykin, Sommars 2018, arXiv:1609.08722): those of
//! their orbit under the monodromy group. The [trace test](crate::Family::trace_test) shows whether
//! orbits are whole. Whether there are others is a question that no loop answers.

use super::fibre::{Fibre, numbers_without};
use super::joined::Joined;
use super::reach::Reach;
use super::search::{Monodromy, MonodromyOptions, Stopped};
use super::sides::Searched;
use super::still::refined;
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
    LoopSearch { searched, accept: &|_, _| true, is_still: &|_| false, symmetry, options }
        .fill(start, Pieces::alone(monitor))
}

/// A search for solutions by loops in parameter space; of a symmetric family one solution of each orbit goes
/// round.
pub(super) struct LoopSearch<'a, E> {
    pub(super) searched: &'a Searched<'a, E>,
    /// Asked about every new solution; solutions that it refuses (degenerate ones) are dropped.
    pub(super) accept: &'a dyn Fn(&[Complex64], &[Complex64]) -> bool,
    /// Asked about every new solution; solutions that no parameter moves are dropped too.
    pub(super) is_still: &'a dyn Fn(&[Complex64]) -> bool,
    pub(super) symmetry: &'a Symmetry,
    pub(super) options: &'a MonodromyOptions,
}

impl<E: Evaluate> LoopSearch<'_, E> {
    /// The fibre with further solutions for its parameters, and those to which solutions of other fibres
    /// lead; `None` if it has them all.
    pub(super) fn joined<'x>(
        &self,
        fibre: &Fibre,
        further: impl Iterator<Item = &'x [Complex64]>,
        others: &[Fibre],
        monitor: &Monitor,
    ) -> Option<Fibre> {
        let pieces = Pieces::alone(monitor);
        let mut filling = Filling::new(self, pieces, fibre.clone());
        filling.add_accepted(further.map(|x| (None, x)));
        for other in others {
            let (ends, _) = self.searched.track(other, &fibre.parameters, &self.options.fibre, pieces);
            let regular = ends.iter().filter(|(r, _)| r.end == PathEnd::Success);
            filling.add_accepted(regular.map(|(_, x)| (None, x)));
        }
        (filling.fibre.len() > fibre.len()).then_some(filling.fibre)
    }

    /// The fibre with solutions that no parameter moves, and the sizes of their orbits under the
    /// symmetry.
    pub(super) fn with_still(&self, fibre: Fibre, still: &[Complex64], monitor: &Monitor) -> (Fibre, Vec<usize>) {
        let (n, known) = (fibre.dimension.max(1), fibre.len());
        let search = LoopSearch { is_still: &|_| false, ..*self };
        let mut filling = Filling::new(&search, Pieces::alone(monitor), fibre);
        filling.add(still.chunks_exact(n).map(|x| (None, x)));
        let sizes = filling.joined.sizes_from(known);
        (filling.fibre, sizes)
    }

    /// Completes `start` (one or several solutions for generic parameters). Each loop is a piece.
    pub(super) fn fill(&self, start: &Fibre, pieces: Pieces<'_>) -> Monodromy {
        let LoopSearch { searched, symmetry, options, .. } = self;
        let mut filling = Filling::new(self, pieces, start.clone());
        if !symmetry.is_trivial() {
            filling.fibre.solutions.clear();
            filling.fibre.representatives = Some(Vec::new());
            filling.joined = Joined::default();
            filling.add(start.solutions.chunks_exact(start.dimension.max(1)).map(|x| (None, x)));
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
            if known == 0 {
                break Stopped::NoProgress;
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
        let orbits = filling.joined.sizes();
        let fibre = Fibre { is_partial: !stopped.is_complete(), ..filling.fibre };
        Monodromy { fibre, stopped, orbits, multiple: Vec::new(), loops, paths, trace: None, group: None }
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
    joined: Joined,
}

/// What a loop has brought, as it is recorded: solutions, those of them that represent orbits of a
/// symmetry, and which solutions are joined.
type Brought = (Vec<Complex64>, Option<Vec<usize>>, Vec<(usize, usize)>);

/// Points on a side of a loop, and from which points of the side before they come. The points of the side
/// before that brought none, and those that share theirs with others, are the exceptions.
type Carried = (Vec<Complex64>, [Vec<usize>; 2]);

impl<'a, E: Evaluate> Filling<'a, E> {
    fn new(search: &'a LoopSearch<'a, E>, pieces: Pieces<'a>, fibre: Fibre) -> Self {
        let mut joined = Joined::default();
        joined.grow(fibre.len());
        Filling { search, pieces, fibre, joined }
    }

    /// Tracks the fibre round one triangle and adds new solutions, or takes them from a record.
    /// Returns the number of paths.
    fn go_round(&mut self, number: usize, corners: &[Vec<Complex64>; 2]) -> usize {
        let (n, known) = (self.fibre.dimension.max(1), self.fibre.len());
        let represented = self.fibre.representatives.as_ref().map(Vec::len);
        let paths = 3 * represented.unwrap_or(known);
        self.pieces.monitor.enter(Stage::Loop, paths as u64);
        // A record has the solutions that the loop has added, and those of them that represent orbits.
        let fits = |(solutions, representatives, joins): &Brought| {
            let len = known + solutions.len() / n;
            let are_there = |which: &Vec<usize>| which.iter().all(|&k| k < len);
            solutions.len().is_multiple_of(n)
                && representatives.is_some() == represented.is_some()
                && representatives.as_ref().is_none_or(are_there)
                && joins.iter().all(|&(a, b)| a.max(b) < len)
        };
        if let Some((solutions, representatives, joins)) = self.pieces.take(Piece::Whole(number), fits) {
            self.fibre.solutions.extend(solutions);
            if let (Some(all), Some(more)) = (&mut self.fibre.representatives, representatives) {
                all.extend(more);
            }
            self.joined.grow(self.fibre.len());
            joins.into_iter().for_each(|(a, b)| self.joined.join(a, b));
            return paths;
        }
        // Joins from before the loop are not its own.
        self.joined.take_new();
        let (back, from) = self.carried(number, corners);
        self.add_accepted(from.into_iter().zip(back.chunks_exact(n)));
        let new = |all: &Vec<usize>| all[represented.unwrap_or(0)..].to_vec();
        let representatives = self.fibre.representatives.as_ref().map(new);
        let added: Brought = (self.fibre.solutions[known * n..].to_vec(), representatives, self.joined.take_new());
        self.pieces.record(Piece::Whole(number), self.fibre.len(), &added);
        paths
    }

    /// The points to which solutions come back after a loop, and the solutions from which they come.
    fn carried(&self, number: usize, corners: &[Vec<Complex64>; 2]) -> (Vec<Complex64>, Vec<Option<usize>>) {
        let n = self.fibre.dimension;
        let mut moving = self.fibre.tracked();
        let mut from: Vec<Option<usize>> = match &self.fibre.representatives {
            Some(which) => which.iter().map(|&k| Some(k)).collect(),
            None => (0..moving.len()).map(Some).collect(),
        };
        let is_long = moving.len() > LONG;
        for (side, corner) in [&corners[0], &corners[1], &self.fibre.parameters].into_iter().enumerate() {
            let step = Piece::Step(2 * number + side);
            let count = moving.len();
            let fits = |(solutions, [gone, _]): &Carried| {
                gone.is_sorted() && gone.len() <= count && solutions.len() == (count - gone.len()) * n
            };
            // The solutions of the last side are recorded with the loop.
            let is_recorded = is_long && side < corners.len();
            let carried = match is_recorded.then(|| self.pieces.take(step, fits)).flatten() {
                Some(carried) => carried,
                None => {
                    let carried = self.moved(&moving, corner);
                    if is_recorded {
                        self.pieces.record(step, self.fibre.len(), &carried);
                    }
                    carried
                }
            };
            let (solutions, [gone, shared]) = carried;
            for k in shared {
                from.get_mut(k).into_iter().for_each(|from| *from = None);
            }
            let mut k = 0;
            from.retain(|_| {
                k += 1;
                gone.binary_search(&(k - 1)).is_err()
            });
            moving = Fibre::new(corner.clone(), n, solutions);
        }
        (moving.solutions, from)
    }

    /// The solutions for other parameters at which paths end well.
    fn moved(&self, fibre: &Fibre, target: &[Complex64]) -> Carried {
        let LoopSearch { searched, options, .. } = self.search;
        let options = &options.fibre;
        let (ends, _) = searched.track(fibre, target, options, self.pieces);
        let regular = || ends.iter().filter(|(r, _)| r.end == PathEnd::Success);
        let mut solutions: Vec<Complex64> = regular().flat_map(|(_, x)| x.iter().copied()).collect();
        // Paths that share an end have been counted as failed; whichever is true is found by a
        // later loop.
        let groups = coincidences(solutions.chunks_exact(fibre.dimension.max(1)).enumerate(), options.coincidence);
        let numbers: Vec<usize> = regular().map(|(r, _)| r.path).collect();
        let drop = repeated(&groups, numbers.len(), 0);
        remove(&mut solutions, fibre.dimension, &drop);
        let mut stays = vec![false; fibre.len()];
        numbers.iter().zip(&drop).filter(|(_, dropped)| !**dropped).for_each(|(&k, _)| stays[k] = true);
        let gone = (0..fibre.len()).filter(|&k| !stays[k]).collect();
        (solutions, [gone, groups.iter().map(|group| numbers[group[0]]).collect()])
    }

    /// Adds points that are refined to regular solutions that are wanted and not known yet, each with the
    /// solution from which a loop leads to it. A path that has jumped may end on a component of positive dimension.
    fn add_accepted<'x>(&mut self, points: impl Iterator<Item = (Option<usize>, &'x [Complex64])>) {
        let LoopSearch { searched, accept, .. } = self.search;
        let mut refiner = Refiner::new(searched.system);
        let mut new = Vec::new();
        for (from, x) in points {
            let p = &self.fibre.parameters;
            let refined = refined(&mut refiner, p, x);
            let is_regular = refined.accuracy < families::ACCURATE
                && (refiner.is_regular(p, &refined) || refiner.contracts_precisely(p, &refined.point));
            if is_regular && accept(p, &refined.point) {
                new.push((from, refined.point));
            }
        }
        self.add(new.iter().map(|(from, x)| (*from, x.as_slice())));
    }

    /// Adds points that are not known yet, each with its orbit under the symmetry.
    fn add<'x>(&mut self, points: impl Iterator<Item = (Option<usize>, &'x [Complex64])>) {
        let LoopSearch { searched, symmetry, options, is_still, .. } = self.search;
        let (n, known, tolerance) = (self.fibre.dimension, self.fibre.len(), options.fibre.coincidence);
        // Of each point its number, that of its last image, and from where it comes.
        let mut added: Vec<(usize, usize, Option<usize>)> = Vec::new();
        let mut refiner = Refiner::new(searched.system);
        for (from, x) in points {
            let first = self.fibre.len();
            self.fibre.solutions.extend_from_slice(x);
            if !symmetry.is_trivial() {
                for image in symmetry.orbit(&self.fibre.parameters, x, tolerance).into_iter().skip(1) {
                    // A point that is no solution is no image under a symmetry.
                    let refined = refined(&mut refiner, &self.fibre.parameters, &image);
                    if refined.accuracy < families::ACCURATE && relative_distance(&refined.point, &image) < tolerance {
                        self.fibre.solutions.extend(refined.point);
                    }
                }
            }
            added.push((first, self.fibre.len(), from));
        }
        let count = self.fibre.len();
        let groups = coincidences(self.fibre.solutions.chunks_exact(n.max(1)).enumerate(), tolerance);
        let mut drop = repeated(&groups, count, known);
        // The first of each group, to which its other points belong.
        let mut same: Vec<usize> = (0..count).collect();
        groups.iter().flatten().zip(groups.iter().flat_map(|g| g.iter().map(|_| g[0]))).for_each(|(&k, f)| same[k] = f);
        for &(first, end, _) in &added {
            if !drop[first] && is_still(&self.fibre.solutions[first * n..(first + 1) * n]) {
                drop[first..end].fill(true);
            }
        }
        remove(&mut self.fibre.solutions, n, &drop);
        let numbers = numbers_without(&drop);
        let number = |k: usize| numbers[same[k]];
        if let Some(representatives) = &mut self.fibre.representatives {
            representatives.extend(added.iter().filter_map(|&(first, ..)| numbers[first]));
        }
        self.joined.grow(self.fibre.len());
        for (first, end, from) in added {
            let Some(to) = number(first) else { continue };
            let images = (first + 1..end).filter_map(number);
            from.into_iter().chain(images).for_each(|with| self.joined.join(with, to));
        }
    }
}

/// Which of so many points, after the first `keep`, coincide with an earlier one, by groups of coinciding points.
fn repeated(groups: &[Vec<usize>], count: usize, keep: usize) -> Vec<bool> {
    let mut drop = vec![false; count];
    for group in groups {
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
