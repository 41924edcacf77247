//! Networks ranked by the measurements that they explain.
//!
//! The search minimises the Cauchy loss. It pulls a network towards the truth from afar, but its
//! cost keeps growing with a gross error: an error of 360 standard deviations costs 28 units of
//! log-likelihood, an error of 10 costs 8. A wrong network whose outlier is smaller can therefore
//! beat the truth. Where the noise is known, networks are ranked instead by the sum of min(e^2/2,
//! h) over residuals e in standard deviations, after least squares over the measurements that cost
//! less than h.

use crate::network::Network;
use crate::observations::Observations;
use crate::refine::{Cancelled, NetworkRefiner, RefineOptions, RefinedNetwork, SEARCH, check};
use hc::Monitor;

use crate::calibrate::search::same_network::same;

/// What an outlier costs, whatever its size (units of log-likelihood). It is what a gross error
/// costs that hits one measurement in a thousand and is uniform over ten thousand standard
/// deviations: ln(1e4/1e-3) less ln(2 pi)/2, about 15. Costs from 5 to 18 find the truth about as
/// often; below 10, networks that leave one more measurement out would pass for alternatives.
pub(crate) const OUTLIER_COST: f64 = 15.0;

/// Multiples of the deviation of the measurements at which a network that is bent by an error is fitted, one after
/// the other: what belongs to the error looks like outliers at first.
const ANNEALED: [f64; 5] = [100.0, 30.0, 10.0, 3.0, 1.0];

/// Those of these multiples that are at most `widest`.
pub(crate) fn annealed(widest: f64) -> &'static [f64] {
    &ANNEALED[ANNEALED.partition_point(|factor| *factor > widest)..]
}

/// Rounds of choosing inliers and fitting them.
const ROUNDS: usize = 8;

/// Cost of a residual in standard deviations: min(e^2/2, h).
pub(crate) fn truncated(e: f64) -> f64 {
    (0.5 * e.powi(2)).min(OUTLIER_COST)
}

/// Measurements farther off than this many deviations cost as much as outliers.
pub(crate) fn truncated_at() -> f64 {
    (2.0 * OUTLIER_COST).sqrt()
}

/// Sum of min(e^2/2, h) over the residuals e of a network in standard deviations, and the cost of what is known of
/// clocks and distances; `deviation` is that of the measurements.
pub(crate) fn truncated_cost<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    deviation: f64,
) -> f64 {
    let of_cells: f64 = observations.all().iter().map(|o| truncated(o.residual(network) / deviation)).sum();
    of_cells + observations.misfit(network, true)
}

/// The networks with truncated costs as objectives, least first. The best ones are refitted to
/// their inliers. If the refit carries several networks to the same one, the first is kept.
pub(crate) fn rank<const D: usize>(
    observations: &Observations<D>,
    mut networks: Vec<RefinedNetwork<D>>,
    deviation: f64,
    margin: f64,
    monitor: &Monitor,
) -> Result<Vec<RefinedNetwork<D>>, Cancelled> {
    let mut least = f64::INFINITY;
    for refined in &mut networks {
        refined.objective = truncated_cost(observations, &refined.network, deviation);
        least = least.min(refined.objective);
    }
    if networks.len() < 2 {
        return Ok(networks);
    }
    let mut kept: Vec<(Network<D>, RefinedNetwork<D>)> = Vec::new();
    for mut refined in networks.into_iter().filter(|refined| refined.objective <= least + 4.0 * margin) {
        let (network, cost) = refit(observations, &refined.network, deviation, monitor)?;
        refined.objective = cost;
        match kept.iter_mut().find(|(other, _)| same(other, &network)) {
            Some((_, first)) => first.starts = first.starts.max(refined.starts),
            None => kept.push((network, refined)),
        }
    }
    let mut ranked: Vec<RefinedNetwork<D>> = kept.into_iter().map(|(_, refined)| refined).collect();
    ranked.sort_by(|a, b| a.objective.total_cmp(&b.objective));
    Ok(ranked)
}

/// The network of least truncated cost near a given one, with that cost: least squares over the
/// inliers until they stay the same.
pub(crate) fn refit<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    deviation: f64,
    monitor: &Monitor,
) -> Result<(Network<D>, f64), Cancelled> {
    let limit = truncated_at() * deviation;
    let options = RefineOptions { scale: Some(deviation), steps: 20, rounds: 0, tolerance: 1e-9, ..SEARCH };
    let mut best = (network.clone(), truncated_cost(observations, network, deviation));
    for _ in 0..ROUNDS {
        let inliers = observations.subset(|o| o.residual(&best.0).abs() <= limit);
        let fitted = NetworkRefiner::new(&inliers, f64::INFINITY, monitor).refine(best.0.clone(), &options).network;
        check(monitor)?;
        let cost = truncated_cost(observations, &fitted, deviation);
        // Each round lowers the cost or leaves the inliers as they are.
        let gain = best.1 - cost;
        if gain > 0.0 && fitted.is_finite() {
            best = (fitted, cost);
        }
        if gain.is_nan() || gain < 1e-6 {
            break;
        }
    }
    Ok(best)
}

/// [`refit`] at these multiples of the deviation, one after the other.
pub(crate) fn refit_annealed<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    factors: &[f64],
    deviation: f64,
    monitor: &Monitor,
) -> Result<(Network<D>, f64), Cancelled> {
    let mut now = (network.clone(), f64::INFINITY);
    for factor in factors {
        now = refit(observations, &now.0, factor * deviation, monitor)?;
    }
    Ok(now)
}

#[cfg(test)]
mod tests {
    use super::{OUTLIER_COST, rank, refit, truncated_cost};
    use crate::observations::Observations;
    use crate::pseudoranges::Pseudoranges;
    use crate::refine::RefinedNetwork;
    use crate::simulate::{SimulateOptions, simulate};
    use hc::Monitor;

    const SIGMA: f64 = 0.01;

    fn measured(seed: u64) -> (Pseudoranges, crate::Network) {
        let options = SimulateOptions { receivers: 8, transmitters: 10, noise: SIGMA, seed, ..Default::default() };
        let simulation = simulate(&options).unwrap();
        let mut values = simulation.pseudoranges.dense();
        values[17] += 360.0 * SIGMA;
        (Pseudoranges::new(8, 10, values).unwrap(), simulation.network)
    }

    #[test]
    fn an_outlier_costs_the_same_whatever_its_size() {
        let (pseudoranges, truth) = measured(1);
        let observations = Observations::new(&pseudoranges, |_, _| true);
        let inliers: f64 = (observations.all().iter().map(|o| o.residual(&truth)))
            .filter(|e| e.abs() < 5.0 * SIGMA)
            .map(|e| 0.5 * (e / SIGMA).powi(2))
            .sum();
        let cost = truncated_cost(&observations, &truth, SIGMA);
        // Of 80 normal residuals none is expected beyond 4.4 deviations.
        assert!((cost - inliers - OUTLIER_COST).abs() < 1e-9, "{cost} {inliers}");
    }

    #[test]
    fn a_refit_is_least_squares_without_the_outlier() {
        for seed in 0..20 {
            let (pseudoranges, truth) = measured(seed);
            let observations = Observations::new(&pseudoranges, |_, _| true);
            let (network, cost) = refit(&observations, &truth, SIGMA, &Monitor::default()).unwrap();
            assert!(cost <= truncated_cost(&observations, &truth, SIGMA));
            // 79 measurements less 16 + 30 - 3 unknowns: half of chi-squared with 36 degrees of
            // freedom, 99.9 % of which is below 68.
            assert!(cost - OUTLIER_COST < 34.0, "seed {seed}: {cost}");
            let outlier = observations.of_receiver(1).find(|o| o.transmitter == 7).unwrap();
            assert!(outlier.residual(&network) > 300.0 * SIGMA, "seed {seed}");
        }
    }

    #[test]
    fn a_large_outlier_does_not_outweigh_a_bad_fit() {
        let (pseudoranges, truth) = measured(2);
        let observations = Observations::new(&pseudoranges, |_, _| true);
        let mut wrong = truth.clone();
        // Most of the eight measurements of this transmitter are then wrong by much more than the
        // noise, and no refit of these reaches back.
        wrong.transmitters[3] = [60.0, -40.0];
        let refined = |network| RefinedNetwork { network, scale: SIGMA, objective: 0.0, starts: 1 };
        let networks = vec![refined(wrong), refined(truth.clone())];
        let ranked = rank(&observations, networks, SIGMA, 8.0, &Monitor::default()).unwrap();
        assert_eq!((ranked.len(), &ranked[0].network), (1, &truth), "the wrong one is no alternative");
    }
}
