//! Which part of a change of its measurements a network can absorb, and which part it cannot: the
//! projection off the Jacobian of all nodes.

use super::cancel::{Cancelled, check};
use super::motion::Motion;
use super::solver::ReceiverEquations;
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
    /// Unit vectors from receiver to transmitter.
    rays: Vec<[f64; D]>,
    /// Inverse Cholesky factors of the transmitters' normal equations; `None` where those are
    /// singular.
    factors: Vec<Option<Bordered<D>>>,
    /// The receivers' normal equations with the transmitters eliminated.
    receivers: ReceiverEquations,
}

impl<'a, const D: usize> Projection<'a, D> {
    /// `None` where the network cannot be linearised.
    pub(crate) fn new(
        observations: &'a Observations<D>,
        network: &Network<D>,
        monitor: &Monitor,
    ) -> Result<Option<Self>, Cancelled> {
        let solver = ReceiverEquations::new(observations, network, monitor, |normal| {
            let rays = normal.rays().iter().map(|(u, _)| *u).collect();
            let factors = (0..observations.transmitters).map(|j| normal.inverse_factor(j).copied()).collect();
            (rays, factors)
        })?;
        Ok(solver.map(|(receivers, (rays, factors))| Projection { observations, rays, factors, receivers }))
    }

    /// The part of `values`, one for each measurement in units of its deviation, that no motion of
    /// the nodes makes, and that motion. Measurements of transmitters that nothing ties down have
    /// no part of it.
    pub(crate) fn off(&self, values: &[f64]) -> (Vec<f64>, Motion<D>) {
        let motion = self.solve(values);
        let mut rest = Vec::with_capacity(values.len());
        for ((o, u), value) in self.observations.all().iter().zip(&self.rays).zip(values) {
            let (at, (t, last)) = (D * o.receiver, motion.transmitters[o.transmitter]);
            let along = (0..D).map(|k| u[k] * (motion.receivers[at + k] - t[k])).sum::<f64>() - last;
            let absorbed = if self.factors[o.transmitter].is_some() { o.precision * along } else { *value };
            rest.push(value - absorbed);
        }
        (rest, motion)
    }

    /// The motion whose change of the residuals is nearest to `values`.
    fn solve(&self, values: &[f64]) -> Motion<D> {
        let size = D * self.observations.receivers;
        let mut right = vec![0.0; size];
        let mut sums = vec![([0.0; D], 0.0); self.observations.transmitters];
        for (k, o, u) in self.linked() {
            let v = o.precision * values[k];
            let (sum, last) = &mut sums[o.transmitter];
            for axis in 0..D {
                right[D * o.receiver + axis] += v * u[axis];
                sum[axis] -= v * u[axis];
            }
            *last -= self.observations.of_offset(v);
        }
        let solved = |sums: &[Placed<D>]| -> Vec<Placed<D>> {
            let each = self.factors.iter().zip(sums);
            each.map(|(factor, sum)| factor.map_or(([0.0; D], 0.0), |f| f.invert(*sum))).collect()
        };
        let alone = solved(&sums);
        for (_, o, u) in self.linked() {
            let (t, last) = alone[o.transmitter];
            let along = o.precision * o.precision * (points::dot(*u, t) + last);
            for axis in 0..D {
                right[D * o.receiver + axis] += along * u[axis];
            }
        }
        for (i, _) in self.observations.held().iter().enumerate().filter(|(_, held)| **held) {
            right[D * i..D * i + D].fill(0.0);
        }
        let receivers = self.receivers.solve(&right);
        for (_, o, u) in self.linked() {
            let moved = from_fn(|axis| receivers[D * o.receiver + axis]);
            let along = o.precision * o.precision * points::dot(*u, moved);
            let (sum, last) = &mut sums[o.transmitter];
            *sum = from_fn(|axis| sum[axis] + along * u[axis]);
            *last += self.observations.of_offset(along);
        }
        Motion { transmitters: solved(&sums), receivers }
    }

    /// Measurements of transmitters that are tied down, with their place and ray.
    fn linked(&self) -> impl Iterator<Item = (usize, &Observation, &[f64; D])> {
        let all = self.observations.all().iter().zip(&self.rays).enumerate();
        all.filter(|(_, (o, _))| self.factors[o.transmitter].is_some()).map(|(k, (o, u))| (k, o, u))
    }

    /// Unit vectors from receiver to transmitter, in the order of the measurements.
    pub(crate) fn rays(&self) -> &[[f64; D]] {
        &self.rays
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
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::observations::Observations;
    use crate::pseudoranges::Pseudoranges;
    use hc::Monitor;

    fn is_absorbed<const D: usize>(m: usize, n: usize, of_offset: f64) {
        let mut network: Network<D> = random(m, n, 2);
        network.offsets.iter_mut().for_each(|offset| *offset *= of_offset);
        let network = &network;
        let mut values = network.pseudoranges();
        [1, n + 3, 2 * n + 4].into_iter().for_each(|k| values[k] = f64::NAN);
        let measured = Pseudoranges::new(m, n, values).unwrap();
        let measured = if of_offset == 0.0 { measured.into_ranges() } else { measured };
        let observations = Observations::new(&measured, |_, _| true);
        let projection = Projection::new(&observations, network, &Monitor::default()).unwrap().unwrap();
        // A small motion of one node of each kind, by differences.
        let step = 1e-6;
        let mut moved = network.clone();
        moved.receivers[2][0] += step;
        moved.transmitters[4][D - 1] -= step;
        moved.offsets[1] += of_offset * step;
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
        is_absorbed::<2>(6, 7, 1.0);
        is_absorbed::<3>(8, 9, 1.0);
    }

    #[test]
    fn of_distances_no_offset_absorbs_anything() {
        is_absorbed::<2>(6, 7, 0.0);
        is_absorbed::<3>(8, 9, 0.0);
    }
}
