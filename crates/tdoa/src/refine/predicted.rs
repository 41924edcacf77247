//! How well a network predicts its own measurements.

use super::cancel::{Cancelled, check};
use super::covariance::reduced;
use super::normal::{backward, forward};
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Variance of the length that the network predicts for each measurement, for measurements of
/// deviation 1; `None` for those of transmitters that nothing ties down, and altogether where the
/// network cannot be linearised.
pub(crate) fn predicted_variances(
    observations: &Observations,
    network: &Network,
    monitor: &Monitor,
) -> Result<Option<Vec<Option<f64>>>, Cancelled> {
    let Some(reduced) = reduced(observations, network, 1.0, monitor)? else { return Ok(None) };
    let (normal, joint) = (reduced.normal(), reduced.joint());
    let size = 2 * observations.receivers;
    let mut all = Vec::with_capacity(observations.len());
    for j in 0..observations.transmitters {
        check(monitor)?;
        let column = observations.of_transmitter(j);
        let rays = &normal.rays()[all.len()..all.len() + column.len()];
        let Some(factor) = normal.inverse_factor(j) else {
            all.extend(std::iter::repeat_n(None, column.len()));
            continue;
        };
        let solved = |x: [f64; 3]| backward(factor, forward(factor, x));
        let g = |k: usize| [rays[k].0[0], rays[k].0[1], 1.0];
        // A motion of the receivers by dr moves the transmitter by sum_l a_l u_l^T dr_l.
        let gains: Vec<[f64; 3]> = (0..column.len()).map(|k| solved(g(k).map(|x| rays[k].1 * x))).collect();
        let between = |k: usize, l: usize| -> f64 {
            let (a, b) = (2 * column[k].receiver, 2 * column[l].receiver);
            let entry = |x: usize, y: usize| rays[k].0[x] * joint[(a + x) * size + b + y] * rays[l].0[y];
            entry(0, 0) + entry(0, 1) + entry(1, 0) + entry(1, 1)
        };
        // Covariances of the ways along the rays with the transmitter's motion.
        let mixed = |k: usize| -> [f64; 3] {
            gains.iter().enumerate().fold([0.0; 3], |sum, (l, a)| {
                let along = between(k, l);
                [0, 1, 2].map(|x| sum[x] + along * a[x])
            })
        };
        let mixed: Vec<[f64; 3]> = (0..column.len()).map(mixed).collect();
        for k in 0..column.len() {
            let moved: f64 = gains.iter().zip(&mixed).map(|(a, m)| dot(g(k), *a) * dot(g(k), *m)).sum();
            all.push(Some(dot(g(k), solved(g(k))) + between(k, k) - 2.0 * dot(g(k), mixed[k]) + moved));
        }
    }
    Ok(Some(all))
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::predicted_variances;
    use crate::observations::Observations;
    use crate::refine::Projection;
    use crate::simulate::{SimulateOptions, simulate};
    use hc::Monitor;

    #[test]
    fn the_network_takes_the_variance_of_a_prediction_of_a_change_of_one_measurement() {
        let options = SimulateOptions { receivers: 6, transmitters: 7, missing: 0.1, ..Default::default() };
        let simulation = simulate(&options).unwrap();
        let observations = Observations::new(&simulation.pseudoranges, |_, _| true);
        let projection = Projection::new(&observations, &simulation.network, &Monitor::default()).unwrap().unwrap();
        let variances = predicted_variances(&observations, &simulation.network, &Monitor::default()).unwrap().unwrap();
        for (k, variance) in variances.into_iter().enumerate() {
            let mut one = vec![0.0; observations.len()];
            one[k] = 1.0;
            let taken = 1.0 - projection.off(&one).0[k];
            assert!((variance.unwrap() - taken).abs() < 1e-9, "{k}: {variance:?} {taken}");
        }
    }
}
