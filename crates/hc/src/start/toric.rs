//! The toric homotopy: from the binomials of mixed cells to generic coefficients.

use crate::homotopy::ParameterPath;
use crate::tolerances::EQUATIONS;
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
    weights.iter().map(move |w| if *w > 0.0 { EQUATIONS.faded * (w / least) } else { 0.0 })
}

impl ParameterPath for Toric<'_> {
    fn parameters(&self) -> usize {
        self.coefficients.len()
    }

    #[inline(always)]
    fn coefficients<S: Lane>(&self, paths: &[usize], t: &S::Real, p: &mut [S]) {
        let m = self.coefficients.len();
        for (l, (&t, &path)) in t.as_ref().iter().zip(paths).enumerate() {
            let cell = self.cells[path];
            let rates = &self.rates[cell * m..(cell + 1) * m];
            for (k, (c, &rate)) in self.coefficients.iter().zip(rates).enumerate() {
                let mut value = if rate == 0.0 { *c } else { c * (-rate * t).exp() };
                for order in 0..4 {
                    p[order * m + k].set(l, value);
                    value *= -rate / (order + 1) as f64;
                }
            }
        }
    }
}
