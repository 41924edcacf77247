//! How measurements depend on receivers and clocks.

use super::normal::Normal;
use crate::observations::Observations;

/// The derivatives of a residual, over its precision, by the reduced unknowns.
pub(super) struct Way<'a, const D: usize> {
    /// By the coordinates of the receiver, and the place of the first one.
    pub(super) ray: [f64; D],
    pub(super) at: usize,
    /// By unknowns of clocks.
    pub(super) terms: &'a [(usize, f64)],
}

/// Those of the measurements of a transmitter.
pub(super) fn ways<'a, const D: usize>(
    observations: &'a Observations<D>,
    normal: &Normal<D>,
    j: usize,
) -> Vec<Way<'a, D>> {
    observations.places(j).map(|k| Way::new(observations, normal.rays()[k].0, k)).collect()
}

impl<'a, const D: usize> Way<'a, D> {
    /// Of a measurement by its place among all.
    pub(super) fn new(observations: &'a Observations<D>, ray: [f64; D], k: usize) -> Self {
        Way { ray, at: D * observations.all()[k].receiver, terms: observations.clock_terms().of(k) }
    }

    /// What a change of the reduced unknowns adds to the residual.
    #[inline]
    pub(super) fn along(&self, change: &[f64]) -> f64 {
        let of_receiver: f64 = (0..D).map(|k| self.ray[k] * change[self.at + k]).sum();
        self.terms.iter().fold(of_receiver, |sum, &(at, x)| sum + x * change[at])
    }

    /// Adds these derivatives, times a factor, to a list of the reduced unknowns.
    #[inline]
    pub(super) fn spread(&self, factor: f64, sum: &mut [f64]) {
        (0..D).for_each(|k| sum[self.at + k] += factor * self.ray[k]);
        self.terms.iter().for_each(|&(at, x)| sum[at] += factor * x);
    }

    /// The product with those of another measurement under a form of the reduced unknowns, but for what both rays have
    /// together.
    #[inline]
    pub(super) fn of_clocks(&self, other: &Way<'_, D>, form: impl Fn(usize, usize) -> f64) -> f64 {
        let with_clocks = |row: usize| other.terms.iter().map(|&(at, x)| form(row, at) * x).sum::<f64>();
        let with_all =
            |row: usize| with_clocks(row) + (0..D).map(|q| form(row, other.at + q) * other.ray[q]).sum::<f64>();
        let of_ray: f64 = (0..D).map(|p| self.ray[p] * with_clocks(self.at + p)).sum();
        self.terms.iter().fold(of_ray, |sum, &(at, x)| sum + x * with_all(at))
    }
}
