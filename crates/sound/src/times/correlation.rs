//! What two channels have in common, by frequency and by delay.

use super::options::TimeOptions;
use super::spectrum::Spectrum;
use crate::fourier::Fourier;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Values of the correlation for each period of the highest frequency, at least.
const STEPS: f64 = 6.0;

/// Share of a peak that the highest of these values has at least: cos(pi / 6), for a tone of the highest frequency.
const SAMPLED: f64 = 0.866;

/// Rounds in which the top of a peak is found at most, and a step that is too short for another, seconds.
const ROUNDS: usize = 30;
const NEAR: f64 = 1e-12;

/// A delay at which two channels agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// By how much the first channel is later than the second, beside their leading edges, seconds.
    pub(super) delay: f64,
    /// The correlation there, as a share of the largest.
    pub(super) share: f64,
}

/// The correlation of two channels, as a function of the delay of the first beside the second.
pub(super) struct Correlation {
    /// Cross-spectrum.
    pub(super) values: Vec<Complex64>,
    /// Step of frequencies, Hz, and the lowest one in steps.
    pub(super) step: f64,
    pub(super) first: usize,
}

/// The delays at which correlations are taken: multiples of a short one.
pub(super) struct Delays {
    pub(super) fourier: Arc<Fourier>,
    /// How many of either sign.
    pub(super) most: usize,
}

impl Delays {
    /// Those at which spectra are compared.
    pub(super) fn new(options: &TimeOptions) -> Delays {
        let periods = options.band[1] / Spectrum::step(options);
        let fourier = Fourier::new((STEPS * periods).ceil() as usize);
        // Spectra have steps that keep twice this from folding.
        let most = fourier.length() / 4;
        Delays { fourier: Arc::new(fourier), most }
    }
}

impl Correlation {
    /// Of two channels: with cross-spectra divided by this power of their modulus.
    pub(super) fn of(a: &Spectrum, b: &Spectrum, whitening: f64) -> Correlation {
        let whitened = |(a, b): (&Complex64, &Complex64)| {
            let product = a * b.conj();
            let modulus = product.norm();
            if modulus > 0.0 { product / modulus.powf(whitening) } else { product }
        };
        Correlation { values: a.values.iter().zip(&b.values).map(whitened).collect(), step: a.step, first: a.first }
    }

    /// The delays at which two channels agree, with at least this share of the largest correlation, the best first.
    pub(super) fn peaks(&self, least: f64, delays: &Delays) -> Vec<Peak> {
        let (length, most) = (delays.fourier.length(), delays.most);
        let spacing = 1.0 / (length as f64 * self.step);
        let all = delays.fourier.signal(self.padded(self.values.iter().copied()));
        // Of negative delays the values are at the end.
        let value = |k: usize| all[(length + k - most) % length];
        let largest = (0..=2 * most).map(value).fold(0.0, f64::max);
        let mut found: Vec<Peak> = Vec::new();
        for k in 1..2 * most {
            let here = value(k);
            let is_top = here > 0.0 && here >= value(k - 1) && here > value(k + 1);
            if is_top && here >= SAMPLED * least * largest {
                let delay = self.top((k as f64 - most as f64) * spacing, spacing);
                let [share, ..] = self.at(delay);
                found.push(Peak { delay, share });
            }
        }
        found.sort_by(|p, q| q.share.total_cmp(&p.share));
        let largest = found.first().map_or(1.0, |peak| peak.share);
        found.iter_mut().for_each(|peak| peak.share /= largest);
        found.retain(|peak| peak.share >= least);
        found
    }

    /// Where it is largest, and its root mean square over all delays; `None` where it is nowhere positive.
    pub(super) fn largest(&self, delays: &Delays) -> Option<(f64, f64)> {
        let (length, most) = (delays.fourier.length(), delays.most);
        let spacing = 1.0 / (length as f64 * self.step);
        let all = delays.fourier.signal(self.padded(self.values.iter().copied()));
        let value = |k: usize| all[(length + k - most) % length];
        let at = (1..2 * most).max_by(|a, b| value(*a).total_cmp(&value(*b))).filter(|at| value(*at) > 0.0)?;
        let mean = (0..=2 * most).map(|k| value(k).powi(2)).sum::<f64>() / (2 * most + 1) as f64;
        // A transform has half of each frequency, and is divided by its length.
        Some((self.top((at as f64 - most as f64) * spacing, spacing), 0.5 * length as f64 * mean.sqrt()))
    }

    /// How fast the slope falls at the top of a peak.
    pub(super) fn sharpness(&self, delay: f64) -> f64 {
        let [_, _, curvature] = self.at(delay);
        -curvature
    }

    /// Slopes of what is odd about a delay, at all others on one side of it.
    pub(super) fn odd_slopes(&self, delay: f64, delays: &Delays) -> Vec<f64> {
        let mut turn = Complex64::cis(TAU * self.first as f64 * self.step * delay);
        let by = Complex64::cis(TAU * self.step * delay);
        // The spectrum of what is odd is imaginary, and that of its slope is real.
        let slope = |(k, value): (usize, &Complex64)| {
            let odd = (value * turn).im;
            turn *= by;
            Complex64::from(TAU * (self.first + k) as f64 * self.step * odd)
        };
        let Delays { fourier, most } = delays;
        let mut slopes = fourier.signal(self.padded(self.values.iter().enumerate().map(slope)));
        slopes.truncate(*most);
        // A transform has half of each frequency, and is divided by its length.
        slopes.iter_mut().for_each(|slope| *slope *= 0.5 * fourier.length() as f64);
        slopes
    }

    /// Values from the lowest frequency on, with zeros before.
    fn padded(&self, values: impl Iterator<Item = Complex64>) -> impl Iterator<Item = Complex64> {
        std::iter::repeat_n(Complex64::default(), self.first).chain(values)
    }

    /// The correlation at a delay, and its first and second derivative.
    pub(super) fn at(&self, delay: f64) -> [f64; 3] {
        let mut turn = Complex64::cis(TAU * self.first as f64 * self.step * delay);
        let by = Complex64::cis(TAU * self.step * delay);
        let mut sums = [0.0; 3];
        for (k, value) in self.values.iter().enumerate() {
            let (value, frequency) = (value * turn, TAU * (self.first + k) as f64 * self.step);
            sums[0] += value.re;
            sums[1] -= frequency * value.im;
            sums[2] -= frequency.powi(2) * value.re;
            turn *= by;
        }
        sums
    }

    /// The top of a peak that is at most this far from `middle`, by Newton's method between bounds.
    pub(super) fn top(&self, middle: f64, far: f64) -> f64 {
        let (mut low, mut high, mut delay) = (middle - far, middle + far, middle);
        for _ in 0..ROUNDS {
            let [_, slope, curvature] = self.at(delay);
            if slope > 0.0 {
                low = delay
            } else {
                high = delay
            }
            let next = delay - slope / curvature;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            let step = next - delay;
            delay = next;
            if step.abs() < NEAR {
                break;
            }
        }
        delay
    }
}

#[cfg(test)]
mod tests {
    use super::{Correlation, Delays};
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
                Spectrum::new(&window, 0.009, &options, Spectrum::step(&options))
            };
            let delays = Delays::new(&options);
            let found = Correlation::of(&spectrum(0.01 + delay, rate), &spectrum(0.01, other), 0.7).peaks(0.4, &delays);
            assert!((found[0].delay - delay).abs() < 1e-7, "{rate} {other}: {found:?}");
        }
    }
}
