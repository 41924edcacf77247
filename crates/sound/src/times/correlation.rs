//! What two channels have in common, by frequency and by delay.

use super::edge::Edge;
use super::options::{TimeOptions, Window};
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Spectra are taken at steps of one over this many times the length of what is compared: twice keeps delays of its length
/// from folding.
const PADDING: f64 = 2.0;

/// Values of the correlation for each period of the highest frequency.
const STEPS: f64 = 6.0;

/// Peaks of a pair of channels that are kept, and how large they are at least beside the largest.
const PEAKS: usize = 4;
const LEAST: f64 = 0.4;

/// How strong the direct sound is at least beside the strongest echo: 10 dB weaker.
const STRONG: f64 = 0.316;

/// Share of the length over which both ends fade.
const FADE: f64 = 0.1;

/// The spectrum of a channel from its leading edge on.
pub(super) struct Spectrum {
    values: Vec<Complex64>,
    /// The lowest frequency and the step, Hz.
    low: f64,
    step: f64,
    /// Energy of the samples, in their variance of noise, and the root of the mean square frequency, Hz.
    energy: f64,
    bandwidth: f64,
}

impl Spectrum {
    pub(super) fn new(window: &Window<'_>, edge: &Edge, options: &TimeOptions) -> Spectrum {
        let (rate, [low, high]) = (window.sample_rate, options.band);
        let step = 1.0 / (PADDING * options.length);
        let count = (((high.min(0.45 * rate) - low) / step).max(0.0)) as usize + 1;
        let begin = edge.seconds - options.before - window.start;
        let first = (begin * rate).ceil().max(0.0) as usize;
        let samples = window.samples.get(first..).unwrap_or_default();
        let samples = &samples[..samples.len().min((options.length * rate) as usize)];
        let mut values = vec![Complex64::default(); count];
        for (k, sample) in samples.iter().enumerate() {
            let at = (first + k) as f64 / rate - begin;
            let sample = f64::from(*sample) * fade(at / options.length);
            // The edge is the time zero.
            let phase = |frequency: f64| Complex64::cis(-TAU * frequency * (at - options.before));
            let (mut turn, by) = (sample * phase(low), phase(step));
            for value in &mut values {
                *value += turn;
                turn *= by;
            }
        }
        let squares: f64 = samples.iter().map(|sample| f64::from(*sample).powi(2)).sum();
        let energy = squares / edge.noise.powi(2).max(f64::MIN_POSITIVE);
        let power: f64 = values.iter().map(Complex64::norm_sqr).sum();
        let moment = |(k, value): (usize, &Complex64)| value.norm_sqr() * (low + k as f64 * step).powi(2);
        let bandwidth = (values.iter().enumerate().map(moment).sum::<f64>() / power.max(f64::MIN_POSITIVE)).sqrt();
        Spectrum { values, low, step, energy, bandwidth }
    }

    /// The sound that channels have in common, of these delays beside their leading edges: what is on other ways is at
    /// other times in each.
    pub(super) fn common(all: &[(&Spectrum, f64)]) -> Option<Spectrum> {
        let (first, _) = all.first()?;
        let mut values = vec![Complex64::default(); first.values.len()];
        for (spectrum, off) in all {
            let power: f64 = spectrum.values.iter().map(Complex64::norm_sqr).sum();
            let turn = Complex64::cis(TAU * first.step * off);
            let mut factor = Complex64::cis(TAU * first.low * off) / power.sqrt().max(f64::MIN_POSITIVE);
            for (sum, value) in values.iter_mut().zip(&spectrum.values) {
                *sum += factor * value;
                factor *= turn;
            }
        }
        Some(Spectrum { values, ..**first })
    }

    /// The least standard deviation that noise allows a time of arrival, seconds: one over the root mean square frequency
    /// (times tau) and the root of the energy over the noise (S. M. Kay, Fundamentals of Statistical Signal Processing:
    /// Estimation Theory, 1993, equation 3.14).
    pub(super) fn deviation(&self) -> f64 {
        1.0 / (TAU * self.bandwidth.max(1.0) * self.energy.max(1.0).sqrt())
    }
}

/// A window whose ends fade, over the share of its length that has passed.
fn fade(share: f64) -> f64 {
    let end = share.min(1.0 - share) / FADE;
    if end >= 1.0 { 1.0 } else { 0.5 - 0.5 * (0.5 * TAU * end.max(0.0)).cos() }
}

/// A delay at which two channels agree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// By how much the first channel is later than the second, beside their leading edges, seconds.
    pub(super) delay: f64,
    /// The correlation there, as a share of the largest.
    pub(super) share: f64,
}

/// The delays at which two channels agree best, the best first.
pub(super) fn peaks(a: &Spectrum, b: &Spectrum, options: &TimeOptions) -> Vec<Peak> {
    let mut found = all_peaks(a, b, options);
    found.retain(|peak| peak.share >= LEAST);
    found.truncate(PEAKS);
    found
}

/// The delay at which a channel first has a sound as strongly as it should.
pub(super) fn first(channel: &Spectrum, sound: &Spectrum, options: &TimeOptions) -> Option<f64> {
    let strong = all_peaks(channel, sound, options).into_iter().filter(|peak| peak.share >= STRONG);
    strong.map(|peak| peak.delay).min_by(f64::total_cmp)
}

/// All delays at which two channels agree, the best first.
fn all_peaks(a: &Spectrum, b: &Spectrum, options: &TimeOptions) -> Vec<Peak> {
    let count = a.values.len().min(b.values.len());
    let cross: Vec<Complex64> = (0..count)
        .map(|k| {
            let product = a.values[k] * b.values[k].conj();
            let modulus = product.norm();
            if modulus > 0.0 { product / modulus.powf(options.whitening) } else { product }
        })
        .collect();
    let (low, step) = (a.low, a.step);
    let at = |delay: f64, derivative: bool| -> f64 {
        let (mut turn, by) = (Complex64::cis(TAU * low * delay), Complex64::cis(TAU * step * delay));
        let mut sum = 0.0;
        for (k, value) in cross.iter().enumerate() {
            let product = value * turn;
            sum += if derivative { -TAU * (low + k as f64 * step) * product.im } else { product.re };
            turn *= by;
        }
        sum
    };
    let spacing = 1.0 / (STEPS * (low + count as f64 * step));
    let most = (0.5 * options.length / spacing) as i64;
    let values: Vec<f64> = (-most..=most).map(|k| at(k as f64 * spacing, false)).collect();
    let mut found: Vec<Peak> = Vec::new();
    for k in 1..values.len().saturating_sub(1) {
        if values[k] > 0.0 && values[k] >= values[k - 1] && values[k] > values[k + 1] {
            let middle = (k as i64 - most) as f64 * spacing;
            let delay = stationary(|delay| at(delay, true), middle - spacing, middle + spacing);
            found.push(Peak { delay, share: at(delay, false) });
        }
    }
    found.sort_by(|p, q| q.share.total_cmp(&p.share));
    let largest = found.first().map_or(1.0, |peak| peak.share);
    found.iter_mut().for_each(|peak| peak.share /= largest);
    found
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
    use super::{Spectrum, peaks};
    use crate::times::edge::Edge;
    use crate::times::options::{TimeOptions, Window};
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
                Spectrum::new(&window, &Edge { seconds: 0.009, noise: 1e-3 }, &options)
            };
            let found = peaks(&spectrum(0.01 + delay, rate), &spectrum(0.01, other), &options);
            assert!((found[0].delay - delay).abs() < 1e-7, "{rate} {other}: {found:?}");
        }
    }
}
