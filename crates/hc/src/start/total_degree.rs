//! The total degree start system `g_i (x_i^(d_i) - 1)`, `d_i` the degrees and `g_i` random: as many paths as Bezout's number.

use super::{Generic, Supports};
use crate::fibre::Fibre;
use crate::random::Random;
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

/// The start system in coefficients of the supports, which must contain `x_i^(d_i)` and the origin; the degrees are not zero
/// and their product is small enough to hold that many solutions.
pub(crate) fn total_degree(supports: &Supports, degrees: &[u64], seed: u64, attempt: u64) -> Generic {
    let mut random = Random::new(seed, 2 + 16 * attempt);
    let mut parameters = Vec::new();
    for (i, (points, &degree)) in supports.iter().zip(degrees).enumerate() {
        let factor = random.unit();
        parameters.extend(points.iter().map(|p| {
            let others_vanish = p.iter().enumerate().all(|(j, &e)| j == i || e == 0);
            match p[i] {
                0 if others_vanish => -factor,
                e if others_vanish && u64::try_from(e) == Ok(degree) => factor,
                _ => Complex64::new(0.0, 0.0),
            }
        }));
    }
    let paths = degrees.iter().product();
    let mut solutions = Vec::new();
    for number in 0..paths {
        let mut rest = number;
        for &degree in degrees {
            solutions.push(Complex64::from_polar(1.0, TAU * (rest % degree) as f64 / degree as f64));
            rest /= degree;
        }
    }
    Generic { fibre: Fibre { parameters, dimension: supports.len(), solutions }, paths, retracked: 0 }
}

#[cfg(test)]
mod tests {
    use super::{bezout_number, degrees, total_degree};
    use poly::{Evaluate, Isa, SparseSystem};

    #[test]
    fn start_solutions_solve_the_start_system() {
        let supports =
            vec![vec![vec![3, 0], vec![1, 1], vec![0, 0]], vec![vec![0, 2], vec![1, 1], vec![2, 0], vec![0, 0]]];
        let degrees = degrees(&supports).unwrap();
        assert_eq!((&degrees[..], bezout_number(&degrees)), (&[3, 2][..], Some(6)));
        let start = total_degree(&supports, &degrees, 0, 0);
        let system = SparseSystem::new(2, &supports).unwrap();
        let mut memory = system.memory(Isa::Portable);
        for k in 0..6 {
            let mut values = vec![num_complex::Complex64::default(); 2];
            system.values(&mut memory, start.fibre.solution(k), &start.fibre.parameters, &mut values);
            assert!(values.iter().all(|v| v.norm() < 1e-14));
            for j in 0..k {
                assert_ne!(start.fibre.solution(j), start.fibre.solution(k));
            }
        }
    }
}
