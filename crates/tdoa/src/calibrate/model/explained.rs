//! How much of what does not fit in the plane errors of receivers explain there: that is no reason for heights.

use crate::calibrate::receivers::errors::{ReceiverErrorKind, price};
use crate::calibrate::report::calibration::Calibration;
use crate::pseudoranges::Pseudoranges;
use crate::refine::log_density;

/// How much more likely the measurements are once the errors of receivers are taken out of a network (natural
/// logarithm), less the price of these.
pub(super) fn explained_by_errors<const D: usize>(
    measured: &Pseudoranges,
    with_errors: &Calibration<D>,
    without: &Calibration<D>,
) -> f64 {
    let mut residuals = [Vec::new(), Vec::new()];
    for (i, j, residual) in without.residuals.iter() {
        let Some(other) = with_errors.residuals.get(i, j) else { continue };
        let precision = 1.0 / measured.sigma(i, j).unwrap_or(1.0);
        for (all, length) in residuals.iter_mut().zip([other.length, residual.length]) {
            all.push((length * precision, precision));
        }
    }
    let count = residuals[0].len();
    let unknowns = count.saturating_sub(without.redundancy.max(1));
    let width = without.extent().unwrap_or(1.0);
    let known = Some(with_errors.sigma).filter(|_| !with_errors.sigma_estimated);
    let density = |all: Vec<(f64, f64)>| log_density(&all, unknowns, with_errors.sigma, known, width);
    let [bent, straight] = residuals.map(density);
    let (receivers, errors) = (without.receivers.iter().flatten().count(), &without.receiver_errors);
    let are_delays = errors.iter().all(|error| error.kind == ReceiverErrorKind::Delay && error.taken_out);
    let price = price(errors.len(), are_delays && errors.len() == receivers, receivers, count);
    (straight - bent - price).max(0.0)
}
