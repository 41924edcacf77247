//! The charts of a formulation, in the form that the tracker of fibres takes.

use super::formulation::Formulation;
use hc::family::Charts;
use num_complex::Complex64;
use std::marker::PhantomData;

/// The charts of `F`: the nodes in another order.
pub(crate) struct Recharted<F>(PhantomData<F>);

impl<F> Default for Recharted<F> {
    fn default() -> Self {
        Recharted(PhantomData)
    }
}

impl<F: Formulation> Charts for Recharted<F> {
    const COUNT: usize = F::CHARTS;

    fn parameters(&self, chart: usize, p: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend(F::parameters(chart, p));
    }

    fn enter(&self, chart: usize, x: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend(F::enter(chart, x));
    }

    fn leave(&self, chart: usize, x: &[Complex64], out: &mut Vec<Complex64>) {
        out.extend(F::leave(chart, x));
    }
}
