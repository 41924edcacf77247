//! The rows of the normal equations that belong to unknowns of clocks.

use crate::clocks::ClockPrior;
use crate::network::Network;
use crate::observations::Observations;

/// Normal equations of the unknowns of clocks among themselves and with receivers.
pub(super) struct ClockBlock {
    /// Coordinates of receivers, which come first among the reduced unknowns.
    first: usize,
    /// All reduced unknowns.
    size: usize,
    /// A row for each unknown of a clock: its products with all reduced unknowns up to itself.
    rows: Vec<f64>,
    gradient: Vec<f64>,
}

impl ClockBlock {
    pub(super) fn new<const D: usize>(observations: &Observations<D>) -> Self {
        let (first, size) = (D * observations.receivers, observations.reduced());
        let count = size - first;
        ClockBlock { first, size, rows: vec![0.0; count * size], gradient: vec![0.0; count] }
    }

    /// Whether there are no such unknowns.
    pub(super) fn is_empty(&self) -> bool {
        self.gradient.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.rows.fill(0.0);
        self.gradient.fill(0.0);
    }

    /// Adds a measurement of these terms: with the ray to it from the receiver that has its coordinates at this place, its
    /// weight, and its weighted residual.
    #[inline]
    pub(super) fn add<const D: usize>(&mut self, terms: &[(usize, f64)], at: usize, u: &[f64; D], w: f64, pull: f64) {
        for &(row, x) in terms {
            let entries = &mut self.rows[(row - self.first) * self.size..][..self.size];
            entries[at..at + D].iter_mut().zip(u).for_each(|(entry, u)| *entry += w * x * u);
            terms.iter().filter(|(column, _)| *column <= row).for_each(|&(column, y)| entries[column] += w * x * y);
            self.gradient[row - self.first] -= pull * x;
        }
    }

    /// Adds what is expected of the clocks of a network, with this weight.
    pub(super) fn expect<const D: usize>(&mut self, prior: &ClockPrior, network: &Network<D>, weight: f64) {
        prior.gradient(network).for_each(|(at, slope)| self.gradient[at] -= weight * slope);
        for (row, column, curvature) in prior.curvature().filter(|(row, column, _)| column <= row) {
            self.rows[row * self.size + self.first + column] += weight * curvature;
        }
    }

    /// Writes the rows into a column-major lower triangle, with the diagonal times `grow` plus `floor`, and the gradient
    /// into a right-hand side.
    pub(super) fn write(&self, matrix: &mut [f64], right: &mut [f64], grow: f64, floor: f64) {
        for (k, gradient) in self.gradient.iter().enumerate() {
            let (row, entries) = (self.first + k, &self.rows[k * self.size..][..self.size]);
            (0..row).for_each(|column| matrix[column * self.size + row] = entries[column]);
            matrix[row * self.size + row] = entries[row] * grow + floor;
            right[row] = *gradient;
        }
    }

    /// Takes what a measurement added off again, in such a matrix.
    pub(super) fn take_off<const D: usize>(
        &self,
        matrix: &mut [f64],
        terms: &[(usize, f64)],
        at: usize,
        u: &[f64; D],
        w: f64,
    ) {
        for &(row, x) in terms {
            (0..D).for_each(|axis| matrix[(at + axis) * self.size + row] -= w * x * u[axis]);
            let before = terms.iter().filter(|(column, _)| *column <= row);
            before.for_each(|&(column, y)| matrix[column * self.size + row] -= w * x * y);
        }
    }
}
