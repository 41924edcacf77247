//! A calibration beside the truth.

use super::Calibration;
use crate::align::align;
use crate::plane::distance;
use serde::Serialize;

/// Comparison with known positions of receivers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Truth {
    /// Root mean square distance of the receivers after the best rigid alignment (reflection allowed).
    pub receiver_rms: f64,
    /// The same with a common scale fitted as well.
    pub receiver_rms_scaled: f64,
    /// That scale, from the calibration to the truth.
    pub scale: f64,
    /// Receivers that were compared.
    pub receivers: usize,
    /// The true positions in the frame of the calibration (rigid alignment), in the order of the receivers.
    pub positions: Vec<Option<[f64; 2]>>,
    /// Median distance of the transmitters from the truth after the alignment of the receivers, if true transmitters were given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmitter_median: Option<f64>,
    /// Their true positions in the frame of the calibration, in the order of the transmitters; empty if none were given.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub transmitter_positions: Vec<Option<[f64; 2]>>,
}

impl Truth {
    pub(super) fn points(&mut self) -> impl Iterator<Item = &mut Option<[f64; 2]>> {
        self.positions.iter_mut().chain(&mut self.transmitter_positions)
    }
}

impl Calibration {
    /// Compares with true positions of receivers, in the order of the receivers, as far as they are known. Does nothing
    /// with fewer than two.
    pub fn compare(&mut self, truth: &[Option<[f64; 2]>]) {
        self.compare_all(truth, &[]);
    }

    /// [`Calibration::compare`] with true transmitters too, in the order of the transmitters, as far as they are known.
    pub fn compare_all(&mut self, truth: &[Option<[f64; 2]>], transmitters: &[Option<[f64; 2]>]) {
        let pairs: Vec<([f64; 2], [f64; 2])> =
            self.receivers.iter().zip(truth).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
        let (found, known): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        if found.len() < 2 {
            return;
        }
        let (Some(rigid), Some(scaled)) = (align(&found, &known, false), align(&found, &known, true)) else { return };
        let Some(back) = align(&known, &found, false) else { return };
        let moved =
            |all: &[Option<[f64; 2]>]| all.iter().map(|p| p.map(|p| back.transform.apply(p))).collect::<Vec<_>>();
        let transmitter_positions = moved(transmitters);
        let pairs = self.transmitters.iter().zip(&transmitter_positions).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        let mut errors: Vec<f64> = pairs.map(|(a, b)| distance(a, b)).collect();
        errors.sort_by(f64::total_cmp);
        self.truth = Some(Truth {
            receiver_rms: rigid.rms,
            receiver_rms_scaled: scaled.rms,
            scale: scaled.transform.scale,
            receivers: found.len(),
            positions: moved(truth),
            transmitter_median: errors.get(errors.len() / 2).copied(),
            transmitter_positions,
        });
    }
}
