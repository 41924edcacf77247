//! The clocks of recorders in the result.

use crate::calibrate::state::State;
use crate::degeneracy::list;
use crate::quantity::length;
use serde::{Deserialize, Serialize};

/// Expected deviations of clocks beyond which a clock is no chance.
const SURPRISING: f64 = 4.0;

/// Rate that no clock of a recorder has, as a share: crystals keep to a tenth of it.
const NO_CLOCK: f64 = 1e-3;

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
    /// Name of the clock that all receivers share.
    pub(crate) const ALL_RECEIVERS: &str = "all receivers";

    /// What the clock adds to one of its readings, metres.
    pub fn lateness(&self, reading: f64) -> f64 {
        // A clock that is fast by a share runs ahead by less of its own readings.
        let ahead = self.rate.map_or(0.0, |rate| rate / (1.0 + rate));
        self.offset + ahead * (reading - self.at.unwrap_or(0.0))
    }

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

    /// Says so if the best network has clocks that run as no clock does: with too little time between events, rates stand for
    /// distances, and the network shrinks.
    pub(super) fn warn_of_rates(&self) -> Option<String> {
        let recorders = self.measured.unknown_clocks().filter(|recorders| recorders.drift())?;
        let clocks = recorders.taken().iter().zip(&self.ranked[0].network.clocks);
        let rates = clocks.map(|(taken, clock)| recorders.rate(taken[1] + clock[1]));
        let mut names: Vec<String> = (rates.enumerate())
            .filter(|(_, rate)| rate.abs() > NO_CLOCK)
            .map(|(i, _)| self.measured.recorder_name(i).to_string())
            .collect();
        names.dedup();
        (!names.is_empty()).then(|| {
            format!(
                "clocks of recorders seem to run fast or slow by more than a thousandth, which no such clock does: {}; too little time \
                 is measured to tell rates from distances (nine in ten readings are within {} of the middle one), or a sample rate \
                 is wrong: take the rates to be the same (--receiver-clocks offset), say how large they may be (--rate-sigma 20), or \
                 record for longer",
                list(&names),
                length(self.metre() * recorders.half())
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::{CalibrateOptions, ReceiverClocks, SimulateOptions, calibrate, simulate};

    /// Rates beside a recording of a few lengths of the room take the network away; with enough time, or with rates that clocks
    /// have, they do not.
    #[test]
    fn too_little_time_for_rates_is_said() {
        for (duration, rate_sigma, said) in [(20.0, None, true), (20.0, Some(2e-5), false), (2e5, None, false)] {
            let mut made =
                SimulateOptions { receivers: 8, transmitters: 20, noise: 0.01, seed: 3, ..Default::default() };
            (made.delays, made.duration) = (100.0, Some(duration));
            let made = simulate(&made).unwrap();
            let mut options = CalibrateOptions::default();
            (options.clocks.receivers, options.clocks.rate_sigma) = (ReceiverClocks::Rate, rate_sigma);
            let found = calibrate(&made.pseudoranges, &options).unwrap();
            let is_said = found.warnings.iter().any(|warning| warning.contains("--receiver-clocks offset"));
            assert_eq!(is_said, said, "{duration} {rate_sigma:?}: {:?} {:?}", found.warnings, found.clocks);
            assert_eq!(found.distrust().is_some(), said, "{duration} {rate_sigma:?}: {:?}", found.warnings);
        }
    }
}
