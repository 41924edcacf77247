//! Networks near the best one that explain the measurements about as well. They are too near to
//! count as other networks, and too far for ellipses around the best one alone.

use crate::align::align;
use crate::calibrate::receivers::errors::Fault;
use crate::calibrate::search::truncated_cost::refit;
use crate::network::Network;
use crate::observations::Observations;
use crate::points::{dot, minus, trace};
use crate::refine::{Cancelled, Covariance, RefinedNetwork};
use hc::Monitor;

/// Networks that differ by less than this share of their size, root mean square, ended in one
/// minimum.
const ONE_MINIMUM: f64 = 1e-3;

/// Neighbours that are looked at.
const MOST: usize = 8;

/// A neighbour nearer than this many standard deviations (root mean square over the receivers) lies
/// within what the ellipses say; one farther than the second number is another network.
const WITHIN: f64 = 0.5;
pub(crate) const BEYOND: f64 = 4.0;

/// Less likely neighbours, relative to the best network, are left out.
const LIKELY: f64 = 0.02;

/// Why a network is a neighbour of the best one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reason<const D: usize> {
    /// The search ended there too.
    Found,
    /// An error of a receiver, without which the measurements fit it.
    Error(Fault<D>),
    /// A delay of every receiver, which leaves the measurements this deviation.
    Delays { deviation: f64 },
    /// So many of all outliers are late: it is the one of one-sided errors.
    Late { late: usize, all: usize },
}

/// A neighbour of the best network.
#[derive(Clone)]
pub(crate) struct Neighbour<const D: usize> {
    pub(crate) network: Network<D>,
    /// By how much the measurements are less likely than under the best network, natural logarithm; where
    /// it is without an error, by how much less they tell of that than they had to. Not negative.
    pub(crate) loss: f64,
    pub(crate) reason: Reason<D>,
    /// Deviation of the measurements as a share of that under the best network, at most 1.
    pub(crate) narrow: f64,
    /// Where its receivers lie from those of the best network.
    shifts: Vec<[f64; D]>,
}

/// One network of each minimum among those that the search counted as the best one, the best itself
/// left out.
pub(crate) fn minima<const D: usize>(best: &Network<D>, same: impl Iterator<Item = Network<D>>) -> Vec<Network<D>> {
    let mut kept = vec![best.clone()];
    for network in same {
        if kept.len() <= MOST && !kept.iter().any(|known| is_one_minimum(&network, known)) {
            kept.push(network);
        }
    }
    kept.split_off(1)
}

/// Neighbours that least squares over the inliers leaves apart, with what they cost more than the
/// best.
pub(crate) fn neighbours<const D: usize>(
    observations: &Observations<D>,
    best: &RefinedNetwork<D>,
    near: Vec<Network<D>>,
    deviation: f64,
    monitor: &Monitor,
) -> Result<Vec<Neighbour<D>>, Cancelled> {
    if near.is_empty() {
        return Ok(Vec::new());
    }
    let (centre, least) = refit(observations, &best.network, deviation, monitor)?;
    let mut found = Vec::new();
    for network in near {
        let (network, cost) = refit(observations, &network, deviation, monitor)?;
        found.extend(Neighbour::new(&network, (cost - least).max(0.0), Reason::Found, &centre));
    }
    Ok(each_once(found, &centre))
}

/// Neighbours that are apart from the best network and from each other, the first of each minimum.
pub(crate) fn each_once<const D: usize>(all: Vec<Neighbour<D>>, best: &Network<D>) -> Vec<Neighbour<D>> {
    let mut kept: Vec<Neighbour<D>> = Vec::new();
    for next in all {
        let is_known = |known: &Network<D>| is_one_minimum(&next.network, known);
        if !is_known(best) && !kept.iter().any(|known| is_known(&known.network)) {
            kept.push(next);
        }
    }
    kept
}

/// Whether the receivers of two networks are so near that both are one minimum.
fn is_one_minimum<const D: usize>(a: &Network<D>, b: &Network<D>) -> bool {
    align(&a.receivers, &b.receivers, false).is_none_or(|apart| apart.rms <= ONE_MINIMUM * b.size())
}

impl<const D: usize> Neighbour<D> {
    /// A network as a neighbour of this one; `None` where receivers coincide.
    pub(crate) fn new(network: &Network<D>, loss: f64, reason: Reason<D>, centre: &Network<D>) -> Option<Neighbour<D>> {
        let network = align(&network.receivers, &centre.receivers, false)?.transform.apply_network(network);
        let shifts = network.receivers.iter().zip(&centre.receivers).map(|(&p, &q)| minus(p, q)).collect();
        Some(Neighbour { network, loss, reason, narrow: 1.0, shifts })
    }

    /// This one with a deviation of so many of that under the best network.
    pub(crate) fn narrowed(self, share: f64) -> Neighbour<D> {
        Neighbour { narrow: share.min(1.0), ..self }
    }

    /// How far its receivers lie from those of the best network, root mean square.
    pub(crate) fn rms(&self) -> f64 {
        (self.square() / self.shifts.len() as f64).sqrt()
    }

    fn square(&self) -> f64 {
        self.shifts.iter().map(|&s| dot(s, s)).sum()
    }

    /// How far its receivers lie from those of the best network, in the smaller of both standard
    /// deviations, root mean square.
    pub(crate) fn distance(&self, uncertainty: &Covariance<D>) -> f64 {
        let variance: f64 = uncertainty.receivers.iter().map(trace).sum();
        (self.square() / variance).sqrt() / self.narrow
    }
}

/// Adds what likely neighbours add to the covariance of the receivers: that of the mixture of both,
/// and enough for the ellipse to reach the other.
pub(crate) fn widen<const D: usize>(uncertainty: &mut Covariance<D>, neighbours: &[Neighbour<D>], radius: f64) {
    let total: f64 = 1.0 + neighbours.iter().map(|n| (-n.loss).exp()).sum::<f64>();
    let distances: Vec<f64> = neighbours.iter().map(|n| n.distance(uncertainty)).collect();
    for (neighbour, distance) in neighbours.iter().zip(distances) {
        let share = (-neighbour.loss).exp() / total;
        if share < LIKELY || !(WITHIN..BEYOND).contains(&distance) {
            continue;
        }
        let factor = share + 1.0 / (radius * radius);
        for (c, s) in uncertainty.receivers.iter_mut().zip(&neighbour.shifts) {
            for a in 0..D {
                for b in 0..D {
                    c[a][b] += factor * s[a] * s[b];
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Neighbour, Reason, widen};
    use crate::refine::Covariance;

    #[test]
    fn the_ellipse_reaches_a_neighbour_that_is_as_likely() {
        let mut uncertainty = Covariance { receivers: vec![[[1.0, 0.0], [0.0, 1.0]]; 2], ..Default::default() };
        let shifts = vec![[3.0, 0.0], [0.0, 0.0]];
        let neighbour = |loss| Neighbour {
            network: Default::default(),
            loss,
            reason: Reason::Found,
            narrow: 1.0,
            shifts: shifts.clone(),
        };
        // Half of the mixture lies 3 to the side: its variance about the best is 1 + 9/2, and 9/6
        // more for a radius of sqrt 6.
        widen(&mut uncertainty, &[neighbour(0.0)], 6f64.sqrt());
        assert!((uncertainty.receivers[0][0][0] - 7.0).abs() < 1e-12 && uncertainty.receivers[0][1][1] == 1.0);
        assert_eq!(uncertainty.receivers[1], [[1.0, 0.0], [0.0, 1.0]]);
        // One that is much less likely changes nothing.
        let before = uncertainty.clone();
        widen(&mut uncertainty, &[neighbour(6.0)], 6f64.sqrt());
        assert_eq!(uncertainty.receivers, before.receivers);
    }
}
