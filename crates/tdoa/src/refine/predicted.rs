//! How well a network predicts its own measurements.

use super::cancel::{Cancelled, check};
use super::covariance::reduced;
use super::way::ways;
use crate::bordered::Placed;
use crate::network::Network;
use crate::observations::Observations;
use crate::points;
use hc::Monitor;
use std::array::from_fn;

/// Variance of the length that the network predicts for each measurement, for measurements of
/// deviation 1; `None` for those of transmitters that nothing ties down, and altogether where the
/// network cannot be linearised.
pub(crate) fn predicted_variances<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    monitor: &Monitor,
) -> Result<Option<Vec<Option<f64>>>, Cancelled> {
    let Some(reduced) = reduced(observations, network, 1.0, monitor)? else { return Ok(None) };
    let (normal, joint) = (reduced.normal(), reduced.joint());
    let size = observations.reduced();
    let mut all = Vec::with_capacity(observations.len());
    for j in 0..observations.transmitters {
        check(monitor)?;
        let column = observations.of_transmitter(j);
        let rays = &normal.rays()[observations.places(j)];
        let Some(factor) = normal.inverse_factor(j) else {
            all.extend(std::iter::repeat_n(None, column.len()));
            continue;
        };
        let g = |k: usize| (rays[k].0, observations.of_offset(1.0));
        // A motion of the receivers by dr moves the transmitter by sum_l a_l u_l^T dr_l.
        let (gains, ways) = (normal.gains(observations, j), ways(observations, normal, j));
        let between = |k: usize, l: usize| -> f64 {
            let (p, q) = (&ways[k], &ways[l]);
            let entry = |x: usize, y: usize| p.ray[x] * joint[(p.at + x) * size + q.at + y] * q.ray[y];
            let rays: f64 = (0..D).flat_map(|x| (0..D).map(move |y| (x, y))).map(|(x, y)| entry(x, y)).sum();
            rays + p.of_clocks(q, |a, b| joint[a * size + b])
        };
        // Covariances of the ways along the rays with the transmitter's motion.
        let mixed = |k: usize| -> Placed<D> {
            gains.iter().enumerate().fold(([0.0; D], 0.0), |(sum, last), (l, (a, end))| {
                let along = between(k, l);
                (from_fn(|x| sum[x] + along * a[x]), last + along * end)
            })
        };
        let mixed: Vec<Placed<D>> = (0..column.len()).map(mixed).collect();
        for k in 0..column.len() {
            let moved: f64 = gains.iter().zip(&mixed).map(|(a, m)| dot(g(k), *a) * dot(g(k), *m)).sum();
            all.push(Some(dot(g(k), factor.invert(g(k))) + between(k, k) - 2.0 * dot(g(k), mixed[k]) + moved));
        }
    }
    Ok(Some(all))
}

fn dot<const D: usize>(a: Placed<D>, b: Placed<D>) -> f64 {
    points::dot(a.0, b.0) + a.1 * b.1
}

#[cfg(test)]
mod tests {
    use super::predicted_variances;
    use crate::clocks::tests::{Model, models};
    use crate::observations::Observations;
    use crate::refine::Projection;
    use hc::Monitor;

    fn is_taken<const D: usize>(m: usize, n: usize, model: Model) {
        let (network, measured) = model.network::<D>(m, n);
        let observations = Observations::new(&measured, |_, _| true);
        let projection = Projection::new(&observations, &network, &Monitor::default()).unwrap().unwrap();
        let variances = predicted_variances(&observations, &network, &Monitor::default()).unwrap().unwrap();
        for (k, variance) in variances.into_iter().enumerate() {
            let mut one = vec![0.0; observations.len()];
            one[k] = 1.0;
            let taken = 1.0 - projection.off(&one).0[k];
            assert!((variance.unwrap() - taken).abs() < 1e-9, "{k}: {variance:?} {taken}");
        }
    }

    #[test]
    fn the_network_takes_the_variance_of_a_prediction_of_a_change_of_one_measurement() {
        for model in models() {
            is_taken::<2>(8, 9, model);
            is_taken::<3>(10, 11, model);
        }
    }
}
