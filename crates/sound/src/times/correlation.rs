//! What two channels have in common, by frequency and by delay.

use super::options::TimeOptions;
use super::spectrum::Spectrum;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Values of the correlation for each period of the highest frequency.
const STEPS: f64 = 6.0;

/// Peaks of a pair of channels that are kept, and how large they are at least beside the largest.
const PEAKS: usize = 4;
const LEAST: f64 = 0.4;

/// How strong the direct sound is at least beside the strongest echo: 10 dB weaker.
const STRONG: f64 = 0.316;

/// The correlation of two channels, as a function of the delay of the first beside the second.
pub(super) struct Correlation {
    /// Cross-spectrum.
    values: Vec<Complex64>,
    /// The lowest frequency and the step, Hz.
    low: f64,
    step: f64,
    /// Greatest delay, seconds.
    most: f64,
}

impl Correlation {
    pub(super) fn new(a: &Spectrum, b: &Spectrum, options: &TimeOptions) -> Correlation {
        let whitened = |(a, b): (&Complex64, &Complex64)| {
            let product = a * b.conj();
            let modulus = product.norm();
            if modulus > 0.0 { product / modulus.powf(options.whitening) } else { product }
        };
        let values = a.values.iter().zip(&b.values).map(whitened).collect();
        Correlation { values, low: a.low, step: a.step, most: 0.5 * options.length }
    }

    /// The correlation at a delay.
    fn at(&self, delay: f64) -> f64 {
        self.sum(delay, |_, value| value.re)
    }

    /// How the correlation rises with the delay.
    pub(super) fn slope(&self, delay: f64) -> f64 {
        -self.sum(delay, |frequency, value| TAU * frequency * value.im)
    }

    /// How sharp a peak is: how the slope falls.
    pub(super) fn sharpness(&self, delay: f64) -> f64 {
        self.sum(delay, |frequency, value| (TAU * frequency).powi(2) * value.re)
    }

    fn sum(&self, delay: f64, term: impl Fn(f64, Complex64) -> f64) -> f64 {
        let (mut turn, by) = (Complex64::cis(TAU * self.low * delay), Complex64::cis(TAU * self.step * delay));
        let mut sum = 0.0;
        for (k, value) in self.values.iter().enumerate() {
            sum += term(self.low + k as f64 * self.step, value * turn);
            turn *= by;
        }
        sum
    }

    /// A step of delays that is short enough for all frequencies.
    pub(super) fn spacing(&self) -> f64 {
        1.0 / (STEPS * (self.low + self.values.len() as f64 * self.step))
    }

    /// The delays at which two channels agree best, the best first.
    pub(super) fn peaks(&self) -> Vec<Peak> {
        let mut found = self.all_peaks();
        found.retain(|peak| peak.share >= LEAST);
        found.truncate(PEAKS);
        found
    }

    /// The delay at which a channel first has a sound as strongly as it should.
    pub(super) fn first(&self) -> Option<f64> {
        let strong = self.all_peaks().into_iter().filter(|peak| peak.share >= STRONG);
        strong.map(|peak| peak.delay).min_by(f64::total_cmp)
    }

    /// All delays at which two channels agree, the best first.
    fn all_peaks(&self) -> Vec<Peak> {
        let spacing = self.spacing();
        let most = (self.most / spacing) as i64;
        let values: Vec<f64> = (-most..=most).map(|k| self.at(k as f64 * spacing)).collect();
        let mut found: Vec<Peak> = Vec::new();
        for k in 1..values.len().saturating_sub(1) {
            if values[k] > 0.0 && values[k] >= values[k - 1] && values[k] > values[k + 1] {
                let middle = (k as i64 - most) as f64 * spacing;
                let delay = stationary(|delay| self.slope(delay), middle - spacing, middle + spacing);
                found.push(Peak { delay, share: self.at(delay) });
            }
        }
        found.sort_by(|p, q| q.share.total_cmp(&p.share));
        let largest = found.first().map_or(1.0, |peak| peak.share);
        found.iter_mut().for_each(|peak| peak.share /= largest);
        found
    }
}

/// A delay at which two channels agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// By how much the first channel is later than the second, beside their leading edges, seconds.
    pub(super) delay: f64,
    /// The correlation there, as a share of the largest.
    pub(super) share: f64,
}

/// Where a falling function is zero, by halving: thirty times leave less than a picosecond of a millisecond.
fn stationary(slope: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if slope(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::Correlation;
    use crate::times::options::{TimeOptions, Window};
    use crate::times::spectrum::Spectrum;
    use std::f64::consts::TAU;

    /// A pulse of a millisecond about a time, at this sample rate.
    fn pulse(at: f64, rate: f64) -> Vec<f32> {
        let value =
            |t: f64| (-(t / 3e-4).powi(2)).exp() * ((TAU * 2500.0 * t).cos() + 0.5 * (TAU * 4100.0 * t + 1.0).cos());
        (0..(0.02 * rate) as usize).map(|k| value(k as f64 / rate - at) as f32).collect()
    }

    #[test]
    fn a_delay_is_told_to_a_fraction_of_a_sample_at_any_rate() {
        let options = TimeOptions { band: [500.0, 9000.0], ..TimeOptions::default() };
        for (rate, other) in [(48_000.0, 48_000.0), (48_000.0, 44_100.0), (22_050.0, 96_000.0)] {
            let delay = 12.34e-5;
            let spectrum = |at: f64, rate: f64| {
                let samples = pulse(at, rate);
                let window = Window { samples: &samples, start: 0.0, sample_rate: rate };
                Spectrum::new(&window, 0.009, &options)
            };
            let found = Correlation::new(&spectrum(0.01 + delay, rate), &spectrum(0.01, other), &options).peaks();
            assert!((found[0].delay - delay).abs() < 1e-7, "{rate} {other}: {found:?}");
        }
    }
}
