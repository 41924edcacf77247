//! Networks about a plane whose receivers lie on a conic q(x, y) = a and whose transmitters lie on a conic q(x, y) = b, as
//! a ring of receivers and a circular flight around it do.
//!
//! Transmitters may then rise above the receivers while all distances between the two stay. In the axes of q, let
//! 1 + k A multiply the squares of the receivers' coordinates and divide those of the transmitters', where A has the
//! coefficients of q. Products of coordinates stay, squares of distances change by k (a - b) + O(k^2), the same for all,
//! and a height makes up for it. For circles about one centre this holds for all k, for other conics as long as k^2 is
//! hidden by the noise (Bolker and Roth 1980 have the first order). The planar one of these networks fits without any
//! heights, which says nothing of the true one.

use crate::flatness::{FLAT, slenderness};
use crate::network::Network;
use crate::points::{centroid, spread};
use faer::Mat;

/// Nodes below which conics pass near them by chance: they have seven coefficients, one of them a factor.
const FEWEST: usize = 12;

/// Nodes lie on conics if they are off them by no more than so many of their standard deviations, and by this share of
/// the network's size; and in any case below the last share.
const WITHIN: f64 = 2.0;
const NEAR: f64 = 0.05;
const NEAREST: f64 = 2e-3;

pub(crate) const RAISED: &str = "receivers and transmitters lie on two circles about one centre, or on other conics that fit together: all \
     transmitters may then be above or below the receivers, with other sizes of the two, and fit as well; move some nodes elsewhere, or say \
     with --dimensions 2 that all nodes lie in one plane";

/// Whether the nodes of a network about the plane z = 0, or in the plane, lie on two such conics, as far as is known;
/// `std` is the standard deviation of the receivers (metres, root mean square).
pub(crate) fn may_be_raised<const D: usize>(network: &Network<D>, std: f64) -> bool {
    let flat = |points: &[[f64; D]]| points.iter().map(|p| [p[0], p[1]]).collect::<Vec<[f64; 2]>>();
    let (receivers, transmitters) = (flat(&network.receivers), flat(&network.transmitters));
    // In one line, conics move all nodes together.
    let in_line = |points: &[[f64; 2]]| points.len() < 4 || slenderness(points) < FLAT;
    let all = [receivers.as_slice(), &transmitters].concat();
    if all.len() < FEWEST || in_line(&receivers) || in_line(&transmitters) {
        return false;
    }
    let (centre, size) = (centroid(all.iter()), spread(all.iter()));
    let nodes: Vec<[f64; 2]> = all.iter().map(|p| [(p[0] - centre[0]) / size, (p[1] - centre[1]) / size]).collect();
    let is_receiver = |k: usize| f64::from(u8::from(k < receivers.len()));
    let row = |k: usize| {
        let [x, y] = nodes[k];
        [x * x, x * y, y * y, x, y, is_receiver(k), 1.0 - is_receiver(k)]
    };
    let Ok(found) = Mat::from_fn(nodes.len(), 7, |k, c| row(k)[c]).svd() else { return false };
    let q: Vec<f64> = (0..7).map(|c| found.V()[(c, 6)]).collect();
    let squares = |of: &dyn Fn(usize) -> f64| (0..nodes.len()).map(of).sum::<f64>();
    let misfit = squares(&|k| row(k).iter().zip(&q).map(|(value, c)| value * c).sum::<f64>().powi(2));
    let slope = squares(&|k| {
        let [x, y] = nodes[k];
        (2.0 * q[0] * x + q[1] * y + q[3]).powi(2) + (q[1] * x + 2.0 * q[2] * y + q[4]).powi(2)
    });
    // Of the nodes, six are used up.
    let off = size * (misfit / slope * nodes.len() as f64 / (nodes.len() - 6) as f64).sqrt();
    off <= (WITHIN * std).min(NEAR * size).max(NEAREST * size)
}

#[cfg(test)]
mod tests {
    use super::may_be_raised;
    use crate::calibrate::model::calibrated::Calibrated;
    use crate::calibrate::model::dimensions::calibrate_either;
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::pseudoranges::Pseudoranges;
    use crate::{CalibrateOptions, SimulateOptions, simulate};
    use hc::Monitor;

    fn ring(radius: f64, height: f64, count: usize) -> Vec<[f64; 3]> {
        let angle = |k: usize| 2.4 * k as f64;
        (0..count).map(|k| [radius * angle(k).cos(), radius * angle(k).sin(), height]).collect()
    }

    fn rings(radii: [f64; 2], height: f64) -> Network<3> {
        Network::new(ring(radii[0], 0.0, 9), ring(radii[1], height, 30), (0..30).map(f64::from).collect())
    }

    /// d^2 = a^2 + b^2 + h^2 - 2 a b cos(..): a larger, b smaller, and another height.
    #[test]
    fn rings_have_the_same_distances_at_other_heights() {
        let (a, b, h, factor) = (3.0f64, 6.0f64, 2.0f64, 1.2f64);
        let (c, d) = (a * factor, b / factor);
        let height = (a * a + b * b + h * h - c * c - d * d).sqrt();
        let (one, other) = (rings([a, b], h).pseudoranges(), rings([c, d], height).pseudoranges());
        assert!(one.iter().zip(&other).all(|(x, y)| (x - y).abs() < 1e-12 * x.abs().max(1.0)));
    }

    #[test]
    fn rings_about_one_axis_are_not_trusted() {
        for seed in 0..3 {
            let network = rings([3.0, 6.0], 2.0);
            let noise =
                simulate(&SimulateOptions { receivers: 9, transmitters: 30, noise: 0.01, seed, ..Default::default() });
            let noise = noise.unwrap();
            let exact = noise.network.pseudoranges();
            let noise = noise.pseudoranges.dense().iter().zip(exact).map(|(f, exact)| f - exact).collect::<Vec<f64>>();
            let values = network.pseudoranges().iter().zip(noise).map(|(f, e)| f + e).collect();
            let measured = Pseudoranges::new(9, 30, values).unwrap();
            let found = calibrate_either(&measured, &CalibrateOptions::new(), &Monitor::default()).unwrap();
            let (distrust, warnings) = match &found {
                Calibrated::Plane(found) => (found.distrust(), &found.warnings),
                Calibrated::Space(found) => (found.distrust(), &found.warnings),
            };
            assert!(distrust.is_some(), "seed {seed}: {warnings:?}");
        }
    }

    #[test]
    fn conics_that_fit_together_are_told_from_nodes_anywhere() {
        // An ellipse, and a larger one with the same axes and the same shape.
        let ellipse = |scale: f64, count: usize| -> Vec<[f64; 2]> {
            let turned = |p: [f64; 3]| [scale * (5.0 * p[0] - p[1]) + 7.0, scale * (p[0] + 2.0 * p[1]) - 3.0];
            ring(1.0, 0.0, count).into_iter().map(turned).collect()
        };
        let offsets = vec![0.0; 20];
        let network = Network::new(ellipse(1.0, 9), ellipse(1.7, 20), offsets);
        assert!(may_be_raised(&network, 0.0));
        for seed in 0..50 {
            let network: Network<2> = random(9, 20, seed);
            assert!(!may_be_raised(&network, 0.02 * network.size()), "seed {seed}");
        }
        // Two rows turn about each other, which moves all nodes together.
        let row = |y: f64, count: usize| (0..count).map(|k| [(k * k) as f64, y]).collect();
        let network: Network<2> = Network::new(row(0.0, 8), row(4.0, 9), vec![0.0; 9]);
        assert!(!may_be_raised(&network, 0.0));
    }
}
