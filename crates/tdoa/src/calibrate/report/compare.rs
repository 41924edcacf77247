//! Comparison of a calibration with known positions.

use crate::align::align;
use crate::calibrate::report::calibration::Calibration;
use crate::calibrate::report::truth::Truth;
use crate::median::median;
use crate::points::distance;

impl<const D: usize> Calibration<D> {
    /// Compares with the true positions of receivers, in the order of the receivers, as far as they
    /// are known. Does nothing if fewer than two are known.
    pub fn compare(&mut self, truth: &[Option<[f64; D]>]) {
        self.compare_all(truth, &[]);
    }

    /// [`Calibration::compare`], also with the true positions of transmitters, in the order of the
    /// transmitters, as far as they are known.
    pub fn compare_all(&mut self, truth: &[Option<[f64; D]>], transmitters: &[Option<[f64; D]>]) {
        let pairs: Vec<([f64; D], [f64; D])> =
            self.receivers.iter().zip(truth).filter_map(|(a, b)| Some(((*a)?, (*b)?))).collect();
        let (found, known): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        if found.len() < 2 {
            return;
        }
        let (Some(rigid), Some(scaled)) = (align(&found, &known, false), align(&found, &known, true)) else { return };
        let Some(back) = align(&known, &found, false) else { return };
        let moved =
            |all: &[Option<[f64; D]>]| all.iter().map(|p| p.map(|p| back.transform.apply(p))).collect::<Vec<_>>();
        let transmitter_positions = moved(transmitters);
        let pairs = self.transmitters.iter().zip(&transmitter_positions).filter_map(|(a, b)| Some(((*a)?, (*b)?)));
        self.truth = Some(Truth {
            receiver_rms: rigid.rms,
            receiver_rms_scaled: scaled.rms,
            scale: scaled.transform.scale,
            receivers: found.len(),
            positions: moved(truth),
            transmitter_median: median(pairs.map(|(a, b)| distance(a, b)).collect()),
            transmitter_positions,
        });
    }
    /// Moves to the frame of the true positions, once it has been compared with those of the receivers.
    ///
    /// [`compare`](Self::compare) moved them onto the network. What moves them back is unique where they span the space,
    /// and otherwise leaves open only how the network is turned about them. Transmitters do not take part: the network
    /// stays the same to the bit, whether they are known or not.
    pub fn move_to_frame_of(&mut self, receivers: &[Option<[f64; D]>]) {
        let Some(truth) = &self.truth else { return };
        let pairs = truth.positions.iter().zip(receivers);
        let (from, to): (Vec<_>, Vec<_>) = pairs.filter_map(|(moved, known)| Some(((*moved)?, (*known)?))).unzip();
        if let Some(back) = align(&from, &to, false) {
            self.transform(&back.transform);
        }
    }
}
