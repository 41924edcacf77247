//! The clocks of recorders in the result.

use serde::{Deserialize, Serialize};

/// The clock of a recorder, against that of the first one; where send times are known, its offset is against these.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RecorderClock {
    /// Name of the recorder: of its receiver where no recorders were given.
    pub recorder: String,
    /// By how much its readings are larger than those of the reference, metres: where clocks run at rates of their own,
    /// at the reading [`at`](Self::at).
    pub offset: f64,
    /// Standard deviation of the offset, metres; `None` where the measurements do not determine it.
    pub offset_std: Option<f64>,
    /// By how much its clock runs faster than that of the first recorder, as a share: 1e-6 is one part in a million. `None`
    /// where rates are the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// Standard deviation of the rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_std: Option<f64>,
    /// The middle of its readings, metres; `None` where rates are the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<f64>,
}

impl RecorderClock {
    /// With all lengths multiplied by a factor.
    pub(crate) fn rescale(&mut self, factor: f64) {
        let lengths = [Some(&mut self.offset), self.offset_std.as_mut(), self.at.as_mut()];
        lengths.into_iter().flatten().for_each(|length| *length *= factor);
    }
}
