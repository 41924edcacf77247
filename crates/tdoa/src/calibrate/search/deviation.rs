//! The deviation of the measurements, from the residuals of a network.

use crate::median::median;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;

/// Median of the deviations that measurements carry; 1 where they carry none.
pub(crate) fn typical_deviation(measured: &Pseudoranges) -> f64 {
    let cells = (0..measured.receivers()).flat_map(|i| (0..measured.transmitters()).map(move |j| (i, j)));
    median(cells.filter_map(|(i, j)| measured.sigma(i, j)).collect()).unwrap_or(1.0)
}

/// Deviation of the residuals that are within `threshold` of it, corrected for the unknowns,
/// repeated until it stays the same.
pub(crate) fn inlier_deviation<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    first: f64,
    threshold: f64,
) -> f64 {
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
        // Without the floor, exact data would shrink the limit to nothing and lose inliers to
        // rounding.
        let next = (sum / redundancy as f64).sqrt().max(0.1 * first);
        if (next - deviation).abs() < 1e-6 * deviation {
            return next;
        }
        deviation = next;
    }
    deviation
}

/// Median magnitude of the residuals.
pub(crate) fn median_size<const D: usize>(observations: &Observations<D>, network: &Network<D>) -> f64 {
    median(observations.all().iter().map(|o| o.residual(network).abs()).collect()).unwrap_or(0.0)
}

/// A guess of the deviation from the middle half of the residuals, corrected for the unknowns.
pub(crate) fn spread_of_residuals<const D: usize>(observations: &Observations<D>, network: &Network<D>) -> f64 {
    let (count, unknowns) = (observations.len() as f64, observations.unknowns() as f64);
    // The median magnitude of a normal variable is 0.6745 deviations.
    median_size(observations, network) / 0.6745 * (count / (count - unknowns).max(1.0)).sqrt()
}

/// Spread of the residuals of one receiver about zero, from the smaller seven tenths of them.
pub(crate) fn spread_of_receiver<const D: usize>(
    observations: &Observations<D>,
    network: &Network<D>,
    receiver: usize,
) -> f64 {
    let mut sizes: Vec<f64> = observations.of_receiver(receiver).map(|o| o.residual(network).abs()).collect();
    sizes.sort_by(f64::total_cmp);
    // Seven tenths of a normal variable are within 1.0364 deviations.
    sizes.get(sizes.len() * 7 / 10).map_or(0.0, |size| size / 1.0364)
}
