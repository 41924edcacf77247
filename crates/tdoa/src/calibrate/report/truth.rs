//! How near a calibration comes to the truth.

use serde::{Deserialize, Serialize};

/// Comparison with known positions of receivers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[f64; D]: Serialize", deserialize = "[f64; D]: Deserialize<'de>"))]
pub struct Truth<const D: usize = 2> {
    /// Root mean square distance of the receivers after the best rigid alignment (reflection
    /// allowed).
    pub receiver_rms: f64,
    /// Root mean square distance of the receivers, in metres, if a common scale is fitted as well.
    pub receiver_rms_scaled: f64,
    /// That scale, from the calibration to the truth.
    pub scale: f64,
    /// Number of receivers that were compared.
    pub receivers: usize,
    /// The true positions in the frame of the calibration (rigid alignment), in the order of the
    /// receivers.
    pub positions: Vec<Option<[f64; D]>>,
    /// Median distance of the transmitters from the truth after the alignment of the receivers, if
    /// true transmitters were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmitter_median: Option<f64>,
    /// The true positions of the transmitters in the frame of the calibration, in the order of the
    /// transmitters; empty if none were given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub transmitter_positions: Vec<Option<[f64; D]>>,
}

impl<const D: usize> Truth<D> {
    pub(crate) fn points(&mut self) -> impl Iterator<Item = &mut Option<[f64; D]>> {
        self.positions.iter_mut().chain(&mut self.transmitter_positions)
    }
}
