//! Trials of the calibration on simulated networks: how far from the truth, compared with what the
//! noise allows.

use std::time::Instant;

use rand::seq::SliceRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use tdoa::Monitor;
use tdoa::Network;
use tdoa::Simulation;
use tdoa::accuracy::cramer_rao;
use tdoa::align::align;
use tdoa::calibrate::{
    CalibrateError, CalibrateOptions, Calibrates, Calibration, Dimension, KnownReceivers, SAME_NETWORK, calibrate,
    calibrate_with,
};
use tdoa::{PseudorangeError, Pseudoranges};

/// One calibration of a simulated network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trial {
    /// Seed of the simulation.
    pub seed: u64,
    /// Root mean square distance of the receivers from the truth after the best rigid alignment,
    /// metres; `None` if there was no calibration.
    pub receiver_rms: Option<f64>,
    /// The Cramer-Rao bound on it, from the measurements that are no outliers, metres.
    pub bound: f64,
    /// Size of the true network, metres.
    pub size: f64,
    /// Receivers whose truth lies in the 95 % ellipse, in space the ellipsoid.
    pub covered: usize,
    /// Receivers with an ellipse.
    pub ellipses: usize,
    /// Measurements more than unknowns.
    pub redundancy: usize,
    /// Whether the calibration said that the network is unique.
    pub unique: bool,
    /// Smallest receiver error (as `receiver_rms`) over the calibration and its alternatives.
    pub best_of_alternatives: Option<f64>,
    /// Estimated standard deviation of the measurements, metres.
    pub sigma: Option<f64>,
    /// Starts of the search.
    pub starts: usize,
    /// Seconds on the clock.
    pub seconds: f64,
    /// Why there was no calibration.
    pub error: Option<String>,
}

impl Trial {
    /// Whether the true network is among the alternatives: its receivers are within three times the
    /// Cramer-Rao bound, or within the share of the network's size below which networks count as
    /// the same. (Near a fold the bound, which is linear, is too small.)
    pub fn among_alternatives(&self) -> bool {
        self.best_of_alternatives.is_some_and(|rms| rms <= (3.0 * self.bound).max(SAME_NETWORK * self.size))
    }

    /// Whether the receivers are within three times the Cramer-Rao bound.
    pub fn success(&self) -> bool {
        self.receiver_rms.is_some_and(|rms| rms <= 3.0 * self.bound)
    }
}

/// Calibrates a simulated network whose noise had the standard deviation `noise` (metres) and
/// compares with the truth.
pub fn trial(simulation: &Simulation, noise: f64, seed: u64, options: &CalibrateOptions) -> Trial {
    let started = Instant::now();
    let result = calibrate(&simulation.pseudoranges, options);
    let seconds = started.elapsed().as_secs_f64();
    judge(simulation, noise, seed, seconds, &result)
}

/// Compares a calibration, or why there is none, with the truth of the simulated network; `noise`
/// is the standard deviation of the measurements in metres, `seconds` what the calibration took.
pub fn judge<const D: usize>(
    simulation: &Simulation<D>,
    noise: f64,
    seed: u64,
    seconds: f64,
    result: &Result<Calibration<D>, CalibrateError<D>>,
) -> Trial {
    let truth = &simulation.network;
    let bound = cramer_rao(&simulation.pseudoranges, &simulation.outliers, truth, noise);
    let mut trial = Trial {
        seed,
        receiver_rms: None,
        bound,
        size: truth.size(),
        covered: 0,
        ellipses: 0,
        redundancy: 0,
        unique: false,
        best_of_alternatives: None,
        sigma: None,
        starts: 0,
        seconds,
        error: None,
    };
    let calibration = match result {
        Ok(calibration) => calibration,
        Err(error) => {
            trial.error = Some(error.to_string());
            return trial;
        }
    };
    trial.receiver_rms = distance_from(&calibration.receivers, truth);
    let others = calibration.alternatives.iter().filter_map(|other| distance_from(&other.receivers, truth));
    trial.best_of_alternatives = others.chain(trial.receiver_rms).reduce(f64::min);
    trial.unique = calibration.unique;
    trial.sigma = Some(calibration.sigma);
    trial.starts = calibration.starts;
    trial.redundancy = calibration.redundancy;
    let known: Vec<Option<[f64; D]>> = truth.receivers.iter().copied().map(Some).collect();
    (trial.covered, trial.ellipses) = coverage(calibration, &calibration.receiver_covariance, &known);
    trial
}

/// A calibration started at known positions of the receivers instead of searched: the oracle that
/// shows what the data and the loss allow.
///
/// # Errors
/// Those of [`calibrate`].
pub fn oracle<const D: usize>(
    measured: &Pseudoranges,
    truth: &[Option<[f64; D]>],
    options: &CalibrateOptions<D>,
) -> Result<Calibration<D>, CalibrateError<D>>
where
    Dimension<D>: Calibrates<D>,
{
    let named = measured.receiver_names().iter().cloned().zip(truth.iter().copied());
    let positions = named.filter_map(|(name, position)| Some((name, position?))).collect();
    let mut options = options.clone();
    options.search.restarts = false;
    (options.search.min_starts, options.search.max_starts) = (1, 1);
    let mut calibration = calibrate_with(measured, &options, &[&KnownReceivers { positions }], &Monitor::default())?;
    calibration.compare(truth);
    Ok(calibration)
}

pub(super) fn distance_from<const D: usize>(receivers: &[Option<[f64; D]>], truth: &Network<D>) -> Option<f64> {
    let known: Vec<Option<[f64; D]>> = truth.receivers.iter().copied().map(Some).collect();
    apart(receivers, &known)
}

/// Root mean square distance of some positions from others after the best rigid alignment, over those
/// that are known in both, metres.
pub fn apart<const D: usize>(found: &[Option<[f64; D]>], known: &[Option<[f64; D]>]) -> Option<f64> {
    let (found, known) = both(found, known);
    align(&found, &known, false).map(|alignment| alignment.rms)
}

/// The positions that are known in both.
fn both<const D: usize>(found: &[Option<[f64; D]>], known: &[Option<[f64; D]>]) -> (Vec<[f64; D]>, Vec<[f64; D]>) {
    found.iter().zip(known).filter_map(|(found, known)| Some(((*found)?, (*known)?))).unzip()
}

/// How many of the 95 % ellipses (ellipsoids) of the receivers hold the truth, and how many there are, by
/// these covariances. The truth is aligned to the calibration by its receivers: that is the gauge of the
/// covariances.
pub fn coverage<const D: usize>(
    calibration: &Calibration<D>,
    covariances: &[Option<[[f64; D]; D]>],
    truth: &[Option<[f64; D]>],
) -> (usize, usize) {
    let (found, known) = both(&calibration.receivers, truth);
    let Some(alignment) = align(&known, &found, false) else { return (0, 0) };
    let Some(radius) = calibration.ellipse_radius else { return (0, 0) };
    let nodes = calibration.receivers.iter().zip(truth).zip(covariances);
    let (mut covered, mut ellipses) = (0, 0);
    for ((found, known), covariance) in nodes {
        let (Some(found), Some(known), Some(covariance)) = (found, known, covariance) else { continue };
        let at = alignment.transform.apply(*known);
        ellipses += 1;
        covered += usize::from(squared(*covariance, std::array::from_fn(|k| at[k] - found[k])) <= radius * radius);
    }
    (covered, ellipses)
}

/// d' C^-1 d, by elimination in the positive definite matrix C.
fn squared<const D: usize>(mut c: [[f64; D]; D], mut d: [f64; D]) -> f64 {
    let mut sum = 0.0;
    for k in 0..D {
        sum += d[k] * d[k] / c[k][k];
        for i in k + 1..D {
            let factor = c[i][k] / c[k][k];
            d[i] -= factor * d[k];
            for j in k..D {
                c[i][j] -= factor * c[k][j];
            }
        }
    }
    sum
}

/// The measurements with this share of the cells removed and then this share of the rest replaced
/// by numbers uniform over the range of all measurements of their transmitter: gross errors.
///
/// # Errors
/// None for measurements of this library; those of the constructors of [`Pseudoranges`] are passed
/// on.
pub fn damage(
    measured: &Pseudoranges,
    missing: f64,
    outliers: f64,
    seed: u64,
) -> Result<Pseudoranges, PseudorangeError> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let (m, n) = (measured.receivers(), measured.transmitters());
    let mut values = measured.dense();
    let ranges: Vec<(f64, f64)> = (0..n)
        .map(|j| {
            let column = (0..m).filter_map(|i| measured.get(i, j));
            column.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        })
        .collect();
    let mut order: Vec<usize> = (0..values.len()).filter(|&k| !values[k].is_nan()).collect();
    order.shuffle(&mut rng);
    let gone = (missing.clamp(0.0, 1.0) * order.len() as f64).round() as usize;
    let wrong = (outliers.clamp(0.0, 1.0) * (order.len() - gone) as f64).round() as usize;
    for &k in &order[..gone] {
        values[k] = f64::NAN;
    }
    for &k in &order[gone..gone + wrong] {
        let (low, high) = ranges[k % n];
        values[k] = low + (high - low) * rng.random::<f64>();
    }
    let (receivers, transmitters) = (measured.receiver_names().to_vec(), measured.transmitter_names().to_vec());
    let damaged = Pseudoranges::new(m, n, values)?.with_names(receivers, transmitters)?;
    if !measured.has_sigmas() {
        return Ok(damaged);
    }
    // Those of missing cells are ignored.
    let sigmas = (0..m * n).map(|k| measured.sigma(k / n, k % n).unwrap_or(1.0)).collect();
    damaged.with_sigmas(sigmas)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_distance_in_standard_deviations() {
        // C = [[4, 2], [2, 2]] has the inverse [[0.5, -0.5], [-0.5, 1]].
        assert_eq!(squared([[4.0, 2.0], [2.0, 2.0]], [1.0, 3.0]), 0.5 - 3.0 + 9.0);
        let axes = [[4.0, 0.0, 0.0], [0.0, 9.0, 0.0], [0.0, 0.0, 16.0]];
        assert_eq!(squared(axes, [2.0, 3.0, 8.0]), 1.0 + 1.0 + 4.0);
    }
}
