//! The total degree start system `g_i (x_j^(d_i) - 1)` with the degrees `d_i` and random `g_i`, where
//! `j` runs through the unknowns as `i` does through the equations: as many paths as Bezout's number.

use super::reached::Supports;
use crate::random::{Random, Stream};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Degree of each support; `None` if an exponent is negative.
pub(crate) fn degrees(supports: &Supports) -> Option<Vec<u64>> {
    let degree = |points: &Vec<Vec<i32>>| {
        let sums = points.iter().map(|p| p.iter().map(|&e| u64::try_from(e).ok()).sum::<Option<u64>>());
        sums.collect::<Option<Vec<u64>>>()?.into_iter().max()
    };
    supports.iter().map(degree).collect()
}

/// Product of the degrees, `None` if it does not fit.
pub(crate) fn bezout_number(degrees: &[u64]) -> Option<u64> {
    degrees.iter().try_fold(1u64, |product, &d| product.checked_mul(d))
}

/// An unknown for each equation, so that all the powers `x_j^(d_i)` are terms of the equations already, by a
/// matching; `None` if there is none. Paths are short from there, where powers that are no terms may outgrow
/// all others.
pub(crate) fn leading_unknowns(supports: &Supports, degrees: &[u64]) -> Option<Vec<usize>> {
    let powers: Vec<Vec<usize>> =
        supports.iter().zip(degrees).enumerate().map(|(i, (points, &degree))| powers(points, degree, i)).collect();
    let mut owners = vec![None; supports.len()];
    let all = (0..supports.len()).all(|i| is_matched(i, &powers, &mut owners, &mut vec![false; supports.len()]));
    let mut unknowns = vec![0; supports.len()];
    owners.iter().enumerate().filter_map(|(j, i)| Some((j, (*i)?))).for_each(|(j, i)| unknowns[i] = j);
    all.then_some(unknowns)
}

/// The unknowns whose powers of this degree are points of a support, ascending, but `first` before others.
fn powers(points: &[Vec<i32>], degree: u64, first: usize) -> Vec<usize> {
    let power = |p: &Vec<i32>| {
        let mut nonzero = p.iter().enumerate().filter(|(_, e)| **e != 0);
        let (unknown, &exponent) = nonzero.next()?;
        (nonzero.next().is_none() && u64::try_from(exponent) == Ok(degree)).then_some(unknown)
    };
    let mut unknowns: Vec<usize> = points.iter().filter_map(power).collect();
    unknowns.sort_by_key(|&unknown| (unknown != first, unknown));
    unknowns
}

/// Gives an equation one of its unknowns along an augmenting path, if there is one (Kuhn 1955).
fn is_matched(i: usize, powers: &[Vec<usize>], owners: &mut [Option<usize>], seen: &mut [bool]) -> bool {
    for &j in &powers[i] {
        if !seen[j] {
            seen[j] = true;
            if owners[j].is_none_or(|other| is_matched(other, powers, owners, seen)) {
                owners[j] = Some(i);
                return true;
            }
        }
    }
    false
}

/// The start system.
pub(crate) struct TotalDegree {
    /// The unknown and the degree of each equation.
    powers: Vec<(usize, u64)>,
    /// The coefficients, to which parameters of another kind may be appended.
    pub(super) parameters: Vec<Complex64>,
}

impl TotalDegree {
    /// The start system as coefficients of the supports, which must contain the origin and the powers
    /// `x_j^(d_i)`, with the degrees `d_i` and an unknown `j` for each equation; no degree is zero.
    pub(crate) fn new(
        supports: &Supports,
        degrees: &[u64],
        unknowns: &[usize],
        seed: u64,
        attempt: u64,
    ) -> TotalDegree {
        let mut random = Random::of(seed, Stream::TotalDegree(attempt));
        let mut parameters = Vec::new();
        let powers: Vec<(usize, u64)> = unknowns.iter().copied().zip(degrees.iter().copied()).collect();
        for (points, &(unknown, degree)) in supports.iter().zip(&powers) {
            let factor = random.unit();
            parameters.extend(points.iter().map(|p| {
                let others_vanish = p.iter().enumerate().all(|(j, &e)| j == unknown || e == 0);
                match p[unknown] {
                    0 if others_vanish => -factor,
                    e if others_vanish && u64::try_from(e) == Ok(degree) => factor,
                    _ => Complex64::new(0.0, 0.0),
                }
            }));
        }
        TotalDegree { powers, parameters }
    }

    /// The solution with this number, which is below the number of paths: roots of unity.
    pub(crate) fn solution(&self, mut number: u64) -> Vec<Complex64> {
        let mut solution = vec![Complex64::new(1.0, 0.0); self.powers.len()];
        for &(unknown, degree) in &self.powers {
            solution[unknown] = Complex64::from_polar(1.0, TAU * (number % degree) as f64 / degree as f64);
            number /= degree;
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::{TotalDegree, bezout_number, degrees, leading_unknowns};
    use poly::{Evaluate, Isa, SparseSystem};

    #[test]
    fn start_solutions_solve_the_start_system() {
        let supports =
            vec![vec![vec![3, 0], vec![1, 1], vec![0, 0]], vec![vec![0, 2], vec![1, 1], vec![2, 0], vec![0, 0]]];
        let degrees = degrees(&supports).unwrap();
        assert_eq!((&degrees[..], bezout_number(&degrees)), (&[3, 2][..], Some(6)));
        let start = TotalDegree::new(&supports, &degrees, &[0, 1], 0, 0);
        let system = SparseSystem::new(2, &supports).unwrap();
        let mut memory = system.memory(Isa::Portable);
        for k in 0..6 {
            let mut values = vec![num_complex::Complex64::default(); 2];
            system.values(&mut memory, &start.solution(k), &start.parameters, &mut values);
            assert!(values.iter().all(|v| v.norm() < 1e-14));
            for j in 0..k {
                assert_ne!(start.solution(j), start.solution(k));
            }
        }
    }

    #[test]
    fn powers_of_the_equations_lead() {
        let leading = |terms: [&[[i32; 3]]; 3]| {
            let supports: Vec<Vec<Vec<i32>>> =
                terms.iter().map(|terms| terms.iter().map(|t| t.to_vec()).collect()).collect();
            leading_unknowns(&supports, &degrees(&supports).unwrap())
        };
        // z^5 - 1, x - y^2, z - x - y: the last one can have any unknown.
        let z = [[0, 0, 5], [0, 0, 0]];
        assert_eq!(leading([&z, &[[1, 0, 0], [0, 2, 0]], &[[0, 0, 1], [1, 0, 0], [0, 1, 0]]]), Some(vec![2, 1, 0]));
        // An augmenting path: x^2 + y^2, x^2 - y, z^3 + x^3.
        assert_eq!(
            leading([&[[2, 0, 0], [0, 2, 0]], &[[2, 0, 0], [0, 1, 0]], &[[0, 0, 3], [3, 0, 0]]]),
            Some(vec![1, 0, 2])
        );
        // None has a power.
        assert_eq!(leading([&[[1, 1, 0]], &[[0, 1, 1]], &[[1, 0, 1]]]), None);
    }
}
