//! Solutions that no parameter moves, and coordinates that are zero.
//!
//! Each solution that no parameter moves is an orbit of its own. On any line of parameters it moves as the trace test
//! asks for, and no loop leads to it or away from it. Searches and tests therefore leave these solutions out.

use super::fibre::{Fibre, numbers_without};
use super::reach::natural_size;
use crate::distinct::relative_distance;
use crate::random::{Random, Stream};
use crate::refine::{Refined, Refiner};
use crate::tolerances::families;
use num_complex::Complex64;
use poly::Evaluate;

/// The question whether parameters move a solution.
pub(super) struct Still<'a, E> {
    system: &'a E,
    /// Other parameters than those of the fibre.
    elsewhere: Vec<Complex64>,
}

impl<'a, E: Evaluate> Still<'a, E> {
    /// For solutions of the system for these parameters.
    pub(super) fn new(system: &'a E, parameters: &[Complex64]) -> Self {
        let random = Random::of(0, Stream::Elsewhere).normals(parameters.len());
        let moved = parameters.iter().zip(random).map(|(p, z)| p + z * natural_size(p.norm()));
        Still { system, elsewhere: moved.collect() }
    }

    /// Whether a refined solution is one for all parameters.
    pub(super) fn is(&self, x: &[Complex64]) -> bool {
        let mut refiner = Refiner::new(self.system);
        if refiner.judged(&self.elsewhere, x).residual > families::STILL_RESIDUAL {
            return false;
        }
        let there = refiner.refine(&self.elsewhere, x);
        there.accuracy < families::ACCURATE && relative_distance(&there.point, x) <= families::STILL_MOVED
    }

    /// The solutions of a fibre that parameters move, and those that none moves.
    pub(super) fn parted(&self, fibre: &Fibre) -> (Fibre, Vec<Complex64>) {
        let still: Vec<bool> = fibre.iter().map(|x| self.is(x)).collect();
        if !still.contains(&true) {
            return (fibre.clone(), Vec::new());
        }
        let of = |wanted: bool| {
            let chosen = fibre.iter().zip(&still).filter(move |(_, still)| **still == wanted);
            chosen.flat_map(|(x, _)| x.iter().copied()).collect::<Vec<_>>()
        };
        let numbers = numbers_without(&still);
        let moving = |which: &Vec<usize>| which.iter().filter_map(|&k| numbers[k]).collect();
        let representatives = fibre.representatives.as_ref().map(moving);
        let solutions = of(false);
        (Fibre { solutions, representatives, ..fibre.clone() }, of(true))
    }
}

/// Refines a point. Coordinates that are tiny become zero if the equations hold with it: Newton's method leads to ever
/// smaller numbers in their place, of which none is like another.
pub(super) fn refined<E: Evaluate>(refiner: &mut Refiner<'_, E>, p: &[Complex64], x: &[Complex64]) -> Refined {
    let size = x.iter().map(|z| z.norm()).fold(1.0, f64::max);
    let is_tiny: Vec<bool> = x.iter().map(|z| z.norm() <= families::TINY * size).collect();
    if is_tiny.contains(&true) {
        let zero = Complex64::default();
        let rounded: Vec<Complex64> = x.iter().zip(&is_tiny).map(|(&z, &tiny)| if tiny { zero } else { z }).collect();
        let refined = refiner.refine(p, &rounded);
        let stays = |((z, was), &tiny): ((&Complex64, &Complex64), &bool)| {
            if tiny { *z == zero } else { (z - was).norm() <= families::NEARBY * was.norm() }
        };
        if refined.accuracy < families::ACCURATE && refined.point.iter().zip(x).zip(&is_tiny).all(stays) {
            return refined;
        }
    }
    refiner.refine(p, x)
}
