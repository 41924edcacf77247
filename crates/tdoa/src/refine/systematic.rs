//! Systematic errors: those that the measurements of a receiver share, and what they do to the nodes.
//!
//! The covariance of least squares takes the errors of all measurements as independent. Those of real
//! receivers are not: a microphone has a delay, hears with its rim, or stands beside a reflecting wall,
//! and its errors change smoothly with the direction from which a sound comes. More measurements make
//! the noise smaller, but not these.
//!
//! # The model
//!
//! The error of receiver i along the unit vector u to a transmitter is noise plus h(u) . a_i. The shapes
//! h are the constant, the coordinates of u and its trace-free quadratic forms, D + D (D + 1) / 2 of
//! them. Each of the three degrees has the same share of the variance in every direction. The
//! coefficients a_i are independent, with the same variance tau^2 for all receivers.
//!
//! The coordinates of u are what a motion of the receiver makes of its measurements. Residuals do not
//! show such an error, and it moves the receiver by all of its size. That is why it is in the model: it
//! is taken to be as large as the constant and the quadratic forms, which residuals do show. A covariance
//! clustered by receiver has no such assumption, and no such errors either: the motion makes the scores
//! of a receiver zero in its own coordinates.
//!
//! # The estimate
//!
//! tau^2 maximises the restricted likelihood of the residuals e = M (noise + Z a), where M takes off what
//! motions of the nodes make (Patterson and Thompson 1971). With the eigenvalues l_k of Z' M Z, the
//! components y_k of e along the eigenvectors, p measurements left over and g = tau^2 / sigma^2,
//!
//! ```text
//! -2 log-likelihood = sum ln(1 + g l_k) + p ln(e'e - sum y_k^2 g l_k / (1 + g l_k)),
//! ```
//!
//! up to a constant, with sigma^2 at its best. A motion K Z a of the nodes then adds tau^2 K Z Z' K' to the
//! covariance.

use faer::linalg::solvers::Llt;
use faer::prelude::Solve;
use faer::{Mat, Side};
use hc::Monitor;
use smallvec::SmallVec;
use std::array::from_fn;

use super::cancel::{Cancelled, apart, check};
use super::motion::Motion;
use super::projection::{Projection, dot, gram};
use crate::network::Network;
use crate::observations::Observations;

/// Measurements that must be left over. With fewer the shapes explain any residuals.
const LEAST_REDUNDANCY: usize = 10;

/// Receivers above which nothing is estimated: the work of the decomposition grows with their cube.
const MOST_RECEIVERS: usize = 100;

/// Coefficients from which on the decomposition takes some time.
const LONG: usize = 400;

/// Smallest and largest tau over sigma, as natural logarithms of the squares: a thirtieth and a hundred.
const RANGE: [f64; 2] = [-6.9, 9.2];

/// Values of that logarithm that are tried first, and steps of the search between two of them.
const TRIED: usize = 81;
const STEPS: usize = 40;

/// Eigenvalues below this share of the largest square of a shape are rounding.
const ROUNDING: f64 = 1e-9;

/// The systematic errors of the receivers, and what they do to a network.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Systematic<const D: usize = 2> {
    /// Their standard deviation, metres.
    pub(crate) deviation: f64,
    /// How much more likely the measurements are with them (natural logarithm).
    pub(crate) gain: f64,
    /// What they add to the covariances of the receivers, metres squared.
    pub(crate) receivers: Vec<[[f64; D]; D]>,
    /// What they add to the covariances of the transmitters, metres squared.
    pub(crate) transmitters: Vec<[[f64; D]; D]>,
}

/// Shapes of the error of a receiver along a unit vector: the constant, the coordinates, and an
/// orthonormal basis of the trace-free quadratic forms. The squares of each degree sum up to a third.
fn shapes<const D: usize>(u: [f64; D]) -> SmallVec<[f64; 9]> {
    let third = (1.0f64 / 3.0).sqrt();
    // The squares of the quadratic forms sum up to 1 - 1/D.
    let scale = third / (1.0 - 1.0 / D as f64).sqrt();
    let mut all = SmallVec::new();
    all.push(third);
    all.extend(u.map(|x| third * x));
    let mut sum = 0.0;
    for (a, x) in u.into_iter().enumerate() {
        if a > 0 {
            let count = a as f64;
            all.push(scale * (sum - count * x * x) / (count * (count + 1.0)).sqrt());
        }
        all.extend(u[..a].iter().map(|y| scale * std::f64::consts::SQRT_2 * x * y));
        sum += x * x;
    }
    all
}

/// Errors that were estimated beside the network: their columns with what motions of the nodes make of
/// them, and the products of these.
struct Beside<'a, const D: usize> {
    columns: &'a [(Vec<f64>, Motion<D>)],
    products: Option<Llt<f64>>,
}

impl<const D: usize> Beside<'_, D> {
    /// Takes off what these errors make of a column.
    fn take_off(&self, (rest, motion): &mut (Vec<f64>, Motion<D>)) {
        let Some(products) = &self.products else { return };
        let along = Mat::from_fn(self.columns.len(), 1, |a, _| dot(&self.columns[a].0, rest));
        let sizes = products.solve(&along);
        for (a, (column, other)) in self.columns.iter().enumerate() {
            let size = sizes[(a, 0)];
            rest.iter_mut().zip(column).for_each(|(x, y)| *x -= size * y);
            motion.reduced.iter_mut().zip(&other.reduced).for_each(|(x, y)| *x -= size * y);
            for ((x, _), (y, _)) in motion.transmitters.iter_mut().zip(&other.transmitters) {
                x.iter_mut().zip(y).for_each(|(x, y)| *x -= size * y);
            }
        }
    }
}

/// Whether there are enough measurements left over, and few enough receivers, for systematic errors to be
/// estimated.
pub(crate) fn can_be_estimated(receivers: usize, redundancy: usize) -> bool {
    redundancy >= LEAST_REDUNDANCY && receivers <= MOST_RECEIVERS
}

/// The systematic errors of the receivers, at a network fitted to `observations`. `redundancy` of these
/// are left over, and `columns` are errors that were estimated beside the network, off which motions of the
/// nodes were taken. `None` where they [cannot be estimated](can_be_estimated), or the network cannot be
/// linearised.
pub(crate) fn systematic<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    redundancy: usize,
    projection: &Projection<'_, D>,
    columns: &[(Vec<f64>, Motion<D>)],
    monitor: &Monitor,
) -> Result<Option<Systematic<D>>, Cancelled> {
    let (m, n) = (observations.receivers, observations.transmitters);
    if !can_be_estimated(m, redundancy) {
        return Ok(None);
    }
    let products = if columns.is_empty() { None } else { gram(columns, monitor)? };
    if products.is_none() && !columns.is_empty() {
        return Ok(None);
    }
    let beside = Beside { columns, products };
    let off = |values: &[f64]| {
        let mut found = projection.off(values);
        beside.take_off(&mut found);
        found
    };
    let all = observations.all();
    let residuals: Vec<f64> = all.iter().map(|o| o.residual(network)).collect();
    let (rest, _) = off(&residuals);
    let mut rows = vec![Vec::new(); m];
    for (k, o) in all.iter().enumerate() {
        rows[o.receiver].push(k);
    }
    let weighted = |k: usize| shapes(projection.ray(k)).into_iter().map(move |h| all[k].precision * h);
    let values: Vec<f64> = (0..all.len()).flat_map(weighted).collect();
    let each = D + D * (D + 1) / 2;
    let size = each * m;
    // Z' of a list of values.
    let along = |list: &[f64]| -> Vec<f64> {
        let one = |row: &Vec<usize>, h: usize| row.iter().map(|&k| values[each * k + h] * list[k]).sum();
        rows.iter().flat_map(|row| (0..each).map(move |h| one(row, h))).collect()
    };
    let mut inner = Mat::<f64>::zeros(size, size);
    let (mut receivers, mut transmitters) = (vec![[[0.0; D]; D]; m], vec![[[0.0; D]; D]; n]);
    let mut largest = 0.0f64;
    for (b, (row, h)) in rows.iter().flat_map(|row| (0..each).map(move |h| (row, h))).enumerate() {
        check(monitor)?;
        let mut column = vec![0.0; all.len()];
        row.iter().for_each(|&k| column[k] = values[each * k + h]);
        largest = largest.max(dot(&column, &column));
        let (rest, motion) = off(&column);
        inner.col_as_slice_mut(b).copy_from_slice(&along(&rest));
        for (i, sum) in receivers.iter_mut().enumerate() {
            add_square(sum, &from_fn(|a| motion.reduced[D * i + a]));
        }
        transmitters.iter_mut().zip(&motion.transmitters).for_each(|(sum, (by, _))| add_square(sum, by));
    }
    let decomposed = apart(monitor, size >= LONG, move || inner.self_adjoint_eigen(Side::Lower))?;
    let Ok(eigen) = decomposed else { return Ok(None) };
    let (values, vectors, scores) = (eigen.S(), eigen.U().to_owned(), along(&rest));
    let visible = (0..size).filter(|&k| values[k] > ROUNDING * largest);
    let component = |k: usize| (values[k], dot(vectors.col_as_slice(k), &scores).powi(2) / values[k]);
    let likelihood = Likelihood {
        components: visible.map(component).collect(),
        square: dot(&rest, &rest),
        redundancy: redundancy as f64,
    };
    let typical = all.iter().map(|o| o.precision * o.precision).sum::<f64>() / all.len().max(1) as f64;
    let Some((ratio, gain)) = likelihood.best(typical) else { return Ok(None) };
    let variance = ratio * likelihood.noise(ratio);
    for c in receivers.iter_mut().chain(&mut transmitters) {
        *c = c.map(|row| row.map(|x| variance * x));
    }
    Ok(Some(Systematic { deviation: variance.sqrt(), gain, receivers, transmitters }))
}

fn add_square<const D: usize>(sum: &mut [[f64; D]; D], by: &[f64; D]) {
    for (row, x) in sum.iter_mut().zip(by) {
        row.iter_mut().zip(by).for_each(|(entry, y)| *entry += x * y);
    }
}

/// The restricted likelihood of the ratio g of both variances.
struct Likelihood {
    /// Eigenvalues, and squares of the residuals along their vectors.
    components: Vec<(f64, f64)>,
    /// Square of all residuals.
    square: f64,
    /// Measurements left over.
    redundancy: f64,
}

impl Likelihood {
    /// The likeliest variance of the noise.
    fn noise(&self, ratio: f64) -> f64 {
        let explained: f64 = self.components.iter().map(|(l, y)| y * ratio * l / (1.0 + ratio * l)).sum();
        (self.square - explained) / self.redundancy
    }

    /// The negative logarithm, up to a constant.
    fn cost(&self, ratio: f64) -> f64 {
        let logarithms: f64 = self.components.iter().map(|(l, _)| (ratio * l).ln_1p()).sum();
        0.5 * (logarithms + self.redundancy * self.noise(ratio).ln())
    }

    /// The likeliest ratio, and what it gains over 0; `None` where there are no residuals. `typical` is the
    /// mean square of the precisions.
    fn best(&self, typical: f64) -> Option<(f64, f64)> {
        let none = self.cost(0.0);
        let step = (RANGE[1] - RANGE[0]) / (TRIED - 1) as f64;
        let at = |x: f64| x.exp() / typical;
        let tried = (0..TRIED).map(|k| RANGE[0] + step * k as f64).map(|x| (x, self.cost(at(x))));
        let (near, _) = tried.min_by(|a, b| a.1.total_cmp(&b.1))?;
        // Golden section.
        let share = 0.5 * (5.0f64.sqrt() - 1.0);
        let (mut low, mut high) = ((near - step).max(RANGE[0]), (near + step).min(RANGE[1]));
        for _ in 0..STEPS {
            let (a, b) = (high - share * (high - low), low + share * (high - low));
            if self.cost(at(a)) <= self.cost(at(b)) { high = b } else { low = a }
        }
        let ratio = at(0.5 * (low + high));
        let gain = none - self.cost(ratio);
        if !(none.is_finite() && gain.is_finite()) {
            return None;
        }
        Some(if gain > 0.0 { (ratio, gain) } else { (0.0, 0.0) })
    }
}

#[cfg(test)]
mod tests;
