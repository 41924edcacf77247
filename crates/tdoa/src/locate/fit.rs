//! The place of one transmitter, its covariance, and its rivals.

use std::array::from_fn;

use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::place::{OtherPlace, Place, Unplaced};
use super::starts::minima;
use crate::bordered::Bordered;
use crate::loss::{CAUCHY, Loss};
use crate::median::median;
use crate::multilateration::{Located, Sight, polish};
use crate::points::{distance, dot, minus};

/// What a measurement that does not agree costs, in natural logarithms of likelihood: one in twenty is wrong, by anything up to
/// five hundred deviations to either side, so that it is -ln(0.05 sqrt(2 pi) / 1000).
const WRONG: f64 = 9.0;

/// How much less likely another place may be to count beside the likeliest: half the 99.9 % quantile of chi-squared with one
/// degree of freedom.
const MARGIN: f64 = 5.4;

/// Deviations within which two places are one.
const SAME: f64 = 4.0;

/// Probability up to which residuals of measurements that agree are no larger than by chance.
const CHANCE: f64 = 0.9999;

/// Rounds of fitting the measurements that agree, and of telling which do.
const ROUNDS: usize = 6;

/// Least squares of the measurements that agree.
const SQUARES: Loss = Loss { nu: f64::INFINITY, scale: 1.0 };

/// A measurement of the transmitter.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heard<const D: usize> {
    /// Its place among those measured.
    pub(super) receiver: usize,
    pub(super) position: [f64; D],
    /// Metres, with the transmitter's offset in it where that is unknown.
    pub(super) length: f64,
    /// Standard deviation, metres: of the measurement and of the receiver's place.
    pub(super) deviation: f64,
}

/// The place of a transmitter; where measurements are ranges, it has no offset.
pub(super) fn place<const D: usize>(
    heard: &[Heard<D>],
    is_range: bool,
    is_unique: bool,
    name: impl Fn(usize) -> String,
) -> Result<Place<D>, Unplaced> {
    let unknowns = D + usize::from(!is_range);
    if heard.len() < unknowns {
        return Err(Unplaced::TooFew { heard: heard.len(), least: unknowns });
    }
    let typical = median(heard.iter().map(|heard| heard.deviation).collect()).ok_or(Unplaced::Degenerate)?;
    let sights = sights(heard, typical);
    let found = minima(&sights, is_range, &Loss { nu: 1.0, scale: CAUCHY * typical });
    let mut fitted: Vec<Fitted<D>> =
        found.into_iter().filter_map(|start| Fitted::new(heard, start, is_range)).collect();
    fitted.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let best = fitted.first().ok_or(Unplaced::Degenerate)?;
    let mut others: Vec<OtherPlace<D>> = Vec::new();
    for other in &fitted[1..] {
        let loss = other.cost - best.cost;
        let near = |position: [f64; D], of: f64| distance(position, other.located.position) <= SAME * of;
        let is_new = !near(best.located.position, best.deviation())
            && others.iter().all(|known| !near(known.position, other.deviation()));
        if loss <= MARGIN && is_new {
            let Located { position, offset, .. } = other.located;
            others.push(OtherPlace { position, offset, log_likelihood_loss: loss });
        }
    }
    let agreeing = heard.len() - best.outliers.len();
    let redundancy = agreeing - unknowns;
    // Without redundancy, left out measurements would make anything agree.
    let is_chance = ChiSquared::new(redundancy as f64).is_ok_and(|of| best.squares <= of.inverse_cdf(CHANCE));
    let fits = if redundancy == 0 { best.outliers.is_empty() } else { is_chance && 2 * agreeing > heard.len() };
    let sum: f64 = best.residuals(heard).map(|(_, residual)| residual * residual).sum();
    Ok(Place {
        position: best.located.position,
        position_std: from_fn(|k| best.covariance[k][k].sqrt()),
        covariance: best.covariance,
        offset: best.located.offset,
        offset_std: if is_range { 0.0 } else { best.offset_variance.sqrt() },
        outliers: best.outliers.iter().map(|&k| name(heard[k].receiver)).collect(),
        redundancy,
        residual_rms: (sum / agreeing as f64).sqrt(),
        fits,
        unique: fits && others.is_empty() && is_unique,
        others,
    })
}

/// Measurements by which a place is sought.
fn sights<const D: usize>(heard: &[Heard<D>], typical: f64) -> Vec<Sight<D>> {
    let sight = |heard: &Heard<D>| Sight {
        position: heard.position,
        length: heard.length,
        precision: typical / heard.deviation,
    };
    heard.iter().map(sight).collect()
}

/// A place that is fitted to the measurements that agree with it.
struct Fitted<const D: usize> {
    located: Located<D>,
    covariance: [[f64; D]; D],
    offset_variance: f64,
    /// Measurements that do not agree.
    outliers: Vec<usize>,
    /// Sum of the squares of those that do, in their deviations.
    squares: f64,
    /// Negative logarithm of the likelihood.
    cost: f64,
}

impl<const D: usize> Fitted<D> {
    /// Fits a place; `None` if it is not determined by what agrees with it, or is nowhere.
    fn new(heard: &[Heard<D>], start: Located<D>, is_range: bool) -> Option<Fitted<D>> {
        let mut located = start;
        let mut outliers = disagreeing(heard, &located);
        for _ in 0..ROUNDS {
            let agreeing: Vec<Heard<D>> =
                (0..heard.len()).filter(|k| !outliers.contains(k)).map(|k| heard[k]).collect();
            if agreeing.len() < D + usize::from(!is_range) {
                return None;
            }
            let cost = agreeing.iter().map(|heard| 0.5 * ratio(heard, &located).powi(2)).sum();
            located = polish(&sights(&agreeing, 1.0), Located { cost, ..located }, !is_range, &SQUARES);
            let now = disagreeing(heard, &located);
            if now == outliers {
                break;
            }
            outliers = now;
        }
        let agreeing = heard.len().checked_sub(outliers.len()).filter(|left| *left >= D + usize::from(!is_range))?;
        let mut normal = Bordered::ZERO;
        for heard in (0..heard.len()).filter(|k| !outliers.contains(k)).map(|k| &heard[k]) {
            let delta = minus(located.position, heard.position);
            let length = dot(delta, delta).sqrt();
            if length > 0.0 {
                let row = delta.map(|x| x / length / heard.deviation);
                normal.add_product(1.0, &(row, 1.0 / heard.deviation), &(row, 1.0 / heard.deviation));
            }
        }
        if is_range {
            (normal.border, normal.corner) = ([0.0; D], 1.0);
        }
        let factor = normal.cholesky(1.0, 0.0)?;
        let unit = |k: usize| factor.solve((from_fn(|l| f64::from(u8::from(k == l))), f64::from(u8::from(k == D))));
        let covariance: [[f64; D]; D] = from_fn(|k| unit(k).0);
        let offset_variance = unit(D).1;
        let told = covariance.iter().flatten().chain([&offset_variance]).all(|x| x.is_finite());
        let squares: f64 =
            (0..heard.len()).filter(|k| !outliers.contains(k)).map(|k| ratio(&heard[k], &located).powi(2)).sum();
        let cost = 0.5 * squares + WRONG * (heard.len() - agreeing) as f64;
        (told && cost.is_finite()).then_some(Fitted { located, covariance, offset_variance, outliers, squares, cost })
    }

    /// The residuals of the measurements that agree, metres.
    fn residuals<'a>(&'a self, heard: &'a [Heard<D>]) -> impl Iterator<Item = (usize, f64)> + 'a {
        let agrees = move |k: &usize| !self.outliers.contains(k);
        (0..heard.len()).filter(agrees).map(|k| (k, ratio(&heard[k], &self.located) * heard[k].deviation))
    }

    /// The largest standard deviation of a coordinate, metres.
    fn deviation(&self) -> f64 {
        (0..D).map(|k| self.covariance[k][k]).fold(0.0, f64::max).sqrt()
    }
}

/// The residual of a measurement in its deviations.
fn ratio<const D: usize>(heard: &Heard<D>, located: &Located<D>) -> f64 {
    (heard.length - located.offset - distance(heard.position, located.position)) / heard.deviation
}

/// Measurements that are less likely with this place than wrong ones are.
fn disagreeing<const D: usize>(heard: &[Heard<D>], located: &Located<D>) -> Vec<usize> {
    // A place that is none agrees with nothing.
    let agrees = |k: usize| 0.5 * ratio(&heard[k], located).powi(2) <= WRONG;
    (0..heard.len()).filter(|&k| !agrees(k)).collect()
}
