//! The toric homotopy: from the binomials of mixed cells to generic coefficients.

use crate::homotopy::ParameterPath;
use crate::tolerances::equations;
use num_complex::Complex64;
use poly::Lane;

/// Coefficients `c_k exp(-w_k u0 t)`, `t` from 1 to 0: the polyhedral homotopy `c_k s^(w_k)` of
/// Huber & Sturmfels (1995) in logarithmic time, so that terms of large and of small weight fade in
/// over many scales of `t` alike. Every path has the weights of its own cell, so that paths of many
/// cells travel side by side.
#[derive(Clone, Debug)]
pub(crate) struct Toric<'a> {
    /// The final coefficients.
    pub(crate) coefficients: &'a [Complex64],
    /// `w_k u0` for every term, cell after cell.
    pub(crate) rates: &'a [f64],
    /// The cell of each path.
    pub(crate) cells: &'a [usize],
}

/// The rates that belong to the weights of a cell, which are zero for its binomials.
pub(crate) fn rates(weights: &[f64]) -> impl Iterator<Item = f64> {
    let least = weights.iter().copied().filter(|&w| w > 0.0).fold(f64::INFINITY, f64::min);
    weights.iter().map(move |w| if *w > 0.0 { equations::FADED * (w / least) } else { 0.0 })
}

impl ParameterPath for Toric<'_> {
    fn parameters(&self) -> usize {
        self.coefficients.len()
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]) {
        let m = self.coefficients.len();
        for (k, c) in self.coefficients.iter().enumerate() {
            let mut rate = S::real(0.0);
            for (rate, &path) in rate.as_mut().iter_mut().zip(paths) {
                *rate = -self.rates[self.cells[path] * m + k];
            }
            let mut power = S::real_mul(&rate, t);
            poly::exp(power.as_mut());
            let mut value = S::from_c64(*c).scale_by(&power);
            p[k] = value;
            for (order, factor) in [(1, 1.0), (2, 1.0 / 2.0), (3, 1.0 / 3.0)] {
                value = value.scale_by(&S::real_mul(&rate, &S::real(factor)));
                p[order * m + k] = value;
            }
        }
    }
}
