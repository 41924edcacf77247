//! Binomial systems `x^(m_i) = b_i`, `i = 1..n`, by Hermite normal form (Kannan & Bachem 1979).

use num_complex::Complex64;
use std::f64::consts::TAU;

/// A system of binomials with nonzero determinant; its `|det|` solutions are made one by one.
#[derive(Clone, Debug)]
pub(crate) struct Binomials {
    /// Lower triangular with positive diagonal: the exponents times `transform`, by rows.
    hermite: Vec<Vec<i128>>,
    /// Unimodular, by rows.
    transform: Vec<Vec<i128>>,
}

impl Binomials {
    /// The system with these exponents, by rows; `None` if the determinant is zero or integers outgrow 127
    /// bits.
    pub(crate) fn new(exponents: &[Vec<i128>]) -> Option<Self> {
        let n = exponents.len();
        let mut h = exponents.to_vec();
        let mut u: Vec<Vec<i128>> = (0..n).map(|i| (0..n).map(|j| i128::from(i == j)).collect()).collect();
        for i in 0..n {
            // Euclid's algorithm on the columns from i on leaves one entry in row i.
            while (i + 1..n).any(|j| h[i][j] != 0) || h[i][i] == 0 {
                let least = (i..n).filter(|&j| h[i][j] != 0).min_by_key(|&j| h[i][j].unsigned_abs())?;
                for row in h.iter_mut().chain(&mut u) {
                    row.swap(i, least);
                }
                for j in i + 1..n {
                    let quotient = h[i][j].checked_div(h[i][i])?;
                    for row in h.iter_mut().chain(&mut u) {
                        row[j] = row[j].checked_sub(quotient.checked_mul(row[i])?)?;
                    }
                }
            }
            if h[i][i] < 0 {
                for row in h.iter_mut().chain(&mut u) {
                    row[i] = -row[i];
                }
            }
            for j in 0..i {
                let quotient = h[i][j].div_euclid(h[i][i]);
                for row in h.iter_mut().chain(&mut u) {
                    row[j] = row[j].checked_sub(quotient.checked_mul(row[i])?)?;
                }
            }
        }
        Some(Binomials { hermite: h, transform: u })
    }

    /// The integers `x` with `<m_i, x> = sides[i]` for the exponents `m_i`; `None` if there are
    /// none, or integers outgrow 127 bits.
    pub(crate) fn integers(&self, sides: &[i128]) -> Option<Vec<i128>> {
        let sum = |row: &[i128], y: &[i128]| {
            row.iter().zip(y).try_fold(0i128, |sum, (a, y)| sum.checked_add(a.checked_mul(*y)?))
        };
        // With x = transform y it is triangular.
        let mut y: Vec<i128> = Vec::with_capacity(sides.len());
        for (i, (row, side)) in self.hermite.iter().zip(sides).enumerate() {
            let rest = side.checked_sub(sum(&row[..i], &y)?)?;
            if rest % row[i] != 0 {
                return None;
            }
            y.push(rest / row[i]);
        }
        self.transform.iter().map(|row| sum(row, &y)).collect()
    }

    /// The `k`-th solution for the right-hand sides `b`, none of which is zero; `k` is below the
    /// determinant.
    pub(crate) fn solution(&self, b: &[Complex64], mut k: u64) -> Vec<Complex64> {
        let n = b.len();
        // Logarithms of moduli, and angles in turns, of y with x = y^transform.
        let mut y: Vec<(f64, f64)> = Vec::with_capacity(n);
        for i in 0..n {
            let (mut size, mut turns) = (b[i].norm().ln(), b[i].arg() / TAU);
            for (j, &(s, t)) in y.iter().enumerate() {
                let e = self.hermite[i][j] as f64;
                size -= e * s;
                turns = (turns - e * t).rem_euclid(1.0);
            }
            let d = self.hermite[i][i];
            let root = i128::from(k) % d;
            k = (i128::from(k) / d) as u64;
            y.push((size / d as f64, (turns + root as f64) / d as f64));
        }
        let coordinate = |row: &Vec<i128>| {
            let size: f64 = row.iter().zip(&y).map(|(&e, y)| e as f64 * y.0).sum();
            let turns = row.iter().zip(&y).fold(0.0, |sum: f64, (&e, y)| (sum + e as f64 * y.1).rem_euclid(1.0));
            Complex64::from_polar(size.exp(), TAU * turns)
        };
        self.transform.iter().map(coordinate).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Binomials;
    use crate::random::{Random, Stream};
    use proptest::prelude::{prop, prop_assert, prop_assert_eq, proptest};

    proptest! {
        #[test]
        fn integers_with_given_products(m in prop::collection::vec(-9i128..=9, 16), x in prop::collection::vec(-99i128..=99, 4)) {
            let m: Vec<Vec<i128>> = m.chunks(4).map(<[i128]>::to_vec).collect();
            let Some(binomials) = Binomials::new(&m) else { return Ok(()) };
            let sides: Vec<i128> = m.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
            prop_assert_eq!(binomials.integers(&sides), Some(x));
            // Products with even numbers are even.
            let doubled: Vec<Vec<i128>> = m.iter().map(|row| row.iter().map(|a| 2 * a).collect()).collect();
            let Some(doubled) = Binomials::new(&doubled) else { return Ok(()) };
            prop_assert_eq!(doubled.integers(&[1, 0, 0, 0]), None);
            prop_assert_eq!(doubled.integers(&[i128::MIN; 4].map(|side| side + 1)), None);
        }

        #[test]
        fn as_many_distinct_solutions_as_the_determinant(m in prop::collection::vec(-4i128..=4, 9), seed in 0u64..1000) {
            let m: Vec<Vec<i128>> = m.chunks(3).map(<[i128]>::to_vec).collect();
            let minor = |a: usize, b: usize| m[1][a] * m[2][b] - m[1][b] * m[2][a];
            let det = m[0][0] * minor(1, 2) - m[0][1] * minor(0, 2) + m[0][2] * minor(0, 1);
            let Some(binomials) = Binomials::new(&m) else {
                prop_assert_eq!(det, 0);
                return Ok(());
            };
            let mut random = Random::of(seed, Stream::Member(0));
            let b = [random.unit(), random.unit() * 2.0, random.unit() * 0.5];
            let solutions: Vec<_> = (0..det.unsigned_abs() as u64).map(|k| binomials.solution(&b, k)).collect();
            for (k, x) in solutions.iter().enumerate() {
                for (row, b) in m.iter().zip(&b) {
                    let value: num_complex::Complex64 = row.iter().zip(x).map(|(&e, x)| x.powi(e as i32)).product();
                    prop_assert!((value - b).norm() < 1e-9 * b.norm());
                }
                for other in &solutions[..k] {
                    prop_assert!(x.iter().zip(other).any(|(x, o)| (x - o).norm() > 1e-6 * x.norm()));
                }
            }
        }
    }
}
