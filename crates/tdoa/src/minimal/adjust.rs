//! The candidate of least squares near a network that is known beforehand.

use super::check::check;
use super::error::MinimalError;
use super::normalised::Normalised;
use super::options::MinimalOptions;
use super::polish::NetworkPolisher;
use super::solution::Candidate;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, RefineOptions};

/// Damped steps of least squares without annealing. Ill-conditioned networks of the smallest sizes take
/// hundreds, because the damping shortens their steps.
const LEAST_SQUARES: RefineOptions = RefineOptions {
    scale: Some(1.0),
    anneal_from: None,
    anneal_factor: 0.5,
    by_leverage: false,
    floor: 0.0,
    steps: 2000,
    rounds: 0,
    tolerance: 1e-14,
    negligible: 0.0,
};

/// The network to which least squares leads from a known one, judged like those of the solvers: what they
/// should find if the measurements are those of a network near `start`.
///
/// Unlike the solvers it needs no real root near by. Where noise has made two real roots of a smallest size
/// complex, it ends between them, with a residual that is not zero. Where there is no minimum, because a node
/// moves away without end, it stops after 2,000 steps.
///
/// # Errors
/// If the matrix is too small or too large, a measurement is missing, two nodes coincide, or `start` is not
/// a finite network of this size.
pub fn adjust<const D: usize>(
    measured: &Pseudoranges,
    start: &Network<D>,
    options: &MinimalOptions,
) -> Result<Candidate<D>, MinimalError> {
    let measured = &measured.clone().with_emissions(options.emissions);
    check::<D>(measured)?;
    let (m, n) = (measured.receivers(), measured.transmitters());
    let sizes = [start.receivers.len(), start.transmitters.len(), start.offsets.len()];
    if sizes != [m, n, n] || !start.is_finite() {
        return Err(MinimalError::UnusableStart { configuration: measured.configuration() });
    }
    let data = Normalised::new(measured);
    let mut network = start.clone();
    data.enter(&mut network);
    // In the units of the data rounding does not depend on the offsets.
    let scaled = Pseudoranges::new(m, n, data.matrix.clone())
        .map_err(|_| MinimalError::UnusableStart { configuration: measured.configuration() })?;
    let scaled = scaled.with_emissions(options.emissions);
    let observations = Observations::<D>::new(&scaled, |_, _| true);
    let network = NetworkRefiner::new(&observations, f64::INFINITY, &hc::Monitor::default())
        .refine(network, &LEAST_SQUARES)
        .network;
    let mut candidate = data.candidate(network, options, &mut NetworkPolisher::default());
    data.restore(&mut candidate.network);
    candidate.residual = candidate.network.rms(measured);
    Ok(candidate)
}

#[cfg(test)]
mod tests {
    use super::adjust;
    use crate::accuracy::position_error;
    use crate::minimal::{MinimalError, MinimalOptions};
    use crate::network::Network;
    use crate::network::tests::random;
    use crate::pseudoranges::Pseudoranges;

    /// A start that differs from the truth by a part in a thousand and more.
    fn moved<const D: usize>(truth: &Network<D>) -> Network<D> {
        let mut start = truth.clone();
        for (k, x) in start.receivers.iter_mut().flatten().enumerate() {
            *x += 1e-3 * (k as f64).sin();
        }
        for offset in &mut start.offsets {
            *offset += 2e-3;
        }
        start
    }

    fn leads_back<const D: usize>(m: usize, n: usize) {
        let truth: Network<D> = random(m, n, 5);
        let measured = Pseudoranges::new(m, n, truth.pseudoranges()).unwrap();
        let found = adjust(&measured, &moved(&truth), &MinimalOptions::default()).unwrap();
        assert!(position_error(&moved(&truth), &truth) > 1e-4);
        let error = position_error(&found.network, &truth);
        assert!(found.physical && found.residual < 1e-10 && error < 1e-8, "{m}r/{n}s: {error} {found:?}");
    }

    #[test]
    fn exact_measurements_lead_back_to_the_truth() {
        leads_back::<2>(6, 3);
        leads_back::<2>(7, 5);
        leads_back::<3>(7, 5);
        leads_back::<3>(6, 6);
        leads_back::<3>(8, 5);
        leads_back::<3>(10, 4);
    }

    #[test]
    fn the_best_of_noisy_measurements_is_a_minimum() {
        let truth: Network<3> = random(9, 6, 3);
        let noisy = truth.pseudoranges().iter().enumerate().map(|(k, f)| f + 1e-3 * (7.0 * k as f64).sin()).collect();
        let measured = Pseudoranges::new(9, 6, noisy).unwrap();
        let options = MinimalOptions::default();
        let found = adjust(&measured, &truth, &options).unwrap();
        assert!(found.residual < truth.rms(&measured), "{found:?}");
        let again = adjust(&measured, &moved(&found.network), &options).unwrap();
        assert!(position_error(&again.network, &found.network) < 1e-6);
        for k in 0..3 {
            let mut beside = found.network.clone();
            beside.receivers[4][k] += 1e-4;
            assert!(beside.rms(&measured) > found.residual);
        }
    }

    #[test]
    fn another_size_is_refused() {
        let truth: Network<3> = random(7, 5, 5);
        let measured = Pseudoranges::new(7, 5, truth.pseudoranges()).unwrap();
        let refused = |start: &Network<3>| adjust(&measured, start, &MinimalOptions::default()).unwrap_err();
        let other = MinimalError::UnusableStart { configuration: "7r/5s".into() };
        assert_eq!(refused(&random(8, 5, 5)), other);
        let mut unknown = truth.clone();
        unknown.offsets[2] = f64::NAN;
        assert_eq!(refused(&unknown), other);
    }
}
