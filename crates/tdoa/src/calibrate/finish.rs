//! The last refinement, and the deviation of the noise that comes with it.

use super::options::{CalibrateError, CalibrateOptions, Control};
use super::search::distinct;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{RefineOptions, Refined, Refiner, SEARCH};

/// Scale of the Cauchy loss, in standard deviations, that is 95 % efficient on normal noise (Holland and Welsch 1977).
const CAUCHY: f64 = 2.385;

/// Median of the deviations that measurements carry; 1 where they carry none.
pub(super) fn typical_deviation(measured: &Pseudoranges) -> f64 {
    let cells = (0..measured.receivers()).flat_map(|i| (0..measured.transmitters()).map(move |j| (i, j)));
    let mut all: Vec<f64> = cells.filter_map(|(i, j)| measured.sigma(i, j)).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(1.0)
}

/// Refines all networks with the same fixed loss, which makes their objectives differences of log-likelihood, and puts
/// the best first. The deviation behind the loss is the given one or that of the inliers of the best network, in turns
/// with the refinement: the search's own scale is too small where few measurements are left over and too large where many
/// are outliers.
pub(super) fn finish(
    observations: &Observations,
    mut networks: Vec<Refined>,
    first: f64,
    known: bool,
    floor: f64,
    options: &CalibrateOptions,
    control: &Control<'_>,
) -> Result<(Vec<Refined>, f64), CalibrateError> {
    let mut refiner = Refiner::new(observations, 1.0).heeding(&control.monitor);
    let mut deviation = first;
    let turns = if known { 1 } else { 4 };
    for turn in 0..turns {
        let refine = RefineOptions {
            scale: Some(CAUCHY * deviation),
            anneal_from: None,
            floor,
            steps: if turn + 1 == turns { 100 } else { 15 },
            tolerance: if turn + 1 == turns { 1e-12 } else { 1e-6 },
            ..SEARCH
        };
        // The loss is c^2/2 ln(1 + (e/c)^2) in deviations e; the objective lacks the factor and has a constant.
        let constant = refiner.constant(CAUCHY * deviation);
        for network in &mut networks {
            *network = refiner.refine(std::mem::take(&mut network.network), &refine);
            network.objective = (network.objective - constant) * CAUCHY * CAUCHY / 2.0;
        }
        control.check()?;
        networks.sort_by(|a, b| a.objective.total_cmp(&b.objective));
        if !known && turn + 1 < turns {
            deviation = inlier_deviation(observations, &networks[0].network, deviation, options.inlier_threshold);
            deviation = deviation.max(floor);
        }
    }
    Ok((distinct(networks, 12), deviation))
}

/// Deviation of the residuals that are within `threshold` of it, corrected for the unknowns, repeated until it stays the
/// same.
pub(super) fn inlier_deviation(observations: &Observations, network: &Network, first: f64, threshold: f64) -> f64 {
    let mut deviation = first;
    for _ in 0..20 {
        let (mut sum, mut count) = (0.0, 0usize);
        for o in observations.all() {
            let e = o.residual(network);
            if e.abs() <= threshold * deviation {
                sum += e * e;
                count += 1;
            }
        }
        let redundancy = count.saturating_sub(observations.unknowns());
        if redundancy == 0 {
            return deviation;
        }
        // Without the floor, exact data would shrink the limit to nothing and lose inliers to rounding.
        let next = (sum / redundancy as f64).sqrt().max(0.1 * first);
        if (next - deviation).abs() < 1e-6 * deviation {
            return next;
        }
        deviation = next;
    }
    deviation
}
