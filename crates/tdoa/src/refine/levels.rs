//! What it adds to a covariance that the values of pins are not known well.
//!
//! A level h changes the values of pins with shares f together. With N the normal equations of the nodes at a given
//! level and b = sum p^2 f over the pins of precision p, the nodes follow it by g = N^-1 b, and all is told of it by H =
//! sum p^2 f^2 - b g: the Schur complement of the equations of nodes and levels, which adds sigma^2 g H^-1 g^T.

use super::covariance::{Covariance, Reduced};
use super::normal::Normal;
use super::projection::Motion;
use crate::bordered::Placed;
use crate::observations::{Node, Observations};
use crate::points::dot;

/// Share of what the pins tell of a level below which nodes and level move together freely.
const FREE: f64 = 1e-9;

/// A level less what those before it say of it.
struct Conditional<const D: usize> {
    /// How much of each level it is.
    levels: Vec<f64>,
    /// Per pin, how much its value changes.
    shares: Vec<f64>,
    /// How the nodes follow it.
    follow: Motion<D>,
    /// How well it is told: over the variance of a measurement, one over its own.
    told: f64,
}

/// Adds what the levels of the pins add. `reduced` are the equations behind the covariance, of measurements with
/// deviation `sigma`.
pub(super) fn add_levels<const D: usize>(
    covariance: &mut Covariance<D>,
    observations: &Observations<D>,
    reduced: &Reduced<'_, D>,
    sigma: f64,
) {
    let all = observations.levels();
    if all.is_empty() {
        return;
    }
    let equations = Equations { observations, normal: reduced.normal(), joint: reduced.joint(), sigma };
    let beforehand = |a: &[f64], b: &[f64]| -> f64 {
        all.iter().zip(a.iter().zip(b)).map(|(level, (a, b))| level.precision.powi(2) * a * b).sum()
    };
    let mut done: Vec<Conditional<D>> = Vec::new();
    for (k, level) in all.iter().enumerate() {
        let mut levels = vec![0.0; all.len()];
        levels[k] = 1.0;
        let mut shares = level.shares.clone();
        let mut follow = equations.followed(&pulled(observations, &shares));
        for other in &done {
            let told_together = weighted(observations, &shares, &other.shares)
                - product(&pulled(observations, &other.shares), &follow)
                + beforehand(&levels, &other.levels);
            let factor = told_together / other.told;
            levels.iter_mut().zip(&other.levels).for_each(|(a, b)| *a -= factor * b);
            shares.iter_mut().zip(&other.shares).for_each(|(a, b)| *a -= factor * b);
            take_off(&mut follow, factor, &other.follow);
        }
        let pins = weighted(observations, &shares, &shares);
        let told =
            (pins - product(&pulled(observations, &shares), &follow)).max(FREE * pins) + beforehand(&levels, &levels);
        if told > 0.0 {
            done.push(Conditional { levels, shares, follow, told });
        }
    }
    for level in done {
        covariance.add_product(sigma * sigma / level.told, &level.follow, &level.follow);
    }
}

/// Sum of the products of shares over the pins, by their precisions.
fn weighted<const D: usize>(observations: &Observations<D>, a: &[f64], b: &[f64]) -> f64 {
    let pins = observations.pins().iter().zip(a.iter().zip(b));
    pins.map(|(pin, (a, b))| pin.precision.powi(2) * a * b).sum()
}

/// How pins whose values change by these shares pull at the nodes.
fn pulled<const D: usize>(observations: &Observations<D>, shares: &[f64]) -> Motion<D> {
    let (m, n) = (observations.receivers, observations.transmitters);
    let mut pull = Motion { receivers: vec![0.0; D * m], transmitters: vec![([0.0; D], 0.0); n] };
    for (pin, share) in observations.pins().iter().zip(shares) {
        let force = pin.precision.powi(2) * share;
        match pin.node {
            Node::Receiver(i) => pull.receivers[D * i + pin.axis] += force,
            Node::Transmitter(j) => pull.transmitters[j].0[pin.axis] += force,
        }
    }
    pull
}

/// The normal equations of all nodes.
struct Equations<'a, const D: usize> {
    observations: &'a Observations<D>,
    normal: &'a Normal<D>,
    /// The covariance of all coordinates of the receivers, by rows.
    joint: Vec<f64>,
    sigma: f64,
}

impl<const D: usize> Equations<'_, D> {
    /// How nodes follow a pull: the solution of the equations.
    fn followed(&self, pull: &Motion<D>) -> Motion<D> {
        let Equations { observations, normal, sigma, .. } = *self;
        let size = pull.receivers.len();
        let mut reduced = pull.receivers.clone();
        let gains: Vec<Vec<Placed<D>>> =
            (0..observations.transmitters).map(|j| normal.gains(observations, j)).collect();
        // Per measurement of a transmitter: how that follows, the ray, and the place of the receiver's coordinates.
        let ways = |j: usize| {
            let rays = normal.rays()[observations.places(j)].iter().zip(observations.of_transmitter(j));
            gains[j].iter().zip(rays).map(|(gain, ((u, _), o))| (*gain, *u, D * o.receiver))
        };
        for (j, pull) in pull.transmitters.iter().enumerate() {
            for (gain, u, at) in ways(j) {
                let along = dot(gain.0, pull.0) + gain.1 * pull.1;
                (0..D).for_each(|k| reduced[at + k] += along * u[k]);
            }
        }
        let row = |k: usize| self.joint[k * size..(k + 1) * size].iter().zip(&reduced);
        let follow = |k: usize| row(k).map(|(a, b)| a * b).sum::<f64>() / (sigma * sigma);
        let receivers: Vec<f64> = (0..size).map(follow).collect();
        let follow = |(j, pull): (usize, &Placed<D>)| {
            let Some(factor) = normal.inverse_factor(j) else { return ([0.0; D], 0.0) };
            let mut sum = factor.invert(*pull);
            sum.1 = observations.of_offset(sum.1);
            for (gain, u, at) in ways(j) {
                let along: f64 = (0..D).map(|k| u[k] * receivers[at + k]).sum();
                (0..D).for_each(|k| sum.0[k] += along * gain.0[k]);
                sum.1 += along * gain.1;
            }
            sum
        };
        Motion { transmitters: pull.transmitters.iter().enumerate().map(follow).collect(), receivers }
    }
}

/// Product of two lists of all nodes.
fn product<const D: usize>(a: &Motion<D>, b: &Motion<D>) -> f64 {
    let of_receivers: f64 = a.receivers.iter().zip(&b.receivers).map(|(a, b)| a * b).sum();
    let transmitters = a.transmitters.iter().zip(&b.transmitters);
    of_receivers + transmitters.map(|(a, b)| dot(a.0, b.0) + a.1 * b.1).sum::<f64>()
}

/// Takes `factor` times a motion off another.
fn take_off<const D: usize>(from: &mut Motion<D>, factor: f64, motion: &Motion<D>) {
    from.receivers.iter_mut().zip(&motion.receivers).for_each(|(a, b)| *a -= factor * b);
    for (a, b) in from.transmitters.iter_mut().zip(&motion.transmitters) {
        (0..D).for_each(|k| a.0[k] -= factor * b.0[k]);
        a.1 -= factor * b.1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::covariance::covariance;
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::observations::{Level, Node, Observations, Pin};
    use crate::pseudoranges::Pseudoranges;
    use faer::Mat;
    use faer::linalg::solvers::DenseSolveCore;
    use hc::Monitor;

    /// Against the inverse of the equations of nodes and levels, by dense algebra.
    #[test]
    fn levels_are_unknowns() {
        let (m, n, sigma) = (7, 9, 0.02);
        let network: Network<3> = random(m, n, 5);
        let measured = Pseudoranges::new(m, n, network.pseudoranges()).unwrap();
        let nodes = (0..m).map(Node::Receiver).chain((0..n).map(Node::Transmitter));
        // All three axes, so that no rigid motion is left.
        let pin = |node, axis| Pin { node, axis, value: 0.0, precision: [0.7, 0.9, 2.0][axis] };
        let pins: Vec<Pin> = nodes.flat_map(|node| (0..3).map(move |axis| pin(node, axis))).collect();
        let share = |of: fn(Node) -> f64| -> Vec<f64> {
            pins.iter().map(|pin| if pin.axis == 2 { of(pin.node) } else { 0.0 }).collect()
        };
        let levels = [
            (share(|node| f64::from(u8::from(matches!(node, Node::Transmitter(_))))), 0.3),
            (share(|node| if let Node::Receiver(i) = node { [1.0, -1.0][i % 2] } else { 0.0 }), 0.5),
        ]
        .map(|(shares, precision)| Level { shares, precision });
        let observations = Observations::<3>::new(&measured, |_, _| true).pinned(&pins).levelled(levels.to_vec());

        let at = |node: Node| match node {
            Node::Receiver(i) => 3 * i,
            Node::Transmitter(j) => 3 * m + 4 * j,
        };
        let nodes = 3 * m + 4 * n;
        let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
        for o in observations.all() {
            let (r, s) = (network.receivers[o.receiver], network.transmitters[o.transmitter]);
            let (i, j) = (at(Node::Receiver(o.receiver)), at(Node::Transmitter(o.transmitter)));
            let u = |axis: usize| (s[axis] - r[axis]) / network.distance(o.receiver, o.transmitter);
            let ray = (0..3).flat_map(|axis| [(i + axis, -u(axis)), (j + axis, u(axis))]);
            rows.push(ray.chain([(j + 3, 1.0)]).collect());
        }
        for (k, pin) in pins.iter().enumerate() {
            let own = (at(pin.node) + pin.axis, pin.precision);
            let of_levels = levels.iter().enumerate().map(|(l, level)| (nodes + l, -pin.precision * level.shares[k]));
            rows.push([own].into_iter().chain(of_levels).collect());
        }
        rows.extend(levels.iter().enumerate().map(|(l, level)| vec![(nodes + l, level.precision)]));
        let mut jacobian = Mat::<f64>::zeros(rows.len(), nodes + levels.len());
        for (k, row) in rows.iter().enumerate() {
            row.iter().for_each(|(column, value)| jacobian[(k, *column)] += value);
        }
        let wanted = (jacobian.transpose() * &jacobian).partial_piv_lu().inverse();
        let found = covariance(&observations, &network, sigma, &Monitor::default()).unwrap().unwrap();
        let close = |found: f64, a: usize, b: usize| {
            let wanted = sigma * sigma * wanted[(a, b)];
            assert!((found - wanted).abs() < 1e-9 * sigma * sigma, "{a} {b}: {found} {wanted}");
        };
        for a in 0..3 * m {
            (0..3 * m).for_each(|b| close(found.joint[a * 3 * m + b], a, b));
            close(found.receivers[a / 3][a % 3][a % 3], a, a);
        }
        for (j, of) in found.transmitters.iter().enumerate() {
            let (at, of) = (at(Node::Transmitter(j)), of.unwrap());
            (0..3).for_each(|a| (0..3).for_each(|b| close(of.rows[a][b], at + a, at + b)));
            (0..3).for_each(|a| close(of.border[a], at + 3, at + a));
            close(of.corner, at + 3, at + 3);
        }
    }
}
