//! The polyhedral start system: generic coefficients, and all solutions for them, from the mixed cells of a lifting.

use super::binomial::Binomials;
use super::mixed::{MixedCell, MixedError, watched_cells};
use super::toric::{Toric, rates};
use super::{Generic, Supports};
use crate::distinct::coincidences;
use crate::fibre::{Fibre, FibreOptions};
use crate::monitor::{Monitor, Stage};
use crate::random::Random;
use crate::tracker::{PathEnd, TrackerOptions, track};
use num_complex::Complex64;
use poly::SparseSystem;

/// The mixed cells of one lifting, ready to be solved for generic coefficients of size about one.
pub(crate) struct Polyhedral {
    coefficients: Vec<Complex64>,
    cells: Vec<Cell>,
    /// Rates of every term, cell after cell.
    rates: Vec<f64>,
    /// Number of solutions: the mixed volume.
    pub(crate) mixed_volume: u64,
}

/// The binomials of a mixed cell.
struct Cell {
    binomials: Binomials,
    sides: Vec<Complex64>,
    volume: u64,
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
        let mut all_rates = Vec::new();
        let mut cells = Vec::new();
        for (cell, weights) in fine_cells(supports, &mut random, monitor)? {
            let (mut exponents, mut sides, mut first) = (Vec::new(), Vec::new(), 0);
            for (points, [a, b]) in supports.iter().zip(&cell.edges) {
                let edge = points[*a].iter().zip(&points[*b]);
                exponents.push(edge.map(|(&a, &b)| i128::from(a) - i128::from(b)).collect());
                sides.push(-coefficients[first + b] / coefficients[first + a]);
                first += points.len();
            }
            let binomials = Binomials::new(&exponents).ok_or(MixedError::TooLarge)?;
            all_rates.extend(rates(&weights));
            cells.push(Cell { binomials, sides, volume: cell.volume });
        }
        let mixed_volume =
            cells.iter().try_fold(0u64, |sum, c| sum.checked_add(c.volume)).ok_or(MixedError::TooLarge)?;
        Ok(Polyhedral { coefficients, cells, rates: all_rates, mixed_volume })
    }

    /// Tracks the roots of the binomials to solutions for the generic coefficients.
    pub(crate) fn solve(self, system: &SparseSystem, options: &FibreOptions) -> Generic {
        // Roots still to be found, as cell and number, and those found.
        let mut wanted: Vec<(usize, u64)> =
            self.cells.iter().enumerate().flat_map(|(c, cell)| (0..cell.volume).map(move |k| (c, k))).collect();
        let mut found: Vec<((usize, u64), Vec<Complex64>)> = Vec::new();
        let mut retracked = 0;
        let monitor = &options.tracker.monitor;
        for level in 0..=options.retries {
            monitor.enter(Stage::Start, wanted.len() as u64);
            let settings = if level == 0 { options.tracker.clone() } else { options.tracker.stricter(level) };
            let mut missing = Vec::new();
            for roots in wanted.chunks(CHUNK) {
                self.track(system, roots, &settings, &mut found, &mut missing);
            }
            found.sort_by_key(|f| f.0);
            // Two paths with one end: one of them has jumped, and it is not known which.
            let points = found.iter().enumerate().map(|(k, f)| (k, &f.1[..]));
            let jumped: Vec<usize> = coincidences(points, options.coincidence).concat();
            if level < options.retries {
                let mut keep = vec![true; found.len()];
                jumped.iter().for_each(|&k| keep[k] = false);
                missing.extend(jumped.iter().map(|&k| found[k].0));
                let mut kept = keep.iter();
                found.retain(|_| kept.next() == Some(&true));
            }
            missing.sort_unstable();
            wanted = missing;
            if wanted.is_empty() || level == options.retries || monitor.is_cancelled() {
                break;
            }
            retracked += wanted.len();
        }
        let solutions = found.into_iter().flat_map(|f| f.1).collect();
        let dimension = self.cells.first().map_or(0, |cell| cell.sides.len());
        let fibre = Fibre { parameters: self.coefficients, dimension, solutions };
        Generic { fibre, paths: self.mixed_volume, retracked }
    }

    fn track(
        &self,
        system: &SparseSystem,
        roots: &[(usize, u64)],
        settings: &TrackerOptions,
        found: &mut Vec<((usize, u64), Vec<Complex64>)>,
        missing: &mut Vec<(usize, u64)>,
    ) {
        let starts: Vec<Complex64> = roots
            .iter()
            .flat_map(|&(cell, k)| self.cells[cell].binomials.solution(&self.cells[cell].sides, k))
            .collect();
        let cells: Vec<usize> = roots.iter().map(|root| root.0).collect();
        let which: Vec<usize> = (0..roots.len()).collect();
        let path = Toric { coefficients: &self.coefficients, rates: &self.rates, cells: &cells };
        for (result, point) in track(system, &path, &starts, &which, settings).iter() {
            match result.end {
                PathEnd::Success => found.push((roots[result.path], point.to_vec())),
                _ => missing.push(roots[result.path]),
            }
        }
    }
}

/// Roots of binomials that are made at a time.
const CHUNK: usize = 1 << 13;

/// Mixed cells of a random lifting, with the weight of every term; a lifting that is not generic is replaced by a larger one.
fn fine_cells(
    supports: &Supports,
    random: &mut Random,
    monitor: &Monitor,
) -> Result<Vec<(MixedCell, Vec<f64>)>, MixedError> {
    for bits in 10..28 {
        let lift = f64::from(1 << bits);
        let lifting: Vec<Vec<i32>> =
            supports.iter().map(|a| a.iter().map(|_| (random.unit().arg() * lift) as i32).collect()).collect();
        let cells = watched_cells(supports.len(), supports, &lifting, monitor)?;
        let weighted: Option<Vec<_>> =
            cells.into_iter().map(|c| weights(supports, &lifting, &c).map(|w| (c, w))).collect();
        if let Some(weighted) = weighted {
            return Ok(weighted);
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
