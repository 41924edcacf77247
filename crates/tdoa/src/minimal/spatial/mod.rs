//! Networks in space whose offsets follow from linear equations.
//!
//! [`five_transmitters`] takes nine receivers or more and five transmitters. Such a network has
//! four measurements or more than unknowns, and a generic one is the only solution. It needs no
//! paths: offsets come from one singular value decomposition, positions from another and, with
//! exactly nine receivers, from polynomials in one unknown.
//!
//! ```
//! use tdoa::{Network, Pseudoranges, minimal::spatial::five_transmitters};
//!
//! let receivers = vec![
//!     [0.0, 0.1, 2.4], [4.0, 0.0, 1.9], [0.2, 5.0, 1.1], [3.8, 4.7, 2.5], [2.1, 0.3, 0.2],
//!     [0.1, 2.6, 0.5], [3.9, 2.2, 0.8], [1.8, 4.9, 2.2], [2.0, 1.0, 1.3],
//! ];
//! let transmitters = vec![[1.0, 1.0, 1.0], [3.0, 1.5, 0.4], [2.5, 4.0, 1.7], [0.5, 3.0, 0.9], [1.7, 2.2, 2.2]];
//! let truth = Network { receivers, transmitters, offsets: vec![0.0, 7.0, -3.0, 12.0, 0.5] };
//! let measured = Pseudoranges::new(9, 5, truth.pseudoranges())?;
//!
//! let found = five_transmitters(&measured)?;
//! assert!(found.rms(&measured) < 1e-9 && tdoa::accuracy::position_error(&found, &truth) < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod offsets;
mod polynomial;
mod upgrade;

use super::check::check_nodes;
use super::error::MinimalError;
use crate::network::Network;
use crate::observations::Observations;
use crate::pseudoranges::Pseudoranges;
use crate::refine::{NetworkRefiner, RefineOptions};
use offsets::offsets;
use std::array::from_fn;
use upgrade::positions;

/// Fewest receivers with five transmitters.
const FEWEST: usize = 9;
/// Most receivers: the adjustment takes memory for the square of the number of unknowns.
const MOST: usize = 1_000;
/// Steps of the adjustment: quadratic convergence from the linear solution takes a few.
const ADJUSTMENT: RefineOptions = RefineOptions {
    scale: Some(1.0),
    anneal_from: None,
    anneal_factor: 0.5,
    floor: 0.0,
    steps: 60,
    rounds: 0,
    tolerance: 1e-14,
};

/// Five columns of squared distances, and how they were made: in units of `unit`, less `means`.
struct Scaled {
    unit: f64,
    means: [f64; 5],
    /// `f_ij - means_j` in units, a row for each receiver.
    values: Vec<[f64; 5]>,
}

impl Scaled {
    /// `None` if the measurements do not differ, or overflow.
    fn new(measured: &Pseudoranges) -> Option<Scaled> {
        let values: Vec<[f64; 5]> = measured.cells().values().as_chunks().0.to_vec();
        let count = values.len() as f64;
        let means: [f64; 5] = from_fn(|j| values.iter().map(|row| row[j]).sum::<f64>() / count);
        let values: Vec<[f64; 5]> = values.iter().map(|row| from_fn(|j| row[j] - means[j])).collect();
        let unit = (values.iter().flatten().map(|v| v * v).sum::<f64>() / (5.0 * count)).sqrt();
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
/// If the size is another one or has more than 1,000 receivers, a measurement is missing, two nodes
/// coincide, the nodes are in special position (all receivers or four of the transmitters in one
/// plane, nine receivers on two surfaces of degree two, such as eight corners of a box and a ninth
/// point, or more on one), or no network in space explains the measurements.
pub fn five_transmitters(measured: &Pseudoranges) -> Result<Network<3>, MinimalError> {
    if measured.transmitters() != 5 || measured.receivers() < FEWEST {
        return Err(MinimalError::NotFiveTransmitters { configuration: measured.configuration() });
    }
    if measured.receivers() > MOST {
        return Err(MinimalError::TooLarge { configuration: measured.configuration(), limit: 5 * MOST });
    }
    check_nodes(measured)?;
    let scaled = Scaled::new(measured).ok_or(MinimalError::SpecialPosition)?;
    let offsets = offsets(&scaled.values).ok_or(MinimalError::SpecialPosition)?;
    let squared: Vec<[f64; 5]> =
        scaled.values.iter().map(|row| from_fn(|j| (row[j] - offsets[j]) * (row[j] - offsets[j]))).collect();
    let found = positions(&squared)?;
    let metres = |p: [f64; 3]| p.map(|x| scaled.unit * x);
    let linear = Network {
        receivers: found.receivers.into_iter().map(metres).collect(),
        transmitters: found.transmitters.into_iter().map(metres).collect(),
        offsets: (0..5).map(|j| scaled.means[j] + scaled.unit * offsets[j]).collect(),
    };
    if !linear.is_finite() {
        return Err(MinimalError::SpecialPosition);
    }
    let observations = Observations::<3>::new(measured, |_, _| true);
    let adjusted = NetworkRefiner::new(&observations, f64::INFINITY).refine(linear.clone(), &ADJUSTMENT).network;
    Ok(if adjusted.rms(measured) < linear.rms(measured) { adjusted } else { linear })
}

#[cfg(test)]
mod tests;
