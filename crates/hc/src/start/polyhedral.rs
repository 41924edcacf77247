//! The polyhedral start system: generic coefficients, and all solutions for them, from the mixed
//! cells of a lifting.

use super::binomial::Binomials;
use super::path_system::PathSystem;
use super::reached::{StartSolutions, Supports};
use super::toric::{Toric, rates};
use crate::mixed::{Keep, MixedError, watched_cells};
use crate::monitor::Monitor;
use crate::random::{Random, Stream};
use crate::store::{Records, Sorter};
use crate::tracker::{PathEnd, TrackerOptions, Trackers};
use num_complex::Complex64;
use std::sync::{Mutex, PoisonError};

/// The mixed cells of one lifting, each with its edges and the number of its first path. The binomials,
/// normal and weights of a cell are made when its paths start.
pub(crate) struct Polyhedral {
    supports: Vec<Vec<Vec<i32>>>,
    lifting: Vec<Vec<i32>>,
    /// The coefficients, to which parameters of another kind may be appended.
    pub(super) coefficients: Vec<Complex64>,
    cells: Mutex<StoredCells>,
    /// Number of solutions: the mixed volume.
    pub(crate) mixed_volume: u64,
}

/// Cells in ascending order of their edges: the edges, one per support, then the number of the
/// first path.
struct StoredCells {
    records: Records,
    count: usize,
    /// The number of the first path of each block of records.
    heads: Vec<u64>,
}

/// A cell as it is stored.
struct StoredCell {
    /// The place of the cell among all.
    place: usize,
    edges: Vec<[u32; 2]>,
    /// The number of the first path of the cell.
    first: u64,
}

/// Roots of the binomials of some cells, and the weights of the cells.
struct CellStarts {
    rates: Vec<f64>,
    /// The cell of each root, by its place in `rates`.
    cells: Vec<usize>,
    points: Vec<Complex64>,
    numbers: Vec<usize>,
}

impl Polyhedral {
    /// Finds the cells; every attempt of one seed has its own lifting and coefficients.
    pub(crate) fn new(
        supports: &Supports,
        seed: u64,
        attempt: u64,
        monitor: &Monitor,
    ) -> Result<Polyhedral, MixedError> {
        let mut random = Random::of(seed, Stream::Polyhedral(attempt));
        let terms = supports.iter().map(Vec::len).sum();
        let coefficients: Vec<Complex64> = (0..terms).map(|_| random.unit() * (1.0 + 0.1 * random.unit().re)).collect();
        let (lifting, parts) = fine_cells(supports, &mut random, monitor)?;
        // In the order of their edges: which sorter has a cell depends on the threads.
        let mut sorted = Sorter::merged(parts).map_err(|_| MixedError::Storage)?;
        let width = 8 * supports.len() + 8;
        let mut cells = StoredCells { records: Records::new(width), count: 0, heads: Vec::new() };
        let mut mixed_volume = 0u64;
        while let Some(mut record) = sorted.next().map_err(|_| MixedError::Storage)? {
            if cells.count.is_multiple_of(cells.records.per_block()) {
                cells.heads.push(mixed_volume);
            }
            let volume = record[width - 8..].iter().fold(0, |volume, &byte| volume << 8 | u64::from(byte));
            record[width - 8..].copy_from_slice(&mixed_volume.to_be_bytes());
            cells.records.set(cells.count, &record);
            cells.count += 1;
            mixed_volume = mixed_volume.checked_add(volume).ok_or(MixedError::TooLarge)?;
        }
        let cells = Mutex::new(cells);
        Ok(Polyhedral { supports: supports.to_vec(), lifting, coefficients, cells, mixed_volume })
    }

    /// Tracks roots of the binomials, in ascending order of their numbers, to solutions for the generic
    /// coefficients.
    pub(crate) fn solutions(
        &self,
        trackers: &Trackers<'_, PathSystem>,
        numbers: &[usize],
        settings: &TrackerOptions,
        monitor: &Monitor,
    ) -> StartSolutions {
        let starts = self.starts(numbers);
        let which: Vec<usize> = (0..starts.numbers.len()).collect();
        let path = Toric { coefficients: &self.coefficients, rates: &starts.rates, cells: &starts.cells };
        let mut reached = StartSolutions::default();
        let ends = trackers.track(&path, &starts.points, &which, settings, monitor);
        for (result, point) in ends.iter() {
            if result.end == PathEnd::Success {
                reached.numbers.push(starts.numbers[result.path]);
                reached.points.extend_from_slice(point);
            }
        }
        reached
    }

    /// The roots with these numbers; those of a cell whose integers outgrow 127 bits, or that
    /// cannot be read, are left out.
    fn starts(&self, numbers: &[usize]) -> CellStarts {
        let mut starts = CellStarts { rates: Vec::new(), cells: Vec::new(), points: Vec::new(), numbers: Vec::new() };
        let mut cells = self.cells.lock().unwrap_or_else(PoisonError::into_inner);
        let mut rest = numbers;
        let mut place = 0;
        while let Some(&number) = rest.first() {
            let Some(cell) = cells.with(number as u64) else { break };
            let end = cells.first(cell.place + 1).unwrap_or(self.mixed_volume);
            let (own, others) = rest.split_at(rest.partition_point(|&number| (number as u64) < end).max(1));
            rest = others;
            let volume = end.checked_sub(cell.first).filter(|&volume| volume > 0);
            let Some((binomials, sides, weights)) = volume.and_then(|v| self.cell(&cell.edges, v)) else { continue };
            starts.rates.extend(rates(&weights));
            // Parameters that are not coefficients stay as they are.
            starts.rates.resize((place + 1) * self.coefficients.len(), 0.0);
            for &number in own {
                starts.numbers.push(number);
                starts.cells.push(place);
                starts.points.extend(binomials.solution(&sides, number as u64 - cell.first));
            }
            place += 1;
        }
        starts
    }

    /// The binomials of a cell of this volume with their right-hand sides, and its weights.
    fn cell(&self, edges: &[[u32; 2]], volume: u64) -> Option<(Binomials, Vec<Complex64>, Vec<f64>)> {
        let (mut exponents, mut sides, mut slopes, mut first) = (Vec::new(), Vec::new(), Vec::new(), 0);
        for ((points, lifts), edge) in self.supports.iter().zip(&self.lifting).zip(edges) {
            let [a, b] = edge.map(|p| p as usize);
            let difference = points[a].iter().zip(&points[b]);
            exponents.push(difference.map(|(&a, &b)| i128::from(a) - i128::from(b)).collect());
            sides.push(-self.coefficients[first + b] / self.coefficients[first + a]);
            slopes.push((i128::from(lifts[b]) - i128::from(lifts[a])).checked_mul(volume.into())?);
            first += points.len();
        }
        let binomials = Binomials::new(&exponents)?;
        let normal = binomials.integers(&slopes)?;
        let weights = weights(&self.supports, &self.lifting, edges, volume, &normal)?;
        Some((binomials, sides, weights))
    }
}

impl StoredCells {
    /// The edges and the number of the first path of a cell, in bytes.
    fn get(&mut self, place: usize) -> Option<(&[u8], u64)> {
        let record = (place < self.count).then(|| self.records.get(place))?;
        let (edges, first) = record.split_last_chunk::<8>()?;
        Some((edges, u64::from_be_bytes(*first)))
    }

    fn first(&mut self, place: usize) -> Option<u64> {
        Some(self.get(place)?.1)
    }

    /// The cell of a path.
    fn with(&mut self, path: u64) -> Option<StoredCell> {
        let block = self.heads.partition_point(|&head| head <= path).checked_sub(1)?;
        let (mut low, mut high) = (block * self.records.per_block(), (block + 1) * self.records.per_block());
        high = high.min(self.count);
        // The last cell that begins at the path or before.
        while high - low > 1 {
            let middle = low.midpoint(high);
            if self.first(middle)? <= path { low = middle } else { high = middle }
        }
        let (edges, first) = self.get(low)?;
        let edges =
            edges.as_chunks::<4>().0.as_chunks::<2>().0.iter().map(|edge| edge.map(u32::from_be_bytes)).collect();
        Some(StoredCell { place: low, edges, first })
    }
}

/// Some of the cells of a lifting.
struct FoundCells<'a> {
    supports: &'a Supports,
    lifting: &'a [Vec<i32>],
    /// Edges and volumes.
    found: Sorter,
    /// Whether no cell has further points of height zero.
    is_fine: bool,
}

impl Keep for FoundCells<'_> {
    fn keep(&mut self, edges: &[[u32; 2]], volume: u64, normal: &[i128]) {
        self.is_fine = self.is_fine && weights(self.supports, self.lifting, edges, volume, normal).is_some();
        let edges = edges.as_flattened().iter().flat_map(|p| p.to_be_bytes());
        self.found.push(&edges.chain(volume.to_be_bytes()).collect::<Vec<u8>>());
    }
}

/// Mixed cells of a random lifting; one that is not generic is replaced by a larger one.
fn fine_cells(
    supports: &Supports,
    random: &mut Random,
    monitor: &Monitor,
) -> Result<(Vec<Vec<i32>>, Vec<Sorter>), MixedError> {
    for bits in 10..28 {
        let lift = f64::from(1 << bits);
        let lifting: Vec<Vec<i32>> =
            supports.iter().map(|a| a.iter().map(|_| (random.unit().arg() * lift) as i32).collect()).collect();
        let found = || Sorter::new(8 * supports.len() + 8);
        let part = || FoundCells { supports, lifting: &lifting, found: found(), is_fine: true };
        let parts = watched_cells(supports.len(), supports, &lifting, monitor, part)?;
        if parts.iter().all(|part| part.is_fine) {
            let found = parts.into_iter().map(|part| part.found).collect();
            return Ok((lifting, found));
        }
    }
    Err(MixedError::TooLarge)
}

/// Height of every term above the cell; `None` if a term off the edges has height zero.
fn weights(
    supports: &Supports,
    lifting: &[Vec<i32>],
    edges: &[[u32; 2]],
    volume: u64,
    normal: &[i128],
) -> Option<Vec<f64>> {
    let volume = i128::from(volume);
    let mut weights = Vec::new();
    for ((points, lifts), edge) in supports.iter().zip(lifting).zip(edges) {
        let edge = edge.map(|p| p as usize);
        let height = |p: usize| {
            let slopes = points[p].iter().zip(normal).map(|(&x, g)| i128::from(x).checked_mul(*g));
            slopes.into_iter().try_fold(i128::from(lifts[p]).checked_mul(volume)?, |sum, s| sum.checked_add(s?))
        };
        let least = height(edge[0])?;
        for p in 0..points.len() {
            let above = height(p)?.checked_sub(least)?;
            if above == 0 && !edge.contains(&p) {
                return None;
            }
            weights.push(above as f64 / volume as f64);
        }
    }
    Some(weights)
}
