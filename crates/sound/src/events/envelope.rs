//! How loud a channel is, about a thousand times a second.

use super::filter::BandPass;

/// Seconds over which the power is averaged, unless the band is narrow.
const BIN: f64 = 1e-3;

/// Least product of bandwidth and averaging time: with 2 x 4 degrees of freedom, the level of noise seldom strays far.
const LEAST_PRODUCT: f64 = 4.0;

/// Makes the envelope of a channel: root mean squares in a band, bin after bin, each of the same number of samples.
pub(super) struct Envelope {
    filter: BandPass,
    /// Samples of a bin.
    length: u64,
    count: u64,
    squares: f64,
}

impl Envelope {
    /// An envelope of a band, from and to, of which this width is used, Hz.
    pub(super) fn new([lower, upper]: [f64; 2], width: f64, sample_rate: u32) -> Envelope {
        let rate = f64::from(sample_rate);
        let seconds = BIN.max(LEAST_PRODUCT / width);
        let length = ((seconds * rate).round() as u64).max(1);
        Envelope { filter: BandPass::new(lower, upper, rate), length, count: 0, squares: 0.0 }
    }

    /// Length of a bin, seconds.
    pub(super) fn bin_seconds(&self, sample_rate: u32) -> f64 {
        self.length as f64 / f64::from(sample_rate)
    }

    /// The next samples; gives the levels of the bins that they end.
    pub(super) fn levels(&mut self, samples: &[f32]) -> impl Iterator<Item = f32> {
        samples.iter().filter_map(|&sample| self.next(sample))
    }

    /// The next sample; gives a level where it ends a bin.
    fn next(&mut self, sample: f32) -> Option<f32> {
        let value = self.filter.next(sample);
        self.squares += value * value;
        self.count += 1;
        if self.count < self.length {
            return None;
        }
        let level = (self.squares / self.length as f64).sqrt().min(f32::MAX.into()) as f32;
        (self.count, self.squares) = (0, 0.0);
        self.filter.settle();
        Some(level)
    }
}
