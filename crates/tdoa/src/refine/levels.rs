//! What it adds to a covariance that the values of pins are not known well.
//!
//! A level h changes the values of pins with shares f together. With N the normal equations of the nodes at a given
//! level and b = sum p^2 f over the pins of precision p, the nodes follow it by g = N^-1 b, and all is told of it by H =
//! sum p^2 f^2 - b g: the Schur complement of the equations of nodes and levels, which adds sigma^2 g H^-1 g^T.

use super::motion::Motion;
use super::normal::Normal;
use super::way::{Way, ways};
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

/// Motions of the nodes whose products with themselves, each by its factor, the levels of the pins add to a covariance.
/// `normal` are the equations behind that, of measurements with deviation `sigma`, and `joint` is the covariance of all
/// coordinates of the receivers and of clocks.
pub(super) fn motions_of_levels<const D: usize>(
    observations: &Observations<D>,
    normal: &Normal<D>,
    joint: &[f64],
    sigma: f64,
) -> Vec<(f64, Motion<D>)> {
    let all = observations.levels();
    let equations = Equations { observations, normal, joint, sigma };
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
                - pulled(observations, &other.shares).product(&follow)
                + beforehand(&levels, &other.levels);
            let factor = told_together / other.told;
            levels.iter_mut().zip(&other.levels).for_each(|(a, b)| *a -= factor * b);
            shares.iter_mut().zip(&other.shares).for_each(|(a, b)| *a -= factor * b);
            follow.take_off(factor, &other.follow);
        }
        let pins = weighted(observations, &shares, &shares);
        let told =
            (pins - pulled(observations, &shares).product(&follow)).max(FREE * pins) + beforehand(&levels, &levels);
        if told > 0.0 {
            done.push(Conditional { levels, shares, follow, told });
        }
    }
    done.into_iter().map(|level| (sigma * sigma / level.told, level.follow)).collect()
}

/// Sum of the products of shares over the pins, by their precisions.
fn weighted<const D: usize>(observations: &Observations<D>, a: &[f64], b: &[f64]) -> f64 {
    let pins = observations.pins().iter().zip(a.iter().zip(b));
    pins.map(|(pin, (a, b))| pin.precision.powi(2) * a * b).sum()
}

/// How pins whose values change by these shares pull at the nodes.
fn pulled<const D: usize>(observations: &Observations<D>, shares: &[f64]) -> Motion<D> {
    let n = observations.transmitters;
    let mut pull = Motion { reduced: vec![0.0; observations.reduced()], transmitters: vec![([0.0; D], 0.0); n] };
    for (pin, share) in observations.pins().iter().zip(shares) {
        let force = pin.precision.powi(2) * share;
        match pin.node {
            Node::Receiver(i) => pull.reduced[D * i + pin.axis] += force,
            Node::Transmitter(j) => pull.transmitters[j].0[pin.axis] += force,
        }
    }
    pull
}

/// The normal equations of all nodes.
struct Equations<'a, const D: usize> {
    observations: &'a Observations<D>,
    normal: &'a Normal<D>,
    /// The covariance of the reduced unknowns, by rows.
    joint: &'a [f64],
    sigma: f64,
}

impl<const D: usize> Equations<'_, D> {
    /// How nodes follow a pull: the solution of the equations.
    fn followed(&self, pull: &Motion<D>) -> Motion<D> {
        let Equations { observations, normal, sigma, .. } = *self;
        let size = pull.reduced.len();
        let mut right = pull.reduced.clone();
        let gains: Vec<Vec<Placed<D>>> =
            (0..observations.transmitters).map(|j| normal.gains(observations, j)).collect();
        let ways: Vec<Vec<Way<'_, D>>> =
            (0..observations.transmitters).map(|j| ways(observations, normal, j)).collect();
        for (j, pull) in pull.transmitters.iter().enumerate() {
            for (gain, way) in gains[j].iter().zip(&ways[j]) {
                way.spread(dot(gain.0, pull.0) + gain.1 * pull.1, &mut right);
            }
        }
        let row = |k: usize| self.joint[k * size..(k + 1) * size].iter().zip(&right);
        let follow = |k: usize| row(k).map(|(a, b)| a * b).sum::<f64>() / (sigma * sigma);
        let reduced: Vec<f64> = (0..size).map(follow).collect();
        let follow = |(j, pull): (usize, &Placed<D>)| {
            let Some(factor) = normal.inverse_factor(j) else { return ([0.0; D], 0.0) };
            let mut sum = factor.invert(*pull);
            sum.1 = observations.of_offset(sum.1);
            for (gain, way) in gains[j].iter().zip(&ways[j]) {
                let along = way.along(&reduced);
                (0..D).for_each(|k| sum.0[k] += along * gain.0[k]);
                sum.1 += along * gain.1;
            }
            sum
        };
        Motion { transmitters: pull.transmitters.iter().enumerate().map(follow).collect(), reduced }
    }
}
