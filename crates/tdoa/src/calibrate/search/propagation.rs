//! Which measurements are late is inferred from the other measurements (expectation propagation,
//! Minka 2001).
//!
//! Where few measurements are left over, the network bends to each of them, and residuals of late
//! measurements look like noise. Here each measurement is replaced by a normal distribution (its
//! site). Together with the sites of all other measurements, it has the mean and the variance of
//! the mixture. The network is then the mean of its distribution instead of the most likely one.
//! The sites hold the information that the measurements have while it is unknown which of them are
//! late.

use crate::calibrate::options::{CalibrateError, check};
use crate::calibrate::search::mixture::{LEAST_WEIGHT, Mixture};
use crate::network::Network;
use crate::observations::Observations;
use crate::refine::{Weighing, predicted_variances};
use hc::Monitor;

/// Turns at most, and share of what is new in each.
const TURNS: usize = 80;
const DAMPING: f64 = 0.5;

/// Change of the weights that ends the turns.
const CALM: f64 = 2e-3;

/// Share of its own site in what the network says of a measurement, at most.
const OWN: f64 = 0.999;

/// A network, its mixture, and what share of its information each measurement has.
#[derive(Debug, Clone)]
pub(crate) struct Propagated<const D: usize> {
    pub(crate) network: Network<D>,
    pub(crate) mixture: Mixture,
    pub(crate) weights: Vec<f64>,
}

/// From a network and a mixture near. The network stays where it is unless it `moves`. `None` where
/// nothing comes of it.
pub(crate) fn propagated<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    mixture: Mixture,
    known: Option<f64>,
    least: f64,
    moves: bool,
    monitor: &Monitor,
) -> Result<Option<Propagated<D>>, CalibrateError<D>> {
    let mut weighing = Weighing::new(observations, monitor);
    let (mut network, mut mixture) = (network.clone(), mixture);
    mixture.deviation = known.unwrap_or(mixture.deviation);
    let mut sites: Vec<(f64, f64)> = (observations.all().iter())
        .map(|o| {
            let e = o.residual(&network);
            let weight = mixture.on_time(e).max(LEAST_WEIGHT);
            (weight, e - mixture.score(e) / weight * mixture.deviation)
        })
        .collect();
    for _ in 0..TURNS {
        check(monitor)?;
        let weights: Vec<f64> = sites.iter().map(|site| site.0).collect();
        let trusted = observations.trusted(&weights).at_deviation(mixture.deviation);
        let Some(variances) = predicted_variances(&trusted, &network, monitor)? else { return Ok(None) };
        if moves {
            let targets: Vec<f64> = sites.iter().map(|site| site.1).collect();
            let Some(next) = weighing.step(&network, &weights, &targets, mixture.deviation)?.filter(Network::is_finite)
            else {
                return Ok(None);
            };
            network = next;
        }
        let cavities: Vec<(f64, f64)> = (observations.all().iter().zip(&sites).zip(&variances))
            .map(|((o, &(weight, target)), variance)| {
                let e = o.residual(&network);
                let variance = variance.map_or(0.0, |v| v * o.precision * o.precision).max(0.0);
                let own = (weight * variance).min(OWN);
                ((e - own * target) / (1.0 - own), own / weight / (1.0 - own))
            })
            .collect();
        let mut change = 0.0f64;
        for (site, &(e, variance)) in sites.iter_mut().zip(&cavities) {
            let (weight, target) = mixture.site(e, variance);
            let sum = (1.0 - DAMPING) * site.0 * site.1 + DAMPING * weight * target;
            let mean = (1.0 - DAMPING) * site.0 + DAMPING * weight;
            change = change.max((mean - site.0).abs());
            *site = (mean, sum / mean);
        }
        let next = mixture.updated_by(&cavities, known, least);
        let calm = (next.deviation - mixture.deviation).abs() < 1e-3 * mixture.deviation;
        mixture = next;
        if calm && change < CALM {
            break;
        }
    }
    let weights = sites.into_iter().map(|site| site.0).collect();
    Ok(Some(Propagated { network, mixture, weights }).filter(|found| found.network.is_finite()))
}
