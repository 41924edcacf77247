//! The clocks of recorders in the result.

use crate::calibrate::state::State;
use crate::degeneracy::list;
use serde::{Deserialize, Serialize};

/// Expected deviations of clocks beyond which a clock is no chance.
const SURPRISING: f64 = 4.0;

/// The clock of a recorder, against that of the first one; where send times are known, its offset is against these, and where
/// they [were given](crate::Pseudoranges::with_emission_times) its rate too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RecorderClock {
    /// Name of the recorder: of its receiver where no recorders were given, `all receivers` where these share one.
    pub recorder: String,
    /// By how much its readings are larger than those of the reference, metres: where clocks run at rates of their own,
    /// at the reading [`at`](Self::at).
    pub offset: f64,
    /// Standard deviation of the offset, metres; `None` where the measurements do not determine it.
    pub offset_std: Option<f64>,
    /// By how much its clock runs faster than the reference, as a share: 1e-6 is one part in a million. `None`
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

impl<const D: usize> State<'_, D> {
    /// What is wrong with the clocks that were expected, if anything is, where the network `fits` the measurements or not.
    pub(super) fn warn_of_clocks(&self, fits: bool) -> Option<String> {
        let surprises = self.observations.clocks().prior()?.surprises(&self.ranked[0].network, SURPRISING);
        if surprises.is_empty() && !fits {
            let remedy = "the standard deviations that were given for clocks may be too small: give larger --clock-sigma and --rate-sigma";
            return Some(remedy.to_string());
        }
        let names: Vec<String> = surprises.iter().map(|&i| self.measured.recorder_name(i).to_string()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "clocks are off by more than four of the standard deviations that were given for offsets and rates: {}; check these \
                 recorders, and --clock-sigma and --rate-sigma",
                list(&names)
            )
        })
    }
}
