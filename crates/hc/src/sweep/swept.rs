//! A sweep from beginning to end, and its result.

use super::branches::number;
use super::cell::{Cell, Standing};
use super::cells::{BLOCK, fill};
use super::error::SweepError;
use super::grid::Grid;
use super::joins::{Break, BreakKind, Joined, Joiner};
use super::options::SweepOptions;
use super::single::Single;
use crate::family::{Family, FamilyError, Fibre};
use crate::monitor::{Monitor, Stage};
use crate::run::Run;
// One thread needs no trait for `map`.
#[cfg_attr(not(feature = "threads"), allow(unused_imports))]
use crate::threads::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;

/// Pairs of cells that one thread takes at a time.
const EDGES: usize = 128;

/// The real solutions of a family in all cells of a grid.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Sweep {
    /// The cells, those along the first axis next to each other ([`Grid::len`]).
    pub cells: Vec<Cell>,
    /// Pairs of neighbouring cells between which branches end, in the order of the first cell.
    pub breaks: Vec<Break>,
    /// Number of branches.
    pub branches: usize,
    /// Number of solutions of the fibre.
    pub fibre: usize,
    /// Paths that were tracked.
    pub paths: SweepPaths,
    /// Whether the work was stopped: cells may be [`Standing::Unreached`], and branches may not be joined.
    pub interrupted: bool,
}

/// Paths of a sweep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct SweepPaths {
    /// From the fibre to cells, one for each solution, or for each orbit of a symmetry.
    pub to_cells: u64,
    /// How often one of these was tracked again.
    pub again: u64,
    /// From cells to their neighbours, one for each real solution, more where branches end.
    pub between_cells: u64,
}

impl Sweep {
    /// Number of cells whose number of real solutions is not shown.
    pub fn doubtful(&self) -> usize {
        self.cells.iter().filter(|cell| matches!(cell.standing, Standing::Doubtful(_))).count()
    }

    /// Number of pairs of neighbouring cells between which branches end, and the ways along them do not show why.
    pub fn unexplained(&self) -> usize {
        self.breaks.iter().filter(|broken| broken.kind == BreakKind::Unexplained).count()
    }
}

impl Family {
    /// The real solutions for all parameters of a grid, from those of a fibre, as branches. The family must have real
    /// coefficients. The result does not depend on the number of threads.
    ///
    /// ```
    /// use hc::sweep::{Axis, BreakKind, Grid, SweepOptions};
    /// use hc::{Family, MonodromyOptions};
    ///
    /// // Three real solutions between the folds at a = -2 and a = 2, one outside.
    /// let family = Family::from_formulas(&["x"], &["a"], &["x^3 - 3*x + a"])?;
    /// let fibre = family.monodromy(&MonodromyOptions::new())?.fibre;
    /// let grid = Grid::new(&family, vec![Axis::new("a", -4.1, 4.1, 42)], &[] as &[(&str, f64)])?;
    /// let sweep = family.sweep(&fibre, &grid, &SweepOptions::new())?;
    /// for (k, cell) in sweep.cells.iter().enumerate() {
    ///     assert!(cell.standing.is_shown());
    ///     assert_eq!(cell.real(), if grid.values(k)[0].abs() < 2.0 { 3 } else { 1 });
    /// }
    /// assert_eq!(sweep.branches, 3);
    /// assert!(sweep.breaks.len() == 2 && sweep.breaks.iter().all(|b| b.kind == BreakKind::Fold));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If the family has coefficients that are not real, the grid or the fibre does not fit it, a setting is out of
    /// range, or the cells do not fit into memory.
    pub fn sweep(&self, fibre: &Fibre, grid: &Grid, options: &SweepOptions) -> Result<Sweep, SweepError> {
        Run::new().sweep(self, fibre, grid, options)
    }
}

impl Run {
    /// [`Family::sweep`], run in this way.
    ///
    /// # Errors
    /// Those of [`Family::sweep`]; also if there is a checkpoint, since sweeps are not recorded.
    pub fn sweep(
        &self,
        family: &Family,
        fibre: &Fibre,
        grid: &Grid,
        options: &SweepOptions,
    ) -> Result<Sweep, SweepError> {
        self.unrecorded("a sweep").map_err(FamilyError::from)?;
        let expected = family.system().parameters().len();
        let found = grid.parameters(0).len();
        if found != expected {
            return Err(SweepError::Misfit { found, expected });
        }
        if !family.system().is_real() {
            return Err(SweepError::NotReal);
        }
        family.check(fibre)?;
        grid.check_room(fibre.len(), fibre.dimension)?;
        self.install(|| swept(self, family, fibre, grid, options))
    }
}

fn swept(run: &Run, family: &Family, fibre: &Fibre, grid: &Grid, options: &SweepOptions) -> Result<Sweep, SweepError> {
    let monitor = run.monitor();
    let mut cells = vec![Cell::default(); grid.len()];
    monitor.enter(Stage::Cells, cells.len() as u64);
    let single = Single::new(family, fibre, options, monitor);
    let tracked = fill(&single, grid, options, monitor, &mut cells)?;
    let mut sweep = Sweep {
        cells,
        breaks: Vec::new(),
        branches: 0,
        fibre: fibre.len(),
        paths: SweepPaths { to_cells: tracked.paths, again: tracked.again, between_cells: 0 },
        interrupted: false,
    };
    if options.join && !monitor.is_cancelled() {
        join(&single, grid, monitor, &mut sweep);
    }
    sweep.interrupted = monitor.is_cancelled();
    Ok(sweep)
}

/// Joins the cells to branches.
fn join(single: &Single<'_>, grid: &Grid, monitor: &Monitor, sweep: &mut Sweep) {
    let mut pairs: Vec<[(usize, usize); 2]> = Vec::new();
    monitor.enter(Stage::Branches, sweep.cells.len() as u64);
    for first in (0..sweep.cells.len()).step_by(BLOCK) {
        let numbers = first..(first + BLOCK).min(sweep.cells.len());
        let edges: Vec<[usize; 2]> =
            numbers.clone().flat_map(|cell| grid.next(cell).map(move |next| [cell, next])).collect();
        let chunks: Vec<&[[usize; 2]]> = edges.chunks(EDGES).collect();
        let cells = &sweep.cells;
        let make = || Joiner::new(single, grid, cells);
        let found: Vec<Vec<Joined>> = chunks.par_iter().map_init(make, |joiner, edges| joiner.join(edges)).collect();
        if monitor.is_cancelled() {
            return;
        }
        for (&[a, b], joined) in edges.iter().zip(found.into_iter().flatten()) {
            sweep.breaks.extend(joined.broken(&sweep.cells, [a, b]));
            pairs.extend(joined.pairs.iter().map(|&[j, k]| [(a, j), (b, k)]));
            sweep.paths.between_cells += joined.paths as u64;
        }
        monitor.add(numbers.len() as u64, 0);
    }
    sweep.branches = number(&mut sweep.cells, pairs.into_iter());
}
