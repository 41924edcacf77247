//! What a matrix must satisfy before it is solved.

use super::error::MinimalError;
use crate::clocks::Emissions;
use crate::degeneracy::{is_solvable, unknowns};
use crate::duplicates::{constant_difference, rounding};
use crate::pseudoranges::Pseudoranges;

/// Measurements at most: the last refinement takes memory for a matrix of as many rows, and columns
/// for all unknowns.
const MAX_MEASUREMENTS: usize = 5_000;

/// Refuses sizes that cannot be solved, missing measurements and nodes that coincide.
pub(super) fn check<const D: usize>(measured: &Pseudoranges) -> Result<(), MinimalError> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    let emissions = measured.emissions();
    let constraints = m * n;
    if !is_solvable::<D>(m, n, emissions) {
        let unknowns = unknowns::<D>(m, n, emissions);
        let configuration = measured.configuration();
        return Err(MinimalError::Underdetermined { dimensions: D, emissions, configuration, constraints, unknowns });
    }
    if constraints > MAX_MEASUREMENTS {
        return Err(MinimalError::TooLarge { configuration: measured.configuration(), limit: MAX_MEASUREMENTS });
    }
    check_nodes(measured)
}

/// Refuses missing measurements, negative ranges, and nodes that coincide.
pub(super) fn check_nodes(measured: &Pseudoranges) -> Result<(), MinimalError> {
    let (m, n) = (measured.receivers(), measured.transmitters());
    for i in 0..m {
        for j in 0..n {
            if measured.get(i, j).is_none() {
                return Err(MinimalError::Missing {
                    receiver: measured.receiver_names()[i].clone(),
                    transmitter: measured.transmitter_names()[j].clone(),
                });
            }
        }
    }
    let values = measured.cells().values();
    let f = |i: usize, j: usize| values[i * n + j];
    let largest = values.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let tolerance = rounding(largest);
    let emissions = measured.emissions();
    let negative = |&(_, _, value): &(usize, usize, &f64)| emissions == Emissions::Known && *value < 0.0;
    if let Some((i, j, &value)) = measured.cells().iter().find(negative) {
        let (receiver, transmitter) = (measured.receiver_names()[i].clone(), measured.transmitter_names()[j].clone());
        return Err(MinimalError::NegativeRange { receiver, transmitter, value });
    }
    // Ranges that differ by a constant are those of nodes apart.
    let are_same = |constant: f64| emissions == Emissions::Unknown || constant.abs() <= tolerance;
    for i in 0..m {
        for k in i + 1..m {
            if constant_difference((0..n).map(|j| (f(k, j), f(i, j))), tolerance).is_some_and(are_same) {
                let names = measured.receiver_names();
                return Err(MinimalError::IdenticalReceivers { first: names[i].clone(), second: names[k].clone() });
            }
        }
    }
    for j in 0..n {
        for k in j + 1..n {
            if constant_difference((0..m).map(|i| (f(i, k), f(i, j))), tolerance).is_some_and(are_same) {
                let names = measured.transmitter_names();
                return Err(MinimalError::IdenticalTransmitters { first: names[j].clone(), second: names[k].clone() });
            }
        }
    }
    Ok(())
}
