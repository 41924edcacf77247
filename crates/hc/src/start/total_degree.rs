//! The total degree start system `g_i (x_i^(d_i) - 1)` with the degrees `d_i` and random `g_i`: as
//! many paths as Bezout's number.

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

/// The start system.
pub(crate) struct TotalDegree {
    degrees: Vec<u64>,
    parameters: Vec<Complex64>,
}

impl TotalDegree {
    /// The start system as coefficients of the supports, which must contain `x_i^(d_i)` and the origin; no
    /// degree is zero.
    pub(crate) fn new(supports: &Supports, degrees: &[u64], seed: u64, attempt: u64) -> TotalDegree {
        let mut random = Random::of(seed, Stream::TotalDegree(attempt));
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
        TotalDegree { degrees: degrees.to_vec(), parameters }
    }

    pub(crate) fn parameters(&self) -> &[Complex64] {
        &self.parameters
    }

    /// The same, to be followed by parameters that are not coefficients.
    pub(super) fn parameters_mut(&mut self) -> &mut Vec<Complex64> {
        &mut self.parameters
    }

    /// The solution with this number, which is below the number of paths: roots of unity.
    pub(crate) fn solution(&self, mut number: u64) -> Vec<Complex64> {
        let root = |&degree: &u64| {
            let k = number % degree;
            number /= degree;
            Complex64::from_polar(1.0, TAU * k as f64 / degree as f64)
        };
        self.degrees.iter().map(root).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{TotalDegree, bezout_number, degrees};
    use poly::{Evaluate, Isa, SparseSystem};

    #[test]
    fn start_solutions_solve_the_start_system() {
        let supports =
            vec![vec![vec![3, 0], vec![1, 1], vec![0, 0]], vec![vec![0, 2], vec![1, 1], vec![2, 0], vec![0, 0]]];
        let degrees = degrees(&supports).unwrap();
        assert_eq!((&degrees[..], bezout_number(&degrees)), (&[3, 2][..], Some(6)));
        let start = TotalDegree::new(&supports, &degrees, 0, 0);
        let system = SparseSystem::new(2, &supports).unwrap();
        let mut memory = system.memory(Isa::Portable);
        for k in 0..6 {
            let mut values = vec![num_complex::Complex64::default(); 2];
            system.values(&mut memory, &start.solution(k), start.parameters(), &mut values);
            assert!(values.iter().all(|v| v.norm() < 1e-14));
            for j in 0..k {
                assert_ne!(start.solution(j), start.solution(k));
            }
        }
    }
}
