//! The solutions of all cells, from those of a fibre: cells side by side where all paths end plainly, and the others
//! one by one with all that [`Family::track`](crate::Family::track) does.

use super::cell::{Cell, Standing};
use super::conjugates::reality;
use super::grid::Grid;
use super::judge::{real_solution, sorted};
use super::options::SweepOptions;
use super::segments::Segments;
use super::single::Single;
use crate::distinct::relative_distance;
use crate::family::{FamilyError, Fibre};
use crate::monitor::Monitor;
use crate::refine::{Refined, Refiner};
// One thread needs no trait for `map`.
#[cfg_attr(not(feature = "threads"), allow(unused_imports))]
use crate::threads::{IntoParallelRefIterator, ParallelIterator};
use crate::tolerances::ends;
use crate::tracker::{PathEnd, PathSet, Tracker, TrackerOptions};
use num_complex::Complex64;
use poly::{Interpreter, Lanes8};

/// Cells after which it is asked whether to go on.
pub(super) const BLOCK: usize = 4096;
/// Paths that one thread takes at a time.
const PATHS: usize = 512;

/// What the paths to cells were.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tracked {
    /// Paths from the fibre, one for each solution and cell, or for each orbit.
    pub(super) paths: u64,
    /// Paths that were tracked again, or a second time with the rest of their cell.
    pub(super) again: u64,
}

/// Fills the cells. Where the work is stopped, the rest stay as they are.
pub(super) fn fill(
    single: &Single<'_>,
    grid: &Grid,
    options: &SweepOptions,
    monitor: &Monitor,
    cells: &mut [Cell],
) -> Result<Tracked, FamilyError> {
    let Single { family, fibre, .. } = *single;
    let side_by_side = !options.certify && family.states_equations_alone() && fibre.representatives.is_none();
    let tracker = options.solve.paths.tracker.first(fibre.is_partial);
    let size = (PATHS / fibre.len().max(1)).clamp(1, BLOCK);
    let mut tracked = Tracked::default();
    for (block, cells) in cells.chunks_mut(BLOCK).enumerate() {
        let first = block * BLOCK;
        let numbers: Vec<usize> = (first..first + cells.len()).collect();
        if side_by_side {
            let chunks: Vec<&[usize]> = numbers.chunks(size).collect();
            let make = || Plain::new(single, grid, &tracker);
            let plainly = |plain: &mut Plain<'_>, numbers: &&[usize]| {
                let found = plain.cells(numbers);
                monitor.add(found.iter().flatten().count() as u64, 0);
                found
            };
            let found: Vec<Vec<Option<Cell>>> = chunks.par_iter().map_init(make, plainly).collect();
            for (cell, found) in cells.iter_mut().zip(found.into_iter().flatten()) {
                *cell = found.unwrap_or_default();
            }
        }
        let left: Vec<usize> =
            numbers.into_iter().filter(|k| cells[k - first].standing == Standing::Unreached).collect();
        tracked.paths += ((cells.len() - left.len()) * fibre.len()) as u64;
        if monitor.is_cancelled() {
            break;
        }
        let found = single.cells(grid, &left, || monitor.add(1, 0))?;
        for (&k, (cell, paths, again)) in left.iter().zip(found) {
            tracked.paths += paths;
            tracked.again += again + if side_by_side { paths } else { 0 };
            cells[k - first] = cell;
        }
    }
    Ok(tracked)
}

/// Cells in which all paths end plainly: at regular solutions of their own, of which it is clear which are real.
struct Plain<'a> {
    grid: &'a Grid,
    fibre: &'a Fibre,
    tracker: Tracker<'a, Interpreter, Lanes8>,
    refiner: Refiner<'a, Interpreter>,
    starts: Vec<Complex64>,
}

impl<'a> Plain<'a> {
    fn new(single: &'a Single<'_>, grid: &'a Grid, options: &TrackerOptions) -> Plain<'a> {
        let program = single.family.program();
        let mut tracker = Tracker::new(program, options);
        tracker.set_monitor(single.monitor());
        Plain { grid, fibre: single.fibre, tracker, refiner: Refiner::new(program), starts: Vec::new() }
    }

    /// The cells of these numbers; `None` for those that are not plain.
    fn cells(&mut self, numbers: &[usize]) -> Vec<Option<Cell>> {
        let (fibre, count) = (self.fibre, self.fibre.len());
        let mut segments = Segments::new(fibre.parameters.len());
        let points: Vec<Vec<f64>> = numbers.iter().map(|&k| self.grid.parameters(k)).collect();
        points.iter().for_each(|point| segments.add(&fibre.parameters, point, count));
        // Those of an earlier call serve again.
        while self.starts.len() < numbers.len() * fibre.solutions.len() {
            self.starts.extend_from_slice(&fibre.solutions);
        }
        let mut ends = PathSet::with_capacity(fibre.dimension, numbers.len() * count);
        self.tracker.track(&segments, &self.starts, 0..numbers.len() * count, &mut ends);
        ends.sort();
        points.iter().enumerate().map(|(k, point)| self.cell(&ends, k * count, point)).collect()
    }

    /// The cell of the ends from this one on, as many as the fibre has solutions.
    fn cell(&mut self, ends: &PathSet, first: usize, parameters: &[f64]) -> Option<Cell> {
        let parameters: Vec<Complex64> = parameters.iter().map(|&p| p.into()).collect();
        let mut all: Vec<Refined> = Vec::with_capacity(self.fibre.len());
        for k in first..first + self.fibre.len() {
            if ends.results()[k].end != PathEnd::Success {
                return None;
            }
            let mut refined = Refined::default();
            self.refiner.refine_into(&parameters, ends.point(k), &mut refined);
            if !refined.plain || relative_distance(&refined.point, ends.point(k)) > ends::ARRIVED {
                return None;
            }
            all.push(refined);
        }
        let real = reality(&all.iter().map(|refined| &refined.point[..]).collect::<Vec<_>>()).ok()?;
        let listed = all.iter().zip(&real).filter(|(_, real)| **real);
        let solutions = sorted(listed.map(|(refined, _)| real_solution(&refined.point, 1, refined.condition)));
        Some(Cell { standing: Standing::Counted, complex: all.len() - solutions.len(), solutions, at_infinity: 0 })
    }
}
