//! Numbers that may have marks between thousands where they were read with decimals.

use super::cells::Separator;
use super::error::ReadError;
use super::numbers::Numbers;
use super::units::Units;
use crate::pseudoranges::Pseudoranges;

/// Refuses numbers that may be a thousand times as large as they were read.
pub(super) fn refuse_thousands(
    numbers: &Numbers,
    separator: Separator,
    units: Units,
    measured: &Pseudoranges,
    file: &str,
) -> Result<(), ReadError> {
    let mut ranges = vec![[f64::INFINITY, f64::NEG_INFINITY]; measured.transmitters()];
    for (_, j, &value) in measured.cells().iter() {
        ranges[j] = [ranges[j][0].min(value), ranges[j][1].max(value)];
    }
    let spread = ranges.iter().map(|[least, most]| most - least).fold(0.0, f64::max);
    match numbers.doubt(separator, units, spread) {
        Some(problem) => Err(ReadError::Thousands { file: file.to_string(), problem }),
        None => Ok(()),
    }
}
