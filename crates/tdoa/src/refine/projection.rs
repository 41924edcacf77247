//! Which part of a change of its measurements a network can absorb, and which part it cannot: the
//! projection off the Jacobian of all nodes.

use super::cancel::{Cancelled, check};
use super::normal::{backward, forward};
use super::solver::ReceiverEquations;
use crate::network::Network;
use crate::observations::{Observation, Observations};
use faer::linalg::solvers::Llt;
use faer::{Mat, Side};
use hc::Monitor;

/// The Jacobian of the residuals at a network, in the frame in which all measurements have
/// deviation 1, ready for least squares.
pub(crate) struct Projection<'a> {
    observations: &'a Observations,
    /// Unit vectors from receiver to transmitter.
    rays: Vec<[f64; 2]>,
    /// Inverse Cholesky factors of the transmitters' normal equations; `None` where those are
    /// singular.
    factors: Vec<Option<[f64; 6]>>,
    /// The receivers' normal equations with the transmitters eliminated.
    receivers: ReceiverEquations,
}

/// A change of all nodes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Motion {
    /// x and y of each receiver, one after the other, metres.
    pub(crate) receivers: Vec<f64>,
    /// x, y and offset of each transmitter, metres.
    pub(crate) transmitters: Vec<[f64; 3]>,
}

impl Motion {
    /// A network moved by this share of it.
    pub(crate) fn applied(&self, network: &Network, share: f64) -> Network {
        let mut moved = network.clone();
        for (p, by) in moved.receivers.iter_mut().flatten().zip(&self.receivers) {
            *p += share * by;
        }
        for (j, by) in self.transmitters.iter().enumerate() {
            moved.transmitters[j][0] += share * by[0];
            moved.transmitters[j][1] += share * by[1];
            moved.offsets[j] += share * by[2];
        }
        moved
    }
}

impl<'a> Projection<'a> {
    /// `None` where the network cannot be linearised.
    pub(crate) fn new(
        observations: &'a Observations,
        network: &Network,
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
    pub(crate) fn off(&self, values: &[f64]) -> (Vec<f64>, Motion) {
        let motion = self.solve(values);
        let mut rest = Vec::with_capacity(values.len());
        for ((o, u), value) in self.observations.all().iter().zip(&self.rays).zip(values) {
            let (i, t) = (2 * o.receiver, motion.transmitters[o.transmitter]);
            let along = u[0] * (motion.receivers[i] - t[0]) + u[1] * (motion.receivers[i + 1] - t[1]) - t[2];
            let absorbed = if self.factors[o.transmitter].is_some() { o.precision * along } else { *value };
            rest.push(value - absorbed);
        }
        (rest, motion)
    }

    /// The motion whose change of the residuals is nearest to `values`.
    fn solve(&self, values: &[f64]) -> Motion {
        let size = 2 * self.observations.receivers;
        let mut right = vec![0.0; size];
        let mut sums = vec![[0.0; 3]; self.observations.transmitters];
        for (k, o, u) in self.linked() {
            let v = o.precision * values[k];
            right[2 * o.receiver] += v * u[0];
            right[2 * o.receiver + 1] += v * u[1];
            let sum = &mut sums[o.transmitter];
            *sum = [sum[0] - v * u[0], sum[1] - v * u[1], sum[2] - v];
        }
        let solved = |sums: &[[f64; 3]]| -> Vec<[f64; 3]> {
            let each = self.factors.iter().zip(sums);
            each.map(|(factor, sum)| factor.map_or([0.0; 3], |f| backward(&f, forward(&f, *sum)))).collect()
        };
        let alone = solved(&sums);
        for (_, o, u) in self.linked() {
            let t = alone[o.transmitter];
            let along = o.precision * o.precision * (u[0] * t[0] + u[1] * t[1] + t[2]);
            right[2 * o.receiver] += along * u[0];
            right[2 * o.receiver + 1] += along * u[1];
        }
        for (i, _) in self.observations.held().iter().enumerate().filter(|(_, held)| **held) {
            right[2 * i..2 * i + 2].fill(0.0);
        }
        let receivers = self.receivers.solve(&right);
        for (_, o, u) in self.linked() {
            let i = 2 * o.receiver;
            let along = o.precision * o.precision * (u[0] * receivers[i] + u[1] * receivers[i + 1]);
            let sum = &mut sums[o.transmitter];
            *sum = [sum[0] + along * u[0], sum[1] + along * u[1], sum[2] + along];
        }
        Motion { transmitters: solved(&sums), receivers }
    }

    /// Measurements of transmitters that are tied down, with their place and ray.
    fn linked(&self) -> impl Iterator<Item = (usize, &Observation, &[f64; 2])> {
        let all = self.observations.all().iter().zip(&self.rays).enumerate();
        all.filter(|(_, (o, _))| self.factors[o.transmitter].is_some()).map(|(k, (o, u))| (k, o, u))
    }

    /// Unit vectors from receiver to transmitter, in the order of the measurements.
    pub(crate) fn rays(&self) -> &[[f64; 2]] {
        &self.rays
    }
}

/// Product of two lists of values, one for each measurement.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Products of columns from which motions were taken [off](Projection::off), decomposed; `None` where
/// two of them, or one and the network, cannot be told apart.
pub(crate) fn gram(columns: &[(Vec<f64>, Motion)], monitor: &Monitor) -> Result<Option<Llt<f64>>, Cancelled> {
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
    use crate::observations::Observations;
    use crate::simulate::{SimulateOptions, simulate};
    use hc::Monitor;

    #[test]
    fn what_a_motion_makes_is_absorbed_and_nothing_else() {
        let options = SimulateOptions { receivers: 6, transmitters: 7, missing: 0.1, ..Default::default() };
        let simulation = simulate(&options).unwrap();
        let network = &simulation.network;
        let observations = Observations::new(&simulation.pseudoranges, |_, _| true);
        let projection = Projection::new(&observations, network, &Monitor::default()).unwrap().unwrap();
        // A small motion of one node of each kind, by differences.
        let step = 1e-6;
        let mut moved = network.clone();
        moved.receivers[2][0] += step;
        moved.transmitters[4][1] -= step;
        moved.offsets[1] += step;
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
}
