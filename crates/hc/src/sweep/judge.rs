//! From all solutions for the parameters of a cell to what the cell shows.

use super::cell::{Cell, Doubt, RealSolution, Standing};
use super::conjugates::reality;
use crate::certify::{Certificates, Reality};
use crate::solve::{Solution, Solutions};
use crate::tolerances::sweeps;
use num_complex::Complex64;

/// The cell of these solutions, to which the `count` solutions of a fibre have led; certified if that is asked for, or
/// the solutions do not show otherwise which of them are real.
pub(super) fn judged(mut found: Solutions, count: usize, certify: bool) -> Cell {
    if found.interrupted {
        return Cell::default();
    }
    let (at_infinity, doubt) = (found.paths.at_infinity, doubt(&found, count));
    let is_multiple = |s: &Solution| s.multiplicity > 1;
    let multiple = found.iter().any(is_multiple);
    let singular = found.iter().any(|s| s.singular && !is_multiple(s));
    let pairs = reality(&found.iter().map(|s| s.value.as_slice()).collect::<Vec<_>>());
    let unclear = pairs.as_ref().err().copied();
    let (mut standing, mut real) = (Standing::Counted, pairs.unwrap_or_default());
    if doubt.is_none() && (certify || singular || unclear.is_some()) {
        let certificates = found.certify();
        match certificates.ok().and_then(|proved| proved_real(&found, &proved)) {
            Some(proved) => (standing, real) = (Standing::Certified, proved),
            None => standing = Standing::Doubtful(Doubt::Unclear { solutions: unclear.unwrap_or(found.len()) }),
        }
    }
    if multiple && standing.is_shown() {
        standing = Standing::Multiple;
    }
    if let Some(doubt) = doubt {
        standing = Standing::Doubtful(doubt);
    }
    if real.len() != found.len() {
        real = found.iter().map(|s| s.is_real).collect();
    }
    let listed = found.iter().zip(&real).filter(|(_, real)| **real).map(|(s, _)| s);
    let solutions = sorted(listed.map(|s| real_solution(&s.value, s.multiplicity, s.condition)));
    Cell { complex: found.len() - solutions.len(), standing, solutions, at_infinity }
}

/// Why the number of solutions is not shown, if it is not.
fn doubt(found: &Solutions, count: usize) -> Option<Doubt> {
    let paths = &found.paths;
    if paths.failed > 0 {
        return Some(Doubt::Lost { paths: paths.failed });
    }
    if found.on_components > 0 {
        return Some(Doubt::Component { paths: found.on_components });
    }
    // Of a family with symmetries one path of each orbit may have been tracked; if paths went to infinity, all orbits
    // have one size.
    let orbit = if paths.tracked > 0 && paths.tracked < count { count / paths.tracked } else { 1 };
    let ends: usize = found.iter().map(|s| s.multiplicity).sum();
    let sum = ends.saturating_add(paths.at_infinity.saturating_mul(orbit));
    (sum != count).then_some(Doubt::Sum { found: sum, fibre: count })
}

/// Which solutions are real, if that is proved of all regular ones, and that they are distinct.
fn proved_real(found: &Solutions, proved: &Certificates) -> Option<Vec<bool>> {
    let mut real = Vec::with_capacity(found.len());
    for (solution, proof) in found.iter().zip(&proved.points) {
        let is_real = match proof.as_ref().ok().filter(|_| solution.certified == Some(true)) {
            Some(proof) => match proof.reality {
                Reality::Real => true,
                Reality::NotReal => false,
                Reality::Undecided => return None,
            },
            None if solution.multiplicity > 1 => solution.is_real,
            None => return None,
        };
        real.push(is_real);
    }
    Some(real)
}

/// A solution that is real.
pub(super) fn real_solution(point: &[Complex64], multiplicity: usize, condition: f64) -> RealSolution {
    let value: Vec<f64> = point.iter().map(|z| z.re).collect();
    let largest = value.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let digits = if multiplicity > 1 { sweeps::BLURRED } else { sweeps::ROUNDING * condition.max(1.0) };
    // Written so that a condition that is not known makes nothing positive.
    let positive = value.iter().all(|&x| x > digits * largest);
    RealSolution { value, multiplicity, positive, branch: None }
}

/// In ascending order of their coordinates.
pub(super) fn sorted(solutions: impl Iterator<Item = RealSolution>) -> Vec<RealSolution> {
    let mut solutions: Vec<RealSolution> = solutions.collect();
    solutions.sort_by(|a, b| {
        let orders = a.value.iter().zip(&b.value).map(|(a, b)| a.total_cmp(b));
        orders.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
    });
    solutions
}
