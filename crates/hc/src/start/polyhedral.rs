//! The polyhedral start system: generic coefficients, and all solutions for them, from the mixed cells of a lifting.

use super::binomial::Binomials;
use super::mixed::{MixedCell, MixedError, watched_cells};
use super::toric::{Toric, rates};
use super::{Reached, Supports};
use crate::monitor::Monitor;
use crate::random::Random;
use crate::tracker::{PathEnd, TrackerOptions, track};
use num_complex::Complex64;
use poly::SparseSystem;

/// The mixed cells of one lifting. What belongs to a cell besides, its binomials and its weights, is made when its paths start.
pub(crate) struct Polyhedral {
    supports: Vec<Vec<Vec<i32>>>,
    lifting: Vec<Vec<i32>>,
    coefficients: Vec<Complex64>,
    cells: Vec<MixedCell>,
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
        let (lifting, cells) = fine_cells(supports, &mut random, monitor)?;
        let mut first = Vec::with_capacity(cells.len());
        let mut mixed_volume = 0u64;
        for cell in &cells {
            first.push(mixed_volume);
            mixed_volume = mixed_volume.checked_add(cell.volume).ok_or(MixedError::TooLarge)?;
        }
        Ok(Polyhedral { supports: supports.to_vec(), lifting, coefficients, cells, first, mixed_volume })
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
            let cell = &self.cells[k];
            let end = self.first[k] + cell.volume;
            let (own, others) = rest.split_at(rest.partition_point(|&number| (number as u64) < end));
            rest = others;
            let Some(weights) = weights(&self.supports, &self.lifting, cell) else { continue };
            let (mut exponents, mut sides, mut first) = (Vec::new(), Vec::new(), 0);
            for (points, [a, b]) in self.supports.iter().zip(&cell.edges) {
                let edge = points[*a].iter().zip(&points[*b]);
                exponents.push(edge.map(|(&a, &b)| i128::from(a) - i128::from(b)).collect());
                sides.push(-self.coefficients[first + b] / self.coefficients[first + a]);
                first += points.len();
            }
            let Some(binomials) = Binomials::new(&exponents) else { continue };
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
}

/// A lifting and its mixed cells.
type Lifted = (Vec<Vec<i32>>, Vec<MixedCell>);

/// Mixed cells of a random lifting; one that is not generic is replaced by a larger one.
fn fine_cells(supports: &Supports, random: &mut Random, monitor: &Monitor) -> Result<Lifted, MixedError> {
    for bits in 10..28 {
        let lift = f64::from(1 << bits);
        let lifting: Vec<Vec<i32>> =
            supports.iter().map(|a| a.iter().map(|_| (random.unit().arg() * lift) as i32).collect()).collect();
        let cells = watched_cells(supports.len(), supports, &lifting, monitor)?;
        if cells.iter().all(|cell| weights(supports, &lifting, cell).is_some()) {
            return Ok((lifting, cells));
        }
    }
    Err(MixedError::TooLarge)
}

/// Height of every term above the cell; `None` if a term off the edges has height zero.
fn weights(supports: &Supports, lifting: &[Vec<i32>], cell: &MixedCell) -> Option<Vec<f64>> {
    let volume = i128::from(cell.volume);
    let mut weights = Vec::new();
    for ((points, lifts), edge) in supports.iter().zip(lifting).zip(&cell.edges) {
        let height = |p: usize| {
            let slopes = points[p].iter().zip(&cell.normal).map(|(&x, g)| i128::from(x).checked_mul(*g));
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
