//! Mixed cells and mixed volume.

use super::cell::Cell;
use super::error::{MixedError, Overflow};
use super::integer::Integer;
use super::search::{Sink, search};
use super::space::Space;
use crate::monitor::{Monitor, Stage};
use crate::run::Run;
use std::cmp::Reverse;

/// A fine mixed cell: the sum of one edge of each support.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MixedCell {
    /// The edge of each support, as indices of two of its points.
    pub edges: Vec<[usize; 2]>,
    /// Volume `V`.
    pub volume: u64,
    /// `V` times the inner normal `g`: over each support, `<g, a> + lift(a)` is least exactly on
    /// the edge.
    pub normal: Vec<i128>,
}

/// A mixed volume, and how it was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MixedVolume {
    /// The mixed volume.
    pub volume: u64,
    /// Number of mixed cells in the subdivision that gave it.
    pub cells: usize,
}

/// The mixed volume of `n` supports in `n` unknowns. By Bernstein's theorem it is the number of
/// solutions with all coordinates nonzero of a system with generic coefficients.
///
/// ```
/// use hc::mixed_volume;
/// // a + b x + c y + d x y and the same again
/// let square = vec![vec![0, 0], vec![1, 0], vec![0, 1], vec![1, 1]];
/// assert_eq!(mixed_volume(2, &[square.clone(), square])?.volume, 2);
/// # Ok::<(), hc::start::MixedError>(())
/// ```
///
/// # Errors
/// If the number of supports differs from the number of unknowns, an exponent vector has another
/// length, or volumes exceed 64 bits.
pub fn mixed_volume(unknowns: usize, supports: &[Vec<Vec<i32>>]) -> Result<MixedVolume, MixedError> {
    Run::new().mixed_volume(unknowns, supports)
}

impl Run {
    /// [`mixed_volume`], run in this way. [`Progress`](crate::Progress) has the number of cells found
    /// so far and their volume, which is a lower bound.
    ///
    /// # Errors
    /// Those of [`mixed_volume`], and [`MixedError::Cancelled`] after [`Monitor::cancel`]; also if
    /// there is a checkpoint, since the search for mixed cells is not recorded.
    pub fn mixed_volume(&self, unknowns: usize, supports: &[Vec<Vec<i32>>]) -> Result<MixedVolume, MixedError> {
        self.unrecorded("a mixed volume")?;
        self.install(|| mixed_volume_watched(unknowns, supports, self.monitor()))
    }
}

fn mixed_volume_watched(
    unknowns: usize,
    supports: &[Vec<Vec<i32>>],
    monitor: &Monitor,
) -> Result<MixedVolume, MixedError> {
    monitor.enter(Stage::MixedCells, 0);
    let Some(ordered) = Ordered::new(unknowns, supports)? else { return Ok(MixedVolume { volume: 0, cells: 0 }) };
    let space = Space::new(ordered.supports, None, monitor);
    let (volume, cells) = total(search(&space, || Total::new(monitor))?)?;
    let volume = u64::try_from(volume).map_err(|_| MixedError::TooLarge)?;
    Ok(MixedVolume { volume, cells })
}

/// The volume and number of cells.
pub(super) struct Total<'a> {
    volume: u128,
    cells: usize,
    monitor: &'a Monitor,
}

impl<'a> Total<'a> {
    /// A total without cells; the monitor hears of each cell that is added.
    pub(super) fn new(monitor: &'a Monitor) -> Self {
        Total { volume: 0, cells: 0, monitor }
    }
}

/// The volume and number of all cells.
///
/// # Errors
/// If the volume is too large.
pub(super) fn total(parts: Vec<Total<'_>>) -> Result<(u128, usize), MixedError> {
    parts.into_iter().try_fold((0u128, 0), |(volume, cells), part| {
        let volume = volume.checked_add(part.volume).ok_or(MixedError::TooLarge)?;
        Ok((volume, cells + part.cells))
    })
}

impl Sink for Total<'_> {
    fn take<T: Integer>(&mut self, cell: &Cell<T>) -> Result<(), Overflow> {
        let volume = cell.volume.wide().unsigned_abs();
        self.volume = self.volume.checked_add(volume).ok_or(Overflow)?;
        self.cells += 1;
        self.monitor.add(1, u64::try_from(volume).unwrap_or(u64::MAX));
        Ok(())
    }
}

/// The mixed cells of the regular subdivision of a lifting (one value per point), in the order of
/// their edges.
///
/// The lifting is perturbed symbolically, so that all cells are fine and their volumes add up to
/// the mixed volume. If the lifting was not generic, the least value over a support is also taken
/// at points outside the edge.
///
/// # Errors
/// If the numbers of supports, exponents, points and values do not match, or volumes exceed 64
/// bits.
pub fn mixed_cells(
    unknowns: usize,
    supports: &[Vec<Vec<i32>>],
    lifting: &[Vec<i32>],
) -> Result<Vec<MixedCell>, MixedError> {
    let found: Vec<Vec<MixedCell>> = watched_cells(unknowns, supports, lifting, &Monitor::default(), Vec::new)?;
    let mut cells = found.concat();
    cells.sort_unstable_by(|a, b| a.edges.cmp(&b.edges));
    Ok(cells)
}

/// Keeps the required data of the mixed cells that a thread finds.
pub(crate) trait Keep: Send {
    /// A cell as in [`MixedCell`].
    fn keep(&mut self, edges: &[[u32; 2]], volume: u64, normal: &[i128]);
}

impl Keep for Vec<MixedCell> {
    fn keep(&mut self, edges: &[[u32; 2]], volume: u64, normal: &[i128]) {
        let edges = edges.iter().map(|edge| edge.map(|p| p as usize)).collect();
        self.push(MixedCell { edges, volume, normal: normal.to_vec() });
    }
}

/// What `make` makes, each with some of the cells, in any order: tasks end in any order, a cell is
/// known by its edges.
pub(crate) fn watched_cells<K: Keep>(
    unknowns: usize,
    supports: &[Vec<Vec<i32>>],
    lifting: &[Vec<i32>],
    monitor: &Monitor,
    make: impl Fn() -> K + Sync,
) -> Result<Vec<K>, MixedError> {
    monitor.enter(Stage::MixedCells, 0);
    for (i, points) in supports.iter().enumerate() {
        let values = lifting.get(i).map_or(0, Vec::len);
        if values != points.len() {
            return Err(MixedError::Lifting { support: i + 1, points: points.len(), values });
        }
    }
    let Some(Ordered { supports, order }) = Ordered::new(unknowns, supports)? else { return Ok(Vec::new()) };
    let tau: Vec<i64> = order.iter().flat_map(|&i| &lifting[i]).map(|&l| -i64::from(l)).collect();
    let space = Space::new(supports, Some(tau), monitor);
    let (edges, normal) = (vec![[0; 2]; unknowns], vec![0; unknowns]);
    let cells =
        || CellSink { lifting, order: &order, edges: edges.clone(), normal: normal.clone(), kept: make(), monitor };
    Ok(search(&space, cells)?.into_iter().map(|part| part.kept).collect())
}

struct CellSink<'a, K> {
    lifting: &'a [Vec<i32>],
    order: &'a [usize],
    edges: Vec<[u32; 2]>,
    normal: Vec<i128>,
    kept: K,
    monitor: &'a Monitor,
}

impl<K: Keep> Sink for CellSink<'_, K> {
    fn take<T: Integer>(&mut self, cell: &Cell<T>) -> Result<(), Overflow> {
        self.normal.fill(0);
        for (j, (&support, &edge)) in self.order.iter().zip(&cell.pairs).enumerate() {
            self.edges[support] = edge;
            let [a, b] = edge.map(|p| i128::from(self.lifting[support][p as usize]));
            for (x, u) in self.normal.iter_mut().zip(cell.dual(j)) {
                *x = u.wide().checked_mul(b - a).and_then(|y| x.checked_add(y)).ok_or(Overflow)?;
            }
        }
        let volume = u64::try_from(cell.volume.wide()).map_err(|_| Overflow)?;
        self.kept.keep(&self.edges, volume, &self.normal);
        self.monitor.add(1, volume);
        Ok(())
    }
}

/// Supports as the search takes them: those of low degree first, which keeps the numbers of cells
/// small, each moved so that the least exponent of each unknown is zero.
pub(super) struct Ordered {
    pub(super) supports: Vec<Vec<Vec<i64>>>,
    /// The given number of each.
    order: Vec<usize>,
}

impl Ordered {
    /// `None` if a support is a single point, which has no edge.
    pub(super) fn new(unknowns: usize, supports: &[Vec<Vec<i32>>]) -> Result<Option<Ordered>, MixedError> {
        if supports.len() != unknowns || unknowns == 0 {
            return Err(MixedError::NotSquare { supports: supports.len(), unknowns });
        }
        for (i, points) in supports.iter().enumerate() {
            if let Some(point) = points.iter().find(|p| p.len() != unknowns) {
                return Err(MixedError::Length { support: i + 1, found: point.len(), unknowns });
            }
        }
        if supports.iter().any(|a| a.iter().all(|p| p == &a[0])) {
            return Ok(None);
        }
        let moved = |support: &Vec<Vec<i32>>| -> Vec<Vec<i64>> {
            let least = |l: usize| support.iter().map(|p| i64::from(p[l])).min().unwrap_or(0);
            let corner: Vec<i64> = (0..unknowns).map(least).collect();
            support.iter().map(|p| p.iter().zip(&corner).map(|(&x, c)| i64::from(x) - c).collect()).collect()
        };
        let mut all: Vec<(usize, Vec<Vec<i64>>)> = supports.iter().map(moved).enumerate().collect();
        let degree =
            |support: &[Vec<i64>]| support.iter().map(|p| p.iter().map(|&x| i128::from(x)).sum::<i128>()).max();
        all.sort_by_cached_key(|(_, support)| (degree(support), Reverse(support.len())));
        let (order, supports) = all.into_iter().unzip();
        Ok(Some(Ordered { supports, order }))
    }
}
