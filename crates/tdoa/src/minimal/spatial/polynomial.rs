//! Polynomials of degree at most four in one unknown, and a common root of several.

use faer::Mat;
use std::array::from_fn;

/// Newton steps that bring a common root to full accuracy.
const STEPS: usize = 4;

/// Coefficients, the constant one first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Polynomial(pub(super) [f64; 5]);

impl Polynomial {
    pub(super) const ZERO: Polynomial = Polynomial([0.0; 5]);

    /// `constant + slope t`.
    pub(super) fn line(constant: f64, slope: f64) -> Polynomial {
        Polynomial([constant, slope, 0.0, 0.0, 0.0])
    }

    /// `self + factor other`.
    pub(super) fn plus(&self, factor: f64, other: &Polynomial) -> Polynomial {
        Polynomial(from_fn(|k| self.0[k] + factor * other.0[k]))
    }

    /// The product, without terms of degree five and more.
    pub(super) fn times(&self, other: &Polynomial) -> Polynomial {
        Polynomial(from_fn(|k| (0..=k).map(|i| self.0[i] * other.0[k - i]).sum()))
    }

    fn value(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    fn derivative(&self, t: f64) -> f64 {
        (1..5).rev().fold(0.0, |sum, k| sum * t + k as f64 * self.0[k])
    }

    /// Size of all terms together.
    fn size(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * t.abs() + c.abs())
    }

    /// Real parts of the roots; none if the polynomial vanishes.
    fn roots(&self) -> Vec<f64> {
        let largest = self.0.iter().fold(0.0f64, |a, c| a.max(c.abs()));
        let degree = (1..5).rev().find(|&k| self.0[k].abs() > f64::EPSILON * largest).unwrap_or(0);
        let companion = Mat::from_fn(degree, degree, |i, j| {
            if i + 1 == degree { -self.0[j] / self.0[degree] } else { f64::from(u8::from(j == i + 1)) }
        });
        let roots = if degree == 0 { None } else { companion.eigenvalues().ok() };
        roots.unwrap_or_default().iter().map(|root| root.re).collect()
    }
}

/// The number at which all polynomials are smallest, relative to their terms: their common root if
/// they have one. `None` if there is no finite root at all.
pub(super) fn common_root(all: &[Polynomial]) -> Option<f64> {
    let relative = |p: &Polynomial, t: f64| (p.value(t) / p.size(t), p.derivative(t) / p.size(t));
    let misfit = |t: f64| all.iter().map(|p| relative(p, t).0.powi(2)).sum::<f64>();
    let candidates = all.iter().flat_map(Polynomial::roots).filter(|t| misfit(*t).is_finite());
    let mut t = candidates.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)))?;
    for _ in 0..STEPS {
        let pairs = all.iter().map(|p| relative(p, t));
        let (along, steepness) = pairs.fold((0.0, 0.0), |(a, s), (v, d)| (a + v * d, s + d * d));
        let next = t - along / steepness;
        // NaN is not better.
        let better = misfit(next) < misfit(t);
        if !better {
            break;
        }
        t = next;
    }
    Some(t)
}

#[cfg(test)]
mod tests {
    use super::{Polynomial, common_root};

    #[test]
    fn a_common_root_is_found_among_others() {
        // (t - 3)(t + 1), (t - 3)(t^2 + 1), (t - 3)^2 (t - 8) (t + 5).
        let root = Polynomial::line(-3.0, 1.0);
        let circle = Polynomial([1.0, 0.0, 1.0, 0.0, 0.0]);
        let far = Polynomial::line(-8.0, 1.0).times(&Polynomial::line(5.0, 1.0)).times(&root);
        let all = [root.times(&Polynomial::line(1.0, 1.0)), root.times(&circle), root.times(&far)];
        assert_eq!(all[1], Polynomial([-3.0, 1.0, -3.0, 1.0, 0.0]));
        assert!((common_root(&all).unwrap() - 3.0).abs() < 1e-12);
        assert_eq!(common_root(&[Polynomial::ZERO, Polynomial::line(1.0, 0.0)]), None);
        assert_eq!(common_root(&[Polynomial::line(f64::NAN, 1.0)]), None);
    }
}
