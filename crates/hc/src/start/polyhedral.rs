//! The polyhedral start system: generic coefficients, and all solutions for them, from the mixed cells of a lifting.

use super::binomial::Binomials;
use super::mixed::{Keep, MixedError, watched_cells};
use super::toric::{Toric, rates};
use super::{Reached, Supports};
use crate::monitor::Monitor;
use crate::random::Random;
use crate::tracker::{PathEnd, TrackerOptions, track};
use num_complex::Complex64;
use poly::SparseSystem;

/// The mixed cells of one lifting, in eight bytes an edge and eight more. What belongs to a cell besides, its binomials, normal and
/// weights, is made when its paths start.
pub(crate) struct Polyhedral {
    supports: Vec<Vec<Vec<i32>>>,
    lifting: Vec<Vec<i32>>,
    coefficients: Vec<Complex64>,
    /// The edges of the cells, one a support, cell after cell in ascending order.
    edges: Vec<[u32; 2]>,
    /// Number of the first path of each cell.
    first: Vec<u64>,
    /// Number of solutions: the mixed volume.
    pub(crate) mixed_volume: u64,
}

/// Roots of the binomials of some cells, and the weights of the cells.
struct Starts {
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
        let mut random = Random::new(seed, 1 + 16 * attempt);
        let terms = supports.iter().map(Vec::len).sum();
        let coefficients: Vec<Complex64> = (0..terms).map(|_| random.unit() * (1.0 + 0.1 * random.unit().re)).collect();
        let (lifting, parts) = fine_cells(supports, &mut random, monitor)?;
        let n = supports.len();
        // In the order of their edges: which part holds a cell depends on the threads.
        let mut order: Vec<(u32, u32)> = Vec::new();
        for (p, part) in parts.iter().enumerate() {
            let number = |k: usize| u32::try_from(k).map_err(|_| MixedError::TooLarge);
            for k in 0..part.volumes.len() {
                order.push((number(p)?, number(k)?));
            }
        }
        let edges = |&(p, k): &(u32, u32)| &parts[p as usize].edges[k as usize * n..][..n];
        order.sort_unstable_by(|a, b| edges(a).cmp(edges(b)));
        let mut first = Vec::with_capacity(order.len());
        let mut mixed_volume = 0u64;
        for &(p, k) in &order {
            first.push(mixed_volume);
            let volume = parts[p as usize].volumes[k as usize];
            mixed_volume = mixed_volume.checked_add(volume).ok_or(MixedError::TooLarge)?;
        }
        let edges = order.iter().flat_map(edges).copied().collect();
        Ok(Polyhedral { supports: supports.to_vec(), lifting, coefficients, edges, first, mixed_volume })
    }

    pub(crate) fn parameters(&self) -> &[Complex64] {
        &self.coefficients
    }

    /// Tracks roots of the binomials, by ascending numbers, to solutions for the generic coefficients.
    pub(crate) fn solutions(&self, system: &SparseSystem, numbers: &[usize], settings: &TrackerOptions) -> Reached {
        let starts = self.starts(numbers);
        let which: Vec<usize> = (0..starts.numbers.len()).collect();
        let path = Toric { coefficients: &self.coefficients, rates: &starts.rates, cells: &starts.cells };
        let mut reached = Reached::default();
        for (result, point) in track(system, &path, &starts.points, &which, settings).iter() {
            if result.end == PathEnd::Success {
                reached.numbers.push(starts.numbers[result.path]);
                reached.points.extend_from_slice(point);
            }
        }
        reached
    }

    /// The roots with these numbers; those of a cell whose integers outgrow 127 bits are left out.
    fn starts(&self, numbers: &[usize]) -> Starts {
        let mut starts = Starts { rates: Vec::new(), cells: Vec::new(), points: Vec::new(), numbers: Vec::new() };
        let mut rest = numbers;
        let mut place = 0;
        while let Some(&number) = rest.first() {
            let k = self.first.partition_point(|&first| first <= number as u64) - 1;
            let end = self.first.get(k + 1).copied().unwrap_or(self.mixed_volume);
            let (own, others) = rest.split_at(rest.partition_point(|&number| (number as u64) < end));
            rest = others;
            let Some((binomials, sides, weights)) = self.cell(k, end - self.first[k]) else { continue };
            starts.rates.extend(rates(&weights));
            for &number in own {
                starts.numbers.push(number);
                starts.cells.push(place);
                starts.points.extend(binomials.solution(&sides, number as u64 - self.first[k]));
            }
            place += 1;
        }
        starts
    }

    /// The binomials of a cell of this volume with their right-hand sides, and its weights.
    fn cell(&self, k: usize, volume: u64) -> Option<(Binomials, Vec<Complex64>, Vec<f64>)> {
        let n = self.supports.len();
        let edges = &self.edges[k * n..(k + 1) * n];
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

/// Some of the cells of a lifting.
struct Part<'a> {
    supports: &'a Supports,
    lifting: &'a [Vec<i32>],
    found: Found,
    /// Whether no cell has further points of height zero.
    is_fine: bool,
}

/// Cells as they were found.
#[derive(Default)]
struct Found {
    edges: Vec<[u32; 2]>,
    volumes: Vec<u64>,
}

impl Keep for Part<'_> {
    fn keep(&mut self, edges: &[[u32; 2]], volume: u64, normal: &[i128]) {
        self.is_fine = self.is_fine && weights(self.supports, self.lifting, edges, volume, normal).is_some();
        self.found.edges.extend_from_slice(edges);
        self.found.volumes.push(volume);
    }
}

/// Mixed cells of a random lifting; one that is not generic is replaced by a larger one.
fn fine_cells(
    supports: &Supports,
    random: &mut Random,
    monitor: &Monitor,
) -> Result<(Vec<Vec<i32>>, Vec<Found>), MixedError> {
    for bits in 10..28 {
        let lift = f64::from(1 << bits);
        let lifting: Vec<Vec<i32>> =
            supports.iter().map(|a| a.iter().map(|_| (random.unit().arg() * lift) as i32).collect()).collect();
        let part = || Part { supports, lifting: &lifting, found: Found::default(), is_fine: true };
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
