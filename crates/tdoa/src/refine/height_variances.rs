//! Variances of the nodes' heights alone: a part of their covariance that takes a fraction of its time.

use super::cancel::{Cancelled, check};
use super::covariance::{own_covariance, reduced};
use super::way::ways;
use crate::network::Network;
use crate::observations::Observations;
use hc::Monitor;

/// Variances of the last coordinate of all nodes, metres squared, in the frame of [`super::covariance()`].
pub(super) struct HeightVariances {
    /// Per receiver.
    pub(super) receivers: Vec<f64>,
    /// Per transmitter; `None` where its own measurements do not determine it.
    pub(super) transmitters: Vec<Option<f64>>,
    /// Largest standard deviation of a receiver's place, metres.
    pub(super) loosest: f64,
}

impl HeightVariances {
    /// At `network`, for least squares over `observations` with deviation `sigma`. `None` if the decomposition fails.
    pub(super) fn of<const D: usize>(
        observations: &Observations<D>,
        network: &Network<D>,
        sigma: f64,
        monitor: &Monitor,
    ) -> Result<Option<HeightVariances>, Cancelled> {
        let Some(reduced) = reduced(observations, network, sigma, monitor)? else { return Ok(None) };
        let (normal, z) = (reduced.normal(), D - 1);
        let mut transmitters = Vec::with_capacity(observations.transmitters);
        for j in 0..observations.transmitters {
            check(monitor)?;
            transmitters.push(normal.inverse_factor(j).map(|factor| {
                let gains = normal.gains(observations, j);
                let ways = ways(observations, normal, j);
                let mut sum = own_covariance(factor, sigma).rows[z][z];
                // Both orders of a pair give the same.
                for (k, (a, of_a)) in gains.iter().zip(&ways).enumerate() {
                    let with = |of_b| reduced.product(of_a, of_b);
                    let before: f64 = gains[..k].iter().zip(&ways).map(|(b, of_b)| b.0[z] * with(of_b)).sum();
                    sum += a.0[z] * (2.0 * before + a.0[z] * with(of_a));
                }
                sum
            }));
        }
        let receivers = (0..observations.receivers).map(|i| reduced.block(i)[z][z]).collect();
        Ok(Some(HeightVariances { receivers, transmitters, loosest: reduced.loosest(network) }))
    }
}

#[cfg(test)]
mod tests {
    use super::HeightVariances;
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::observations::{Node, Observations, Pin};
    use crate::pseudoranges::Pseudoranges;
    use crate::refine::covariance;
    use hc::Monitor;

    /// The same as in the covariance of all coordinates, with heights that are expected and without.
    #[test]
    fn variances_are_those_of_the_covariance() {
        let network: Network<3> = random(8, 14, 3);
        // Two receivers do not hear a transmitter each, and three alone hear the last one.
        let is_heard = |i: usize, j: usize| (i, j) != (2, 5) && (i, j) != (4, 0) && (j < 13 || i < 3);
        let heard = network.pseudoranges().into_iter().enumerate();
        let values = heard.map(|(k, f)| if is_heard(k / 14, k % 14) { f } else { f64::NAN }).collect();
        let observations = Observations::<3>::new(&Pseudoranges::new(8, 14, values).unwrap(), |_, _| true);
        let pin = |node| Pin { node, axis: 2, value: 0.1, precision: 0.3 };
        let pins: Vec<Pin> = (0..8).map(Node::Receiver).chain((0..14).map(Node::Transmitter)).map(pin).collect();
        for observations in [observations.clone(), observations.pinned(&pins)] {
            let whole = covariance(&observations, &network, 0.02, &Monitor::default()).unwrap().unwrap();
            let found = HeightVariances::of(&observations, &network, 0.02, &Monitor::default()).unwrap().unwrap();
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
            assert!(found.receivers.iter().zip(&whole.receivers).all(|(a, c)| near(*a, c[2][2])));
            for (j, (own, c)) in found.transmitters.iter().zip(&whole.transmitters).enumerate() {
                assert_eq!(own.is_some(), c.is_some(), "transmitter {j}");
                assert!(own.zip(c.as_ref()).is_none_or(|(own, c)| near(own, c.rows[2][2])), "transmitter {j}");
            }
        }
    }
}
