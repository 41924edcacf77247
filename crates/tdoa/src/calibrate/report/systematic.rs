//! Systematic errors of the receivers in a result.

use crate::align::Transform;
use serde::{Deserialize, Serialize};

/// Standard deviations that are too small by less than this factor are not worth a word.
const NOTABLE: f64 = 1.2;

/// Systematic errors of the receivers, and the covariances with them. All measurements of a receiver share
/// such an error: it is a constant, or changes smoothly with the direction of the transmitter, and more
/// measurements do not make it smaller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[[f64; D]; D]: Serialize", deserialize = "[[f64; D]; D]: Deserialize<'de>"))]
pub struct SystematicErrors<const D: usize = 2> {
    /// Standard deviation of the errors, metres: that of a single measurement, over all receivers.
    pub deviation: f64,
    /// How much more likely the measurements are with such errors (natural logarithm).
    pub gain: f64,
    /// Whether noise alone gains as much in about one network of a thousand at most.
    pub significant: bool,
    /// How many times as large the standard deviation of a receiver becomes, median of the receivers.
    pub factor: f64,
    /// Covariances of the receivers in the gauge, those of noise included. `None` where there is none
    /// of noise.
    pub receiver_covariance: Vec<Option<[[f64; D]; D]>>,
    /// Covariances of the transmitters in the gauge, those of noise included. `None` where there is
    /// none of noise.
    pub transmitter_covariance: Vec<Option<[[f64; D]; D]>>,
}

impl<const D: usize> SystematicErrors<D> {
    /// Whether the errors are significant, and the usual standard deviations too small by a factor that
    /// is worth a word.
    pub fn matter(&self) -> bool {
        self.significant && self.factor >= NOTABLE
    }

    pub(crate) fn transform(&mut self, map: &Transform<D>) {
        let all = self.receiver_covariance.iter_mut().chain(&mut self.transmitter_covariance);
        all.for_each(|c| *c = c.map(|c| map.apply_covariance(c)));
    }

    pub(crate) fn rescale(&mut self, factor: f64) {
        self.deviation *= factor;
    }
}
