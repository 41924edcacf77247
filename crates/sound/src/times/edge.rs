//! Where a channel rises above its noise.

use super::options::{TimeOptions, Window};
use crate::biquad::Biquad;
use crate::quantile::quantile;
use std::f64::consts::FRAC_1_SQRT_2;

/// Time over which the envelope is a mean, seconds.
const SMOOTHED: f64 = 2e-4;

/// How much larger than the median of the envelope its top must be: the mean of ten squares of noise is 1.8 times in amplitude
/// at most among a thousand.
const HEARD: f64 = 2.2;

/// Share of its top that counts as an edge in any case.
const TOP: f64 = 0.6;

/// The leading edge in a window, seconds by the recorder's clock; `None` where nothing is well above the noise.
pub(super) fn edge(window: &Window<'_>, options: &TimeOptions) -> Option<f64> {
    let (low, rate) = (options.band[0], window.sample_rate);
    let filtered = high_pass(window.samples, low / rate);
    let width = ((SMOOTHED * rate).round() as usize).max(1);
    let envelope = envelope(&filtered, width);
    let (top, largest) =
        envelope.iter().copied().enumerate().fold((0, 0.0), |best, (k, e)| if e > best.1 { (k, e) } else { best });
    let noise = quantile(envelope[..top].to_vec(), 0.5)?;
    if largest < HEARD * noise {
        return None;
    }
    // Of a sound that hardly rises above the noise the top is what can be told.
    let limit = (options.edge_over_noise * noise).min(TOP * largest).max(options.edge_share * largest);
    let first = envelope.iter().position(|e| *e > limit)?;
    // Between two samples the envelope is a line.
    let (below, above) = (envelope[first.checked_sub(1)?], envelope[first]);
    let place = first as f64 - (above - limit) / (above - below).max(f64::MIN_POSITIVE);
    // The envelope is late by half of its width.
    let place = place.max(0.0) - 0.5 * (width as f64 - 1.0);
    Some(window.start + place / rate)
}

/// Samples without what is below a frequency, which is a share of the sample rate: a Butterworth filter of second order.
fn high_pass(samples: &[f32], frequency: f64) -> Vec<f64> {
    let mut filter = Biquad::high_pass(frequency.clamp(1e-6, 0.49), FRAC_1_SQRT_2);
    samples.iter().map(|sample| filter.next(f64::from(*sample))).collect()
}

/// Root of the mean square over the last `width` samples.
fn envelope(samples: &[f64], width: usize) -> Vec<f64> {
    let mut sum = 0.0;
    let mean = |k: usize| {
        sum += samples[k].powi(2) - if k >= width { samples[k - width].powi(2) } else { 0.0 };
        // Differences of sums may be below zero by rounding.
        (f64::max(sum, 0.0) / width as f64).sqrt()
    };
    (0..samples.len()).map(mean).collect()
}
