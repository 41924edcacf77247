//! Which part of a change of its measurements a network can absorb, and which part it cannot: the
//! projection off the Jacobian of all nodes.

use super::cancel::{Cancelled, check};
use super::motion::Motion;
use super::solver::ReceiverEquations;
use super::way::Way;
use crate::bordered::{Bordered, Placed};
use crate::network::Network;
use crate::observations::{Observation, Observations};
use crate::points;
use faer::linalg::solvers::Llt;
use faer::{Mat, Side};
use hc::Monitor;
use std::array::from_fn;

/// The Jacobian of the residuals at a network, in the frame in which all measurements have
/// deviation 1, ready for least squares.
pub(crate) struct Projection<'a, const D: usize = 2> {
    observations: &'a Observations<D>,
    /// How each measurement depends on receivers and clocks.
    ways: Vec<Way<'a, D>>,
    /// Inverse Cholesky factors of the transmitters' normal equations; `None` where those are
    /// singular.
    factors: Vec<Option<Bordered<D>>>,
    /// The normal equations of receivers and clocks, with the transmitters eliminated.
    reduced: ReceiverEquations,
}

impl<'a, const D: usize> Projection<'a, D> {
    /// `None` where the network cannot be linearised.
    pub(crate) fn new(
        observations: &'a Observations<D>,
        network: &Network<D>,
        monitor: &Monitor,
    ) -> Result<Option<Self>, Cancelled> {
        let solver = ReceiverEquations::new(observations, network, monitor, |normal| {
            let ways = normal.rays().iter().enumerate().map(|(k, (u, _))| Way::new(observations, *u, k)).collect();
            let factors = (0..observations.transmitters).map(|j| normal.inverse_factor(j).copied()).collect();
            (ways, factors)
        })?;
        Ok(solver.map(|(reduced, (ways, factors))| Projection { observations, ways, factors, reduced }))
    }

    /// The part of `values`, one for each measurement in units of its deviation, that no motion of
    /// the nodes makes, and that motion. Measurements of transmitters that nothing ties down have
    /// no part of it.
    pub(crate) fn off(&self, values: &[f64]) -> (Vec<f64>, Motion<D>) {
        let motion = self.solve(values);
        let mut rest = Vec::with_capacity(values.len());
        for ((o, way), value) in self.observations.all().iter().zip(&self.ways).zip(values) {
            let ((t, last), u, moved) = (motion.transmitters[o.transmitter], way.ray, &motion.reduced[way.at..]);
            let along = (0..D).map(|k| u[k] * (moved[k] - t[k])).sum::<f64>() - last;
            let along = way.terms.iter().fold(along, |sum, &(at, x)| sum + x * motion.reduced[at]);
            let absorbed = if self.factors[o.transmitter].is_some() { o.precision * along } else { *value };
            rest.push(value - absorbed);
        }
        (rest, motion)
    }

    /// The motion whose change of the residuals is nearest to `values`.
    fn solve(&self, values: &[f64]) -> Motion<D> {
        let mut right = vec![0.0; self.observations.reduced()];
        let mut sums = vec![([0.0; D], 0.0); self.observations.transmitters];
        for (k, o, way) in self.linked() {
            let v = o.precision * values[k];
            let (sum, last) = &mut sums[o.transmitter];
            way.spread(v, &mut right);
            (0..D).for_each(|axis| sum[axis] -= v * way.ray[axis]);
            *last -= self.observations.of_offset(v);
        }
        let solved = |sums: &[Placed<D>]| -> Vec<Placed<D>> {
            let each = self.factors.iter().zip(sums);
            each.map(|(factor, sum)| factor.map_or(([0.0; D], 0.0), |f| f.invert(*sum))).collect()
        };
        let alone = solved(&sums);
        for (_, o, way) in self.linked() {
            let (t, last) = alone[o.transmitter];
            way.spread(o.precision * o.precision * (points::dot(way.ray, t) + last), &mut right);
        }
        for (i, _) in self.observations.held().iter().enumerate().filter(|(_, held)| **held) {
            right[D * i..D * i + D].fill(0.0);
        }
        let reduced = self.reduced.solve(&right);
        for (_, o, way) in self.linked() {
            let along = o.precision * o.precision * way.along(&reduced);
            let (sum, last) = &mut sums[o.transmitter];
            *sum = from_fn(|axis| sum[axis] + along * way.ray[axis]);
            *last += self.observations.of_offset(along);
        }
        Motion { transmitters: solved(&sums), reduced }
    }

    /// Measurements of transmitters that are tied down, with their place.
    fn linked(&self) -> impl Iterator<Item = (usize, &Observation, &Way<'a, D>)> {
        let all = self.observations.all().iter().zip(&self.ways).enumerate();
        all.filter(|(_, (o, _))| self.factors[o.transmitter].is_some()).map(|(k, (o, way))| (k, o, way))
    }

    /// The unit vector from receiver to transmitter of a measurement, by its place among all.
    pub(crate) fn ray(&self, k: usize) -> [f64; D] {
        self.ways[k].ray
    }
}

/// Product of two lists of values, one for each measurement.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Products of columns from which motions were taken [off](Projection::off), decomposed; `None` where
/// two of them, or one and the network, cannot be told apart.
pub(crate) fn gram<const D: usize>(
    columns: &[(Vec<f64>, Motion<D>)],
    monitor: &Monitor,
) -> Result<Option<Llt<f64>>, Cancelled> {
    let size = columns.len();
    let mut products = Mat::zeros(size, size);
    for b in 0..size {
        check(monitor)?;
        for a in 0..size {
            products[(a, b)] = dot(&columns[a].0, &columns[b].0);
        }
    }
    Ok(products.llt(Side::Lower).ok())
}

#[cfg(test)]
mod tests {
    use super::Projection;
    use crate::clocks::Emissions;
    use crate::clocks::tests::{Model, models};
    use crate::observations::Observations;
    use hc::Monitor;

    fn is_absorbed<const D: usize>(m: usize, n: usize, model: Model) {
        let (network, measured) = model.network::<D>(m, n);
        let network = &network;
        let observations = Observations::new(&measured, |_, _| true);
        let projection = Projection::new(&observations, network, &Monitor::default()).unwrap().unwrap();
        // A small motion of one node of each kind, and of clocks, by differences.
        let step = 1e-6;
        let mut moved = network.clone();
        moved.receivers[2][0] += step;
        moved.transmitters[4][D - 1] -= step;
        if model.emissions == Emissions::Unknown {
            moved.offsets[1] += step;
        }
        let changes: Vec<f64> = (0..observations.clocks().count()).map(|k| step * (k as f64).cos()).collect();
        observations.clocks().add(&mut moved, &changes, 1.0);
        let change: Vec<f64> =
            observations.all().iter().map(|o| (o.residual(&moved) - o.residual(network)) / step).collect();
        let (rest, _) = projection.off(&change);
        assert!(rest.iter().all(|e| e.abs() < 1e-5), "{rest:?}");
        // The projection of anything is orthogonal to that change and stays when projected again.
        let any: Vec<f64> = (0..observations.len()).map(|k| (k as f64).sin()).collect();
        let (rest, _) = projection.off(&any);
        let product: f64 = rest.iter().zip(&change).map(|(a, b)| a * b).sum();
        assert!(product.abs() < 1e-4, "{product}");
        let (again, _) = projection.off(&rest);
        assert!(rest.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-9));
        // As many dimensions are left as there are more measurements than unknowns: the trace of
        // the projection.
        let unit = |k: usize| -> Vec<f64> { (0..observations.len()).map(|l| f64::from(u8::from(k == l))).collect() };
        let trace: f64 = (0..observations.len()).map(|k| projection.off(&unit(k)).0[k]).sum();
        let expected = observations.len() - observations.unknowns();
        assert!((trace - expected as f64).abs() < 1e-8, "{trace} {expected}");
    }

    #[test]
    fn what_a_motion_makes_is_absorbed_and_nothing_else() {
        for model in models() {
            is_absorbed::<2>(8, 9, model);
            is_absorbed::<3>(10, 11, model);
        }
    }
}
