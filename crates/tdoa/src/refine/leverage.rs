//! How much of each measurement the unknowns take.
//!
//! Where few measurements are left over, a gross error bends the network towards itself, and its residual is hardly
//! larger than those of its neighbours. Over the square root of what is left of it, 1 - h with the leverage h, it is: a
//! descent that begins far from the network tells gross errors by residuals of one variance (Schweppe's form of bounded
//! influence; Handschin, Schweppe, Kohlas and Fiechter, "Bad data analysis for power system state estimation", 1975).

use super::normal::Normal;
use crate::bordered::Placed;
use crate::loss::Loss;
use crate::observations::Observations;
use crate::points;

/// Least share of a residual's variance that counts as left over.
const LEAST: f64 = 0.1;

/// What is left of the standard deviation of each residual; holds the buffers.
#[derive(Debug, Default)]
pub(super) struct Leverages<const D: usize> {
    /// Per measurement, the square root of one less its leverage.
    left: Vec<f64>,
    /// Inverse of the Cholesky factor of the reduced equations, column-major.
    inverse: Vec<f64>,
    /// Per measurement of a transmitter, its derivatives by the reduced unknowns, whitened.
    ways: Vec<f64>,
    /// Its derivatives by transmitter and offset, whitened.
    own: Vec<Placed<D>>,
    /// What the transmitter couples to the reduced unknowns, whitened; D + 1 rows.
    coupled: Vec<f64>,
}

impl<const D: usize> Leverages<D> {
    /// Begins with measurements that the unknowns take nothing of.
    pub(super) fn begin(&mut self, observations: &Observations<D>) {
        self.left.clear();
        self.left.resize(observations.len(), 1.0);
    }

    /// Takes leverages from equations that were solved.
    pub(super) fn look(&mut self, observations: &Observations<D>, normal: &Normal<D>) {
        let size = observations.reduced();
        invert(normal.schur(), size, &mut self.inverse);
        self.coupled.resize((D + 1) * size, 0.0);
        for j in 0..observations.transmitters {
            let places = observations.places(j);
            let Some(factor) = normal.inverse_factor(j) else {
                self.left[places].fill(1.0);
                continue;
            };
            let rays = &normal.rays()[places.clone()];
            self.ways.clear();
            self.ways.resize(places.len() * size, 0.0);
            self.own.clear();
            self.coupled.fill(0.0);
            for (k, (way, (u, w))) in places.clone().zip(self.ways.chunks_exact_mut(size).zip(rays)) {
                let receiver = observations.all()[k].receiver;
                let axes = (0..D).filter(|_| !observations.held()[receiver]).map(|axis| (D * receiver + axis, u[axis]));
                for (column, x) in axes.chain(observations.clock_terms().of(k).iter().copied()) {
                    add(&mut way[column..], x, &self.inverse[column * size + column..(column + 1) * size]);
                }
                let own = factor.forward((*u, observations.of_offset(1.0)));
                for (row, g) in self.coupled.chunks_exact_mut(size).zip(own.0.into_iter().chain([own.1])) {
                    add(row, w * g, way);
                }
                self.own.push(own);
            }
            let all = self.left[places].iter_mut().zip(self.ways.chunks_exact_mut(size)).zip(self.own.iter().zip(rays));
            for ((left, way), (own, (_, w))) in all {
                for (row, g) in self.coupled.chunks_exact(size).zip(own.0.into_iter().chain([own.1])) {
                    add(way, -g, row);
                }
                let own = points::dot(own.0, own.0) + own.1 * own.1;
                let reduced: f64 = way.iter().map(|x| x * x).sum();
                *left = (1.0 - w * (own + reduced)).max(LEAST).sqrt();
            }
        }
    }

    /// Sum of the costs of residuals, each over what is left of its deviation and by the square of that.
    pub(super) fn total(&self, loss: &Loss, residuals: &[f64]) -> f64 {
        self.left.iter().zip(residuals).map(|(left, e)| left * left * loss.cost(e / left)).sum()
    }

    /// The weight of a residual by the place of its measurement.
    pub(super) fn weight(&self, loss: &Loss, k: usize, residual: f64) -> f64 {
        loss.weight(residual / self.left[k])
    }
}

/// Adds a multiple of a row.
#[inline]
fn add(sum: &mut [f64], factor: f64, row: &[f64]) {
    sum.iter_mut().zip(row).for_each(|(sum, x)| *sum += factor * x);
}

/// The inverse of a lower triangular matrix, both column-major.
fn invert(factor: &[f64], size: usize, inverse: &mut Vec<f64>) {
    inverse.clear();
    inverse.resize(size * size, 0.0);
    for (c, column) in inverse.chunks_exact_mut(size).enumerate() {
        column[c] = 1.0;
        for k in c..size {
            let (above, below) = column.split_at_mut(k + 1);
            above[k] /= factor[k * size + k];
            add(below, -above[k], &factor[k * size + k + 1..(k + 1) * size]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Leverages;
    use crate::clocks::tests::{Model, models};
    use crate::loss::Loss;
    use crate::observations::Observations;
    use crate::refine::{Projection, normal::Normal, residuals};
    use hc::Monitor;

    /// What is left of a residual is that of a change of its measurement.
    fn are_of_the_projection<const D: usize>(m: usize, n: usize, model: Model) {
        let (network, measured) = model.network::<D>(m, n);
        let observations = Observations::new(&measured, |_, _| true);
        let monitor = Monitor::default();
        let projection = Projection::new(&observations, &network, &monitor).unwrap().unwrap();
        let mut normal = Normal::new(&observations);
        let mut all = vec![0.0; observations.len()];
        residuals(&observations, &network, &mut all);
        normal.linearise(&observations, &network, &all, &Loss { nu: f64::INFINITY, scale: 1.0 }, 0.0);
        // Rigid motions need some damping.
        assert!(normal.solve(&observations, 1e-9, &monitor).unwrap());
        let mut leverages = Leverages::default();
        leverages.begin(&observations);
        leverages.look(&observations, &normal);
        for (k, left) in leverages.left.iter().enumerate() {
            let mut one = vec![0.0; observations.len()];
            one[k] = 1.0;
            let of_change = projection.off(&one).0[k].max(super::LEAST);
            assert!((left * left - of_change).abs() < 1e-5, "{model:?} {k}: {left} {of_change}");
        }
    }

    #[test]
    fn what_is_left_of_a_residual_is_that_of_a_change_of_its_measurement() {
        for model in models() {
            are_of_the_projection::<2>(8, 9, model);
            are_of_the_projection::<3>(10, 11, model);
        }
    }
}
