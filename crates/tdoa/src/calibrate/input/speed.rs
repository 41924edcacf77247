//! The propagation speed from known distances between receivers.

use serde::{Deserialize, Serialize};

use crate::calibrate::options::{CalibrateError, CalibrateOptions};
use crate::degeneracy::Usable;
use crate::network::Network;
use crate::observations::Node;
use crate::points::{distance, minus};

/// The propagation speed that follows from the known distances.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SpeedEstimate {
    /// True speed divided by the speed with which the measurements were converted to metres.
    pub factor: f64,
    /// Its standard deviation, from the noise of the measurements and the deviations of the known positions; `None` if
    /// the noise is not known.
    pub factor_std: Option<f64>,
    /// The speed in metres per second, if the program knows the speed that was assumed.
    pub metres_per_second: Option<f64>,
    /// Root mean square of known minus found distances, metres.
    pub residual: f64,
    /// Number of distances that were used.
    pub distances: usize,
}

/// A position of a receiver in all coordinates, and their standard deviations.
type Known<const D: usize> = ([f64; D], [f64; D]);

/// A known distance between two receivers.
pub(crate) struct Span<const D: usize> {
    receivers: [usize; 2],
    distance: f64,
    /// Its standard deviation, if it was measured as a distance.
    sigma: f64,
    /// The known positions that it follows from.
    ends: Option<[Known<D>; 2]>,
}

impl<const D: usize> Span<D> {
    /// Derivatives of the distance by the coordinates of its first end; those by the second are the opposite.
    fn direction(&self) -> [f64; D] {
        self.ends.map_or([0.0; D], |[(p, _), (q, _)]| minus(p, q).map(|x| x / self.distance))
    }

    /// Variance of the known distance, to first order.
    fn variance(&self) -> f64 {
        let u = self.direction();
        let ends = self.ends.iter().flatten();
        let of_ends: f64 = ends.map(|(_, sigma)| (0..D).map(|k| (u[k] * sigma[k]).powi(2)).sum::<f64>()).sum();
        self.sigma.powi(2) + of_ends
    }
}

/// All known distances: the given ones and those between receivers of known position.
pub(crate) fn known_distances<const D: usize>(options: &CalibrateOptions<D>) -> Vec<Span<D>> {
    let given = options.distances.iter().map(|known| Span {
        receivers: known.receivers,
        distance: known.distance,
        sigma: known.sigma.unwrap_or_default(),
        ends: None,
    });
    let mut all: Vec<Span<D>> = given.collect();
    let exact = options.anchors.iter().enumerate().filter_map(|(i, p)| Some((i, ((*p)?, [0.0; D]))));
    let measured = options.positions.iter().filter_map(|known| match known.node {
        Node::Receiver(i) => Some((i, (known.whole()?, known.sigma))),
        Node::Transmitter(_) => None,
    });
    let places: Vec<(usize, Known<D>)> = exact.chain(measured).collect();
    for (k, (a, p)) in places.iter().enumerate() {
        for (b, q) in &places[k + 1..] {
            if p.0 != q.0 {
                let ends = Some([*p, *q]);
                all.push(Span { receivers: [*a, *b], distance: distance(p.0, q.0), sigma: 0.0, ends });
            }
        }
    }
    all
}

/// The factor that brings found distances closest to known ones, sum w d D / sum w d^2 for found d and
/// known D. The weights w are s^2 / (s^2 + v) for known distances of variance v and found ones of the mean variance
/// s^2, so that they are 1 where positions are exact. Its deviation follows by its derivatives, -factor w d / sum w d^2 for each d, with
/// the joint covariance (row-major) of the receivers, and w d / sum w d^2 for each D.
pub(crate) fn speed<const D: usize>(
    network: &Network<D>,
    usable: &Usable,
    joint: Option<&[f64]>,
    options: &CalibrateOptions<D>,
) -> Result<SpeedEstimate, CalibrateError<D>> {
    let place = |i: usize| usable.receivers.iter().position(|&other| other == i);
    let spans: Vec<([usize; 2], Span<D>)> = known_distances(options)
        .into_iter()
        .filter_map(|span| Some(([place(span.receivers[0])?, place(span.receivers[1])?], span)))
        .collect();
    let size = D * network.receivers.len();
    let joint = joint.filter(|joint| joint.len() == size * size);
    let between = |[a, b]: [usize; 2]| minus(network.receivers[a], network.receivers[b]);
    let found = |[a, b]: [usize; 2]| distance(network.receivers[a], network.receivers[b]);
    let of_found = |joint: &[f64], [a, b]: [usize; 2]| -> f64 {
        let (u, d) = (between([a, b]), found([a, b]));
        let side = |p: usize, q: usize| {
            (0..D * D).map(|c| u[c / D] * joint[(D * p + c / D) * size + D * q + c % D] * u[c % D]).sum::<f64>()
        };
        (side(a, a) + side(b, b) - side(a, b) - side(b, a)) / (d * d)
    };
    let mean = joint
        .map_or(0.0, |joint| spans.iter().map(|(pair, _)| of_found(joint, *pair)).sum::<f64>() / spans.len() as f64);
    let weight = |span: &Span<D>| match span.variance() {
        variance if variance > 0.0 && mean > 0.0 => mean / (mean + variance),
        _ => 1.0,
    };
    let squares: f64 = spans.iter().map(|(pair, span)| weight(span) * found(*pair).powi(2)).sum();
    let factor = spans.iter().map(|(pair, span)| weight(span) * span.distance * found(*pair)).sum::<f64>() / squares;
    if !(factor > 0.0 && factor.is_finite()) {
        return Err(CalibrateError::Known(
            "the receivers whose distance is known cannot be located; give the distance of others".to_string(),
        ));
    }
    let (mut of_network, mut of_positions) = (vec![0.0; size], vec![0.0; size]);
    let mut sigmas = vec![0.0; size];
    for (pair, span) in &spans {
        // d times the derivative of d by a coordinate is the difference of the coordinates.
        let step = between(*pair).map(|x| -factor * weight(span) / squares * x);
        let share = weight(span) * found(*pair) / squares;
        let direction = span.direction();
        for (end, sign) in [(0, 1.0), (1, -1.0)] {
            for k in 0..D {
                let at = D * pair[end] + k;
                of_network[at] += sign * step[k];
                of_positions[at] += sign * share * direction[k];
                if let Some(ends) = &span.ends {
                    sigmas[at] = ends[end].1[k];
                }
            }
        }
    }
    let variance = |joint: &[f64]| -> f64 {
        let cells = (0..size).flat_map(|p| (0..size).map(move |q| (p, q)));
        cells.map(|(p, q)| of_network[p] * joint[p * size + q] * of_network[q]).sum()
    };
    let of_positions: f64 = of_positions.iter().zip(&sigmas).map(|(share, sigma)| (share * sigma).powi(2)).sum();
    let of_distances: f64 =
        spans.iter().map(|(pair, span)| (weight(span) * found(*pair) / squares * span.sigma).powi(2)).sum();
    let misfit: f64 = spans.iter().map(|(pair, span)| (span.distance - factor * found(*pair)).powi(2)).sum();
    Ok(SpeedEstimate {
        factor,
        factor_std: joint.map(|joint| (variance(joint).max(0.0) + of_positions + of_distances).sqrt()),
        metres_per_second: None,
        residual: (misfit / spans.len() as f64).sqrt(),
        distances: spans.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibrate::options::{KnownDistance, MeasuredPosition};

    #[test]
    fn a_single_distance_gives_factor_and_deviation() {
        let network = Network { receivers: vec![[0.0, 0.0], [3.0, 4.0], [1.0, 0.0]], ..Default::default() };
        let usable = Usable { receivers: vec![0, 2, 3], transmitters: vec![], warnings: vec![] };
        let options = CalibrateOptions {
            distances: vec![KnownDistance { receivers: [2, 0], distance: 10.0, sigma: None }],
            ..Default::default()
        };
        // The distance 5 m with independent errors of 0.1 m in all coordinates has a deviation of
        // 0.1 sqrt(2); the factor 10 / 5 has 10 / 25 of it.
        let joint: Vec<f64> = (0..36).map(|k| if k % 7 == 0 { 0.01 } else { 0.0 }).collect();
        let found = speed(&network, &usable, Some(&joint), &options).unwrap();
        assert_eq!((found.factor, found.distances, found.residual), (2.0, 1, 0.0));
        assert!((found.factor_std.unwrap() - 0.4 * 0.1 * 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(speed(&network, &usable, None, &options).unwrap().factor_std, None);
        // A taped distance of deviation 0.3 m adds (0.3 / 5)^2.
        let mut taped = options.clone();
        taped.distances[0].sigma = Some(0.3);
        let found = speed(&network, &usable, Some(&joint), &taped).unwrap();
        assert!((found.factor_std.unwrap().powi(2) - 0.0032 - 0.0036).abs() < 1e-12 && found.factor == 2.0);
        // Positions 10 m apart, of deviation 0.1 m, add a variance of 0.02 m^2 times (5 / 25)^2.
        let place = |i: usize, x: f64| MeasuredPosition {
            node: Node::Receiver(i),
            position: [Some(x), Some(1.0)],
            sigma: [0.1; 2],
        };
        let positions = vec![place(0, 3.0), place(2, 13.0)];
        let of_positions = CalibrateOptions { positions, ..Default::default() };
        let measured = speed(&network, &usable, Some(&joint), &of_positions).unwrap();
        assert!((measured.factor - 2.0).abs() < 1e-12 && measured.distances == 1);
        assert!((measured.factor_std.unwrap().powi(2) - 0.0032 - 0.0008).abs() < 1e-12);
        let unlocated = Usable { receivers: vec![0, 1, 3], transmitters: vec![], warnings: vec![] };
        assert!(speed(&network, &unlocated, None, &options).is_err());
    }
}
