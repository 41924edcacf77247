//! Nine receivers or more and five transmitters.

use super::offsets::offsets;
use super::upgrade::positions;
use crate::minimal::check::check_nodes;
use crate::minimal::error::MinimalError;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, RefineOptions};
use std::array::from_fn;

/// Fewest receivers with five transmitters.
pub(super) const FEWEST: usize = 9;
/// Steps of the adjustment: quadratic convergence from the linear solution takes a few.
const ADJUSTMENT: RefineOptions = RefineOptions {
    scale: Some(1.0),
    anneal_from: None,
    anneal_factor: 0.5,
    by_leverage: false,
    floor: 0.0,
    steps: 60,
    rounds: 0,
    tolerance: 1e-14,
    negligible: 0.0,
};

/// Columns of measurements, and how they were made: in units of `unit`, less `means`.
pub(super) struct Scaled<const N: usize = 5> {
    pub(super) unit: f64,
    means: [f64; N],
    /// `f_ij - means_j` in units, a row for each receiver.
    pub(super) values: Vec<[f64; N]>,
}

impl<const N: usize> Scaled<N> {
    /// `None` if the measurements do not differ, or overflow.
    pub(super) fn new(measured: &Pseudoranges) -> Option<Scaled<N>> {
        let values: Vec<[f64; N]> = measured.cells().values().as_chunks().0.to_vec();
        let count = values.len() as f64;
        let means: [f64; N] = from_fn(|j| values.iter().map(|row| row[j]).sum::<f64>() / count);
        let values: Vec<[f64; N]> = values.iter().map(|row| from_fn(|j| row[j] - means[j])).collect();
        let unit = (values.iter().flatten().map(|v| v * v).sum::<f64>() / (N as f64 * count)).sqrt();
        let usable = unit > 0.0 && unit.is_finite();
        usable.then(|| Scaled { unit, means, values: values.iter().map(|row| row.map(|v| v / unit)).collect() })
    }
}

/// The network in space of nine receivers or more and five transmitters that explains the
/// measurements, in metres, with the first receiver at the origin; any rotation or reflection of it
/// explains them as well.
///
/// The linear solution is adjusted by least squares. With errors in the measurements, which the
/// linear equations magnify a hundred to a thousand times, the adjustment mostly reaches the
/// network of least squares, but need not: [`Network::rms`] says how well the measurements are
/// explained.
///
/// Offsets follow from the rank three of squared distances: for five transmitters there are numbers
/// lambda with sum_k lambda_k ((f_ik - o_k)^2 - (f_i1 - o_1)^2) the same for every receiver, which is
/// linear in lambda_k, lambda_k o_k and o_1 sum_k lambda_k. Positions follow up to an affine map from
/// a factorisation, and the map from the squared distances to the first transmitter, which are linear
/// in a Gram matrix and a vector: the stratified approach of Ask, Kuang & Astrom, *A unifying approach
/// to minimal problems in collinear and planar TDOA sensor network self-calibration*.
///
/// # Errors
/// If the size is another one, a measurement is missing, two nodes coincide, the nodes are in special
/// position (all receivers or four of the transmitters in one plane, nine receivers on two surfaces of
/// degree two, such as eight corners of a box and a ninth point, or more on one), or no network in space
/// explains the measurements.
pub(crate) fn five_transmitters(measured: &Pseudoranges) -> Result<Network<3>, MinimalError> {
    if measured.transmitters() != 5 || measured.receivers() < FEWEST {
        return Err(MinimalError::NotSolvedInSpace { configuration: measured.configuration() });
    }
    check_nodes(measured)?;
    let scaled = Scaled::new(measured).ok_or(MinimalError::SpecialPosition)?;
    let offsets = offsets(&scaled.values).ok_or(MinimalError::SpecialPosition)?.values;
    let squared: Vec<[f64; 5]> =
        scaled.values.iter().map(|row| from_fn(|j| (row[j] - offsets[j]) * (row[j] - offsets[j]))).collect();
    let found = positions(&squared)?;
    let metres = |p: [f64; 3]| p.map(|x| scaled.unit * x);
    let linear = Network::new(
        found.receivers.into_iter().map(metres).collect(),
        found.transmitters.into_iter().map(metres).collect(),
        (0..5).map(|j| scaled.means[j] + scaled.unit * offsets[j]).collect(),
    );
    if !linear.is_finite() {
        return Err(MinimalError::SpecialPosition);
    }
    let observations = Observations::<3>::new(measured, |_, _| true);
    let adjusted = NetworkRefiner::new(&observations, f64::INFINITY, &hc::Monitor::default())
        .refine(linear.clone(), &ADJUSTMENT)
        .network;
    Ok(if adjusted.rms(measured) < linear.rms(measured) { adjusted } else { linear })
}
