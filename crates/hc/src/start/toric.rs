//! The toric homotopy: from the binomials of a mixed cell to generic coefficients.

use crate::homotopy::ParameterPath;
use num_complex::Complex64;
use poly::Lane;

/// Coefficients `c_k exp(-w_k u0 t)`, `t` from 1 to 0: the polyhedral homotopy `c_k s^(w_k)` of Huber & Sturmfels (1995) in
/// logarithmic time, so that terms of large and of small weight fade in over many scales of `t` alike.
#[derive(Clone, Debug)]
pub(crate) struct Toric {
    coefficients: Vec<Complex64>,
    /// `w_k u0`.
    rates: Vec<f64>,
}

/// `u0` times the least positive weight: what is not part of the binomials starts at `exp(-30)`, about 1e-13, of its size.
const FADED: f64 = 30.0;

impl Toric {
    /// From the final coefficients and the weights, which are zero for the binomials.
    pub(crate) fn new(coefficients: &[Complex64], weights: &[f64]) -> Self {
        let least = weights.iter().copied().filter(|&w| w > 0.0).fold(f64::INFINITY, f64::min);
        let rates = weights.iter().map(|w| if *w > 0.0 { FADED * (w / least) } else { 0.0 }).collect();
        Toric { coefficients: coefficients.to_vec(), rates }
    }
}

impl ParameterPath for Toric {
    fn parameters(&self) -> usize {
        self.coefficients.len()
    }

    fn coefficients<S: Lane>(&self, t: &S::Real, p: &mut [S]) {
        let m = self.coefficients.len();
        for (k, (c, &rate)) in self.coefficients.iter().zip(&self.rates).enumerate() {
            for (l, &t) in t.as_ref().iter().enumerate() {
                let mut value = c * (-rate * t).exp();
                for order in 0..4 {
                    p[order * m + k].set(l, value);
                    value *= -rate / (order + 1) as f64;
                }
            }
        }
    }
}
