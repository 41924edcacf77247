//! What arrival times are taken from, and how.

use super::error::TimeError;
use crate::signal::Signal;

/// The part of a channel in which an event is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window<'a> {
    /// Samples. Some before the event tell the noise.
    pub samples: &'a [f32],
    /// Time of the first sample by the recorder's clock, seconds.
    pub start: f64,
    /// Samples per second, Hz.
    pub sample_rate: f64,
}

/// Options of [`arrival_times`](crate::arrival_times).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TimeOptions {
    /// What is known of the sounds. Of a signal that is known each channel tells the time by itself, and the options after the
    /// band are not used. Default [`Signal::Unknown`].
    pub signal: Signal,
    /// Lowest and highest frequency that is compared, Hz; the highest is at most 0.45 of each sample rate. Default 500 and
    /// 10,000.
    pub band: [f64; 2],
    /// Length of what is compared, seconds: the direct sound, and as little after it as may be. Default 0.004.
    pub length: f64,
    /// How much of that lies before the leading edge, seconds. Default 0.001.
    pub before: f64,
    /// Power of the modulus by which cross-spectra are divided: 0 for plain correlation, 1 for phases alone. Default 0.7.
    pub whitening: f64,
    /// Times the median of the envelope before an event that the leading edge is above. Default 6.
    pub edge_over_noise: f64,
    /// Share of the largest value of the envelope that the leading edge is above. Default 0.25.
    pub edge_share: f64,
}

/// Periods of the highest frequency that are compared at most, before what is compared first is wider.
const MOST: f64 = 1e4;

impl TimeOptions {
    /// Checks the numbers.
    ///
    /// # Errors
    /// The first one that is out of range.
    pub fn validate(&self) -> Result<(), TimeError> {
        self.signal.validate()?;
        let [low, high] = self.band;
        let wrong = |name, value, range| Err(TimeError::Option { name, value, range });
        if !(1.0..=1e6).contains(&low) {
            return wrong("the lowest frequency of the band", low, "from 1 to 1,000,000 Hz");
        }
        if !(high > low && high <= 1e6) {
            return wrong("the highest frequency of the band", high, "above the lowest and at most 1,000,000 Hz");
        }
        if !(1e-5..=1.0).contains(&self.length) {
            return wrong("the length of what is compared", self.length, "from 0.00001 to 1 s");
        }
        if !(0.0..=self.length).contains(&self.before) {
            return wrong(
                "what is compared before the leading edge",
                self.before,
                "from 0 to the length of what is compared",
            );
        }
        if !(0.0..=1.0).contains(&self.whitening) {
            return wrong("whitening", self.whitening, "from 0 to 1");
        }
        if !(1.0..=1e6).contains(&self.edge_over_noise) {
            return wrong("edge_over_noise", self.edge_over_noise, "from 1 to 1,000,000");
        }
        if !(0.0..=1.0).contains(&self.edge_share) {
            return wrong("edge_share", self.edge_share, "from 0 to 1");
        }
        if high * self.length > MOST {
            return Err(TimeError::TooLong { highest: high, length: self.length });
        }
        Ok(())
    }
}

impl Default for TimeOptions {
    fn default() -> TimeOptions {
        TimeOptions {
            signal: Signal::Unknown,
            band: [500.0, 10_000.0],
            length: 0.004,
            before: 0.001,
            whitening: 0.7,
            edge_over_noise: 6.0,
            edge_share: 0.25,
        }
    }
}
