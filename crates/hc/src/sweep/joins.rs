//! Which real solutions of neighbouring cells belong together: real paths between the cells, along the straight way in
//! the parameters.
//!
//! Paths are believed where they make a bijection. Otherwise they are tracked in both directions, and believed where
//! they come back. What is left over must be explained: two branches that meet, which is a fold, a branch that goes to
//! infinity, or one that goes through a multiple point. Where it is not, as between two folds of which neither partner
//! reaches a cell, the way is halved.

use super::cell::{Cell, RealSolution};
use super::grid::Grid;
use super::nearest::Sizes;
use super::segments::Segments;
use super::single::Single;
use crate::tolerances::sweeps;
use crate::tracker::{PathEnd, PathResult, PathSet, Tracker, TrackerOptions};
use num_complex::Complex64;
use poly::{Interpreter, Lanes8};
use serde::Serialize;
use std::borrow::Cow;

/// Why branches end between two cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum BreakKind {
    /// A branch goes to infinity, and no two meet.
    Infinity,
    /// Branches meet in pairs.
    Fold,
    /// The ways along the branches do not show why.
    Unexplained,
}

/// Two neighbouring cells between which branches end.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Break {
    /// The cells.
    pub cells: [usize; 2],
    /// Number of branches of the first cell, and of the second one, that do not reach the other.
    pub ended: [usize; 2],
    /// Why they do not.
    pub kind: BreakKind,
}

/// What two neighbouring cells have in common.
#[derive(Debug, Default)]
pub(super) struct Joined {
    /// Numbers of solutions of the first cell and of the second one that lie on one branch, in ascending order.
    pub(super) pairs: Vec<[usize; 2]>,
    /// Why branches end, if some do.
    pub(super) kind: Option<BreakKind>,
    /// Paths that were tracked.
    pub(super) paths: usize,
}

impl Joined {
    /// The break between these cells, if branches end between them.
    pub(super) fn broken(&self, cells: &[Cell], [a, b]: [usize; 2]) -> Option<Break> {
        let ended = [a, b].map(|cell| {
            let regular = cells[cell].solutions.iter().filter(|s| s.multiplicity == 1).count();
            regular.saturating_sub(self.pairs.len())
        });
        self.kind.filter(|_| ended != [0, 0]).map(|kind| Break { cells: [a, b], ended, kind })
    }
}

/// How often the way between two cells is halved.
const HALVINGS: usize = 8;
/// Steps of a path, at most: one that takes more does not reach the next cell.
const STEPS: usize = 100;

/// A point in the parameters and the solutions there.
struct Site<'c> {
    point: Vec<f64>,
    cell: Cow<'c, Cell>,
}

/// A path from a solution of a cell.
struct Way {
    /// Number of the solution, and of that of the other cell at which the path ends.
    from: usize,
    to: Option<usize>,
    result: PathResult,
    end: Vec<f64>,
}

/// Joins cells of a grid.
pub(super) struct Joiner<'a> {
    tracker: Tracker<'a, Interpreter, Lanes8>,
    single: &'a Single<'a>,
    grid: &'a Grid,
    cells: &'a [Cell],
    careful: TrackerOptions,
    stricter: TrackerOptions,
}

impl<'a> Joiner<'a> {
    pub(super) fn new(single: &'a Single<'a>, grid: &'a Grid, cells: &'a [Cell]) -> Joiner<'a> {
        let careful = TrackerOptions { max_steps: STEPS, ..TrackerOptions::default() };
        let stricter = TrackerOptions { max_steps: STEPS, ..TrackerOptions::conservative() }.stricter(1);
        let mut tracker = Tracker::new(single.family.program(), &careful);
        tracker.set_monitor(single.monitor());
        Joiner { tracker, single, grid, cells, careful, stricter }
    }

    /// What each of these pairs of cells has in common.
    pub(super) fn join(&mut self, edges: &[[usize; 2]]) -> Vec<Joined> {
        let cells = self.cells;
        let site = |cell: usize| Site { point: self.grid.parameters(cell), cell: Cow::Borrowed(&cells[cell]) };
        let sites: Vec<[Site<'a>; 2]> = edges.iter().map(|edge| edge.map(site)).collect();
        let pairs: Vec<[&Site<'_>; 2]> = sites.iter().map(|[a, b]| [a, b]).collect();
        self.joined(&pairs, 0)
    }

    /// What pairs of sites have in common, halved so many times already.
    fn joined(&mut self, pairs: &[[&Site<'_>; 2]], halved: usize) -> Vec<Joined> {
        let ways = self.track(pairs, &self.careful.clone());
        let mut joined = Vec::with_capacity(pairs.len());
        for (pair, ways) in pairs.iter().zip(ways) {
            joined.push(match bijection(*pair, &ways) {
                Some(pairs) => Joined { pairs, kind: None, paths: ways.len() },
                None => self.explained(*pair, halved, ways.len()),
            });
        }
        joined
    }

    /// What two sites have in common where paths from one do not make a bijection.
    fn explained(&mut self, [a, b]: [&Site<'_>; 2], halved: usize, paths: usize) -> Joined {
        let mut both = self.track(&[[a, b], [b, a]], &self.stricter.clone()).into_iter();
        let [there, back] = [both.next().unwrap_or_default(), both.next().unwrap_or_default()];
        let paths = paths + there.len() + back.len();
        let comes_back = |way: &Way| back.iter().any(|other| way.to == Some(other.from) && other.to == Some(way.from));
        let mut pairs: Vec<[usize; 2]> =
            there.iter().filter(|way| comes_back(way)).filter_map(|way| Some([way.from, way.to?])).collect();
        let left = |ways: Vec<Way>, side: usize, pairs: &[[usize; 2]]| -> Vec<Way> {
            ways.into_iter().filter(|way| pairs.iter().all(|pair| pair[side] != way.from)).collect()
        };
        let sizes = sizes(a, b);
        let reason = |there: &[Way], back: &[Way]| kind(there, &b.cell, &sizes).max(kind(back, &a.cell, &sizes));
        let [there, back] = [left(there, 0, &pairs), left(back, 1, &pairs)];
        let kind = reason(&there, &back);
        if kind != Some(BreakKind::Unexplained) {
            return Joined { pairs, kind, paths };
        }
        let halves = if halved < HALVINGS { self.halved(a, b, halved + 1, paths) } else { None };
        if let Some(joined) = halves
            && joined.kind != Some(BreakKind::Unexplained)
        {
            return joined;
        }
        pairs.extend(through(&there, &back, &sizes));
        pairs.sort_unstable();
        let [there, back] = [left(there, 0, &pairs), left(back, 1, &pairs)];
        let kind = reason(&there, &back);
        Joined { pairs, kind, paths }
    }

    /// What two sites have in common by way of the middle between them; `None` if its solutions are in doubt.
    fn halved(&mut self, a: &Site<'_>, b: &Site<'_>, halved: usize, paths: usize) -> Option<Joined> {
        let point: Vec<f64> = a.point.iter().zip(&b.point).map(|(a, b)| 0.5 * a + 0.5 * b).collect();
        let cell = self.single.cell(&point).filter(|cell| cell.standing.is_shown())?;
        let middle = Site { point, cell: Cow::Owned(cell) };
        let [first, second] = &self.joined(&[[a, &middle], [&middle, b]], halved)[..] else { return None };
        let onwards = |&[from, by]: &[usize; 2]| {
            let next = second.pairs.iter().find(|pair| pair[0] == by)?;
            Some([from, next[1]])
        };
        Some(Joined {
            pairs: first.pairs.iter().filter_map(onwards).collect(),
            kind: first.kind.max(second.kind),
            paths: paths + first.paths + second.paths,
        })
    }

    /// The paths from all regular solutions of the first site of each pair to the second one.
    fn track(&mut self, pairs: &[[&Site<'_>; 2]], options: &TrackerOptions) -> Vec<Vec<Way>> {
        let mut segments = Segments::new(self.single.fibre.parameters.len());
        let (mut starts, mut origins) = (Vec::new(), Vec::new());
        for (number, [a, b]) in pairs.iter().enumerate() {
            let before = origins.len();
            for (k, solution) in a.cell.solutions.iter().enumerate().filter(|(_, s)| s.multiplicity == 1) {
                starts.extend(solution.value.iter().map(|&x| Complex64::from(x)));
                origins.push((number, k));
            }
            let start: Vec<Complex64> = a.point.iter().map(|&p| p.into()).collect();
            segments.add(&start, &b.point, origins.len() - before);
        }
        let mut ends = PathSet::with_capacity(self.single.fibre.dimension, origins.len());
        self.tracker.set_options(options);
        self.tracker.track(&segments, &starts, 0..origins.len(), &mut ends);
        ends.sort();
        let mut ways: Vec<Vec<Way>> = pairs.iter().map(|_| Vec::new()).collect();
        let sizes: Vec<Sizes> = pairs.iter().map(|[a, b]| sizes(a, b)).collect();
        for ((result, point), &(number, from)) in ends.iter().zip(&origins) {
            let end: Vec<f64> = point.iter().map(|z| z.re).collect();
            let there = &pairs[number][1].cell.solutions;
            let to = if result.end == PathEnd::Success { sizes[number].arrival(&end, there) } else { None };
            ways[number].push(Way { from, to, result: *result, end });
        }
        ways
    }
}

/// Whether all solutions of a site are regular.
fn is_whole(site: &Site<'_>) -> bool {
    site.cell.solutions.iter().all(|s| s.multiplicity == 1)
}

/// The pairs of solutions that paths join, if these reach all solutions of both sites, and all are regular.
fn bijection([a, b]: [&Site<'_>; 2], ways: &[Way]) -> Option<Vec<[usize; 2]>> {
    let count = b.cell.solutions.len();
    if !is_whole(a) || !is_whole(b) || a.cell.solutions.len() != count || ways.len() != count {
        return None;
    }
    let mut reached = vec![false; count];
    let fresh = |way: &Way| {
        let to = way.to?;
        (!std::mem::replace(&mut reached[to], true)).then_some([way.from, to])
    };
    ways.iter().map(fresh).collect()
}

fn sizes(a: &Site<'_>, b: &Site<'_>) -> Sizes {
    Sizes::of(a.cell.solutions.iter().chain(&b.cell.solutions).map(|s| &s.value[..]))
}

impl Way {
    /// Whether two ways break off at one point. `shares` are what is left of them, or of one and the part of the other
    /// that lies behind it.
    fn meets(&self, other: &Way, shares: [f64; 2], sizes: &Sizes) -> bool {
        self.breaks_off()
            && other.breaks_off()
            && (shares[0] - shares[1]).abs() <= sweeps::MEETING_TIME
            && sizes.distance(&self.end, &other.end) <= sweeps::MEETING_PLACE
    }

    fn breaks_off(&self) -> bool {
        self.to.is_none() && self.result.end != PathEnd::Success
    }
}

/// Branches that go through a multiple point, at which complex solutions meet them: just one way from either side breaks
/// off there.
fn through(there: &[Way], back: &[Way], sizes: &Sizes) -> Vec<[usize; 2]> {
    let opposite = |a: &Way, b: &Way| !sizes.is_far(&a.end) && a.meets(b, [a.result.t, 1.0 - b.result.t], sizes);
    let beside = |ways: &[Way], a: &Way| ways.iter().filter(|b| a.meets(b, [a.result.t, b.result.t], sizes)).count();
    let mut pairs = Vec::new();
    for a in there.iter().filter(|a| beside(there, a) == 1) {
        let mut others = back.iter().filter(|b| opposite(a, b));
        if let (Some(b), None) = (others.next(), others.next())
            && beside(back, b) == 1
        {
            pairs.push([a.from, b.from]);
        }
    }
    pairs
}

/// Why paths do not reach the cell `other`; `None` if there are no paths.
fn kind(ways: &[Way], other: &Cell, sizes: &Sizes) -> Option<BreakKind> {
    let multiple: Vec<&RealSolution> = other.solutions.iter().filter(|s| s.multiplicity > 1).collect();
    let mut kind = None;
    for (k, way) in ways.iter().enumerate() {
        let ends_at_multiple = || {
            way.result.t <= sweeps::MEETING_TIME
                && multiple.iter().any(|s| sizes.distance(&way.end, &s.value) <= sweeps::MEETING_PLACE)
        };
        let meets = |other: &Way| way.meets(other, [way.result.t, other.result.t], sizes);
        let own = if !way.breaks_off() {
            BreakKind::Unexplained
        } else if sizes.is_far(&way.end) {
            BreakKind::Infinity
        } else if ends_at_multiple() || ways.iter().enumerate().any(|(j, other)| j != k && meets(other)) {
            BreakKind::Fold
        } else {
            BreakKind::Unexplained
        };
        kind = kind.max(Some(own));
    }
    kind
}
