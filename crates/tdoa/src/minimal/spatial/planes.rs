//! Nodes of space in one plane or line, told from the measurements alone.

use crate::minimal::error::MinimalError;
use faer::Mat;
use std::array::from_fn;

/// Transmitters, of which any four may lie in one plane.
const COUNT: usize = 5;

/// Which nodes lie in one plane or line, if any do, so that linear equations do not determine the
/// network of five transmitters of these names. The measurements, a row for each receiver, are about
/// zero and of size one, and known to `precision`.
///
/// Four transmitters in one plane make the differences of `(f_ik - o_k)^2` depend on each other, beside
/// constants, and so does every four where all receivers lie in one plane.
pub(super) fn in_one_plane(values: &[[f64; COUNT]], precision: f64, names: &[String]) -> Option<MinimalError> {
    let flat: Vec<usize> = (0..COUNT).filter(|&left_out| others_are_flat(values, precision, left_out)).collect();
    // Two planes of four have a line of three in common.
    match flat.len() {
        0 => None,
        1 | 2 => {
            let others = names.iter().enumerate().filter(|(j, _)| !flat.contains(j));
            Some(MinimalError::TransmittersInOnePlane { names: others.map(|(_, name)| name.clone()).collect() })
        }
        _ => Some(MinimalError::InOnePlane),
    }
}

/// Whether the four other transmitters look as if they were in one plane.
fn others_are_flat(values: &[[f64; COUNT]], precision: f64, left_out: usize) -> bool {
    let others = |row: &[f64; COUNT]| from_fn(|k| row[if k < left_out { k } else { k + 1 }]);
    are_flat(&values.iter().map(others).collect::<Vec<_>>(), precision)
}

/// Whether four transmitters look as if they were in one plane, or all receivers, of which there are eight
/// at least; the measurements are as above.
pub(super) fn are_flat(values: &[[f64; 4]], precision: f64) -> bool {
    let entry = |i: usize, column: usize| {
        let row = values[i];
        match column {
            0..3 => row[column + 1] * row[column + 1] - row[0] * row[0],
            3..6 => row[column - 2],
            6 => row[0],
            _ => 1.0,
        }
    };
    let singular = Mat::from_fn(values.len(), 8, entry).singular_values().unwrap_or_default();
    // Written so that NaN is not flat.
    matches!(singular[..], [first, .., last] if last <= precision * first)
}
