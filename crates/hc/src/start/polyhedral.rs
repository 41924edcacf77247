//! The polyhedral start system: generic coefficients, and all solutions for them, cell by cell.

use super::binomial::Binomials;
use super::mixed::{MixedCell, MixedError, mixed_cells};
use super::toric::Toric;
use crate::distinct::coincidences;
use crate::fibre::{Fibre, FibreOptions};
use crate::random::Random;
use crate::tracker::{PathEnd, PathSet, Tracker};
use num_complex::Complex64;
use poly::{Lanes8, SparseSystem};
use rayon::prelude::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

/// A generic system with given supports and its solutions.
pub(crate) struct Generic {
    /// The coefficients and the solutions found.
    pub(crate) fibre: Fibre,
    /// Number of solutions there are: the mixed volume.
    pub(crate) mixed_volume: u64,
    /// Tracks run again.
    pub(crate) retracked: usize,
}

/// Solves a system with generic coefficients of size about one.
pub(crate) fn generic(
    system: &SparseSystem,
    supports: &[Vec<Vec<i32>>],
    seed: u64,
    options: &FibreOptions,
) -> Result<Generic, MixedError> {
    let n = supports.len();
    let mut random = Random::new(seed, 1);
    let terms = supports.iter().map(Vec::len).sum();
    let coefficients: Vec<Complex64> = (0..terms).map(|_| random.unit() * (1.0 + 0.1 * random.unit().re)).collect();
    let cells = fine_cells(supports, &mut random)?;
    let starts: Vec<(Binomials, Vec<Complex64>, Toric, u64)> = cells
        .iter()
        .map(|(cell, weights)| {
            let (mut exponents, mut sides, mut first) = (Vec::new(), Vec::new(), 0);
            for (points, [a, b]) in supports.iter().zip(&cell.edges) {
                let edge = points[*a].iter().zip(&points[*b]);
                exponents.push(edge.map(|(&a, &b)| i128::from(a) - i128::from(b)).collect());
                sides.push(-coefficients[first + b] / coefficients[first + a]);
                first += points.len();
            }
            let binomials = Binomials::new(&exponents).ok_or(MixedError::TooLarge)?;
            Ok((binomials, sides, Toric::new(&coefficients, weights), cell.volume))
        })
        .collect::<Result<_, MixedError>>()?;

    // Roots still to be found, by cell, and those found with a label each.
    let mut wanted: Vec<Vec<u64>> = starts.iter().map(|s| (0..s.3).collect()).collect();
    let mut found: Vec<((usize, u64), Vec<Complex64>)> = Vec::new();
    let mut retracked = 0;
    for level in 0..=options.retries {
        let settings = if level == 0 { options.tracker.clone() } else { options.tracker.stricter(level) };
        let parts: Vec<PathSet> = starts
            .par_iter()
            .zip(&wanted)
            .map_init(
                || Tracker::<SparseSystem, Lanes8>::new(system, &settings),
                |tracker, ((binomials, sides, path, _), roots)| {
                    let points: Vec<Complex64> = roots.iter().flat_map(|&k| binomials.solution(sides, k)).collect();
                    let mut out = PathSet::new(n);
                    tracker.track(path, &points, 0..roots.len(), &mut out);
                    out.sort();
                    out
                },
            )
            .collect();
        for (cell, part) in parts.iter().enumerate() {
            for (result, point) in part.iter().filter(|(r, _)| r.end == PathEnd::Success) {
                found.push(((cell, wanted[cell][result.path]), point.to_vec()));
            }
        }
        found.sort_by_key(|f| f.0);
        // Two paths with one end: one of them has jumped, and it is not known which.
        let points = found.iter().enumerate().map(|(k, f)| (k, &f.1[..]));
        let jumped: Vec<usize> = coincidences(points, options.coincidence).concat();
        if level < options.retries {
            let mut keep = vec![true; found.len()];
            jumped.iter().for_each(|&k| keep[k] = false);
            let mut kept = keep.iter();
            found.retain(|_| kept.next() == Some(&true));
        }
        let mut rest = found.iter().map(|f| f.0).peekable();
        for (cell, start) in starts.iter().enumerate() {
            wanted[cell] = (0..start.3).filter(|&k| rest.next_if_eq(&(cell, k)).is_none()).collect();
        }
        let missing: usize = wanted.iter().map(Vec::len).sum();
        if missing == 0 {
            break;
        }
        retracked += if level < options.retries { missing } else { 0 };
    }
    let solutions = found.into_iter().flat_map(|f| f.1).collect();
    let mixed_volume = starts.iter().map(|s| s.3).sum();
    Ok(Generic { fibre: Fibre { parameters: coefficients, dimension: n, solutions }, mixed_volume, retracked })
}

/// Mixed cells of a random lifting, with the weight of every term; a lifting that is not generic is replaced by a larger one.
fn fine_cells(supports: &[Vec<Vec<i32>>], random: &mut Random) -> Result<Vec<(MixedCell, Vec<f64>)>, MixedError> {
    for bits in 10..28 {
        let lift = f64::from(1 << bits);
        let lifting: Vec<Vec<i32>> =
            supports.iter().map(|a| a.iter().map(|_| (random.unit().arg() * lift) as i32).collect()).collect();
        let cells = mixed_cells(supports.len(), supports, &lifting)?;
        let weighted: Option<Vec<_>> =
            cells.into_iter().map(|c| weights(supports, &lifting, &c).map(|w| (c, w))).collect();
        if let Some(weighted) = weighted {
            return Ok(weighted);
        }
    }
    Err(MixedError::TooLarge)
}

/// Height of every term above the cell; `None` if a term off the edges has height zero.
fn weights(supports: &[Vec<Vec<i32>>], lifting: &[Vec<i32>], cell: &MixedCell) -> Option<Vec<f64>> {
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
