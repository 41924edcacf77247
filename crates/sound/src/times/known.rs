//! Arrival times of a signal that is known: in each channel by itself, as the signal tells what all have in common.
//!
//! A compressed channel has a pulse for each way of the sound. Its envelope tells the pulses apart, and the wave under the
//! envelope, which is highest where the signal begins, tells the time.

use super::arrival::{Arrival, PEAKS};
use super::correlation::{Correlation, Delays};
use super::deviation::deviation;
use super::options::Window;
use crate::quantile::quantile;
use crate::signal::Compression;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;

/// How strong the direct sound is at least beside the strongest echo: 10 dB weaker.
const STRONG: f64 = 0.316;

/// How much larger than the median of the envelope before it the top must be: of normal noise, the envelope is so in one of 4
/// million, exp(-(4.7 x 1.177)^2 / 2), and a window has some thousand that are independent.
const HEARD: f64 = 4.7;

/// Time beside a pulse in which what is mixed with it is looked at, seconds.
const NEAR: f64 = 2e-3;

/// The arrival of a signal in a window, if it is there. The compression is that of the window's sample rate and length.
pub(super) fn arrival(window: &Window<'_>, compression: &Compression) -> Option<Arrival> {
    let (rate, length) = (window.sample_rate, compression.fourier.length());
    let values = compression.compressed(window.samples);
    let wave = compression.signal(values.iter().copied());
    // A quarter of a period later.
    let other = compression.signal(values.iter().map(|value| value * -Complex64::i()));
    let size = |k: usize| wave[k].hypot(other[k]);
    let envelope: Vec<f64> = (0..window.samples.len().min(length)).map(size).collect();
    let pulses = pulses(&envelope);
    let first = *pulses.first()?;

    let power: f64 = values.iter().map(Complex64::norm_sqr).sum();
    let step = rate / length as f64;
    let moment = |(k, value): (usize, &Complex64)| value.norm_sqr() * (compression.first + k) as f64 * step;
    let frequency = values.iter().enumerate().map(moment).sum::<f64>() / power;
    let delays = Delays { fourier: Arc::clone(&compression.fourier), most: (NEAR * rate) as usize };
    let correlation = Correlation { values, step, first: compression.first };
    let time = |k: usize| {
        let phase = other[k].atan2(wave[k]);
        correlation.top(k as f64 / rate - phase / (TAU * frequency), 0.25 / frequency)
    };
    let delay = time(first);
    let mut rest = pulses[1..].to_vec();
    rest.sort_by(|a, b| envelope[*b].total_cmp(&envelope[*a]));
    rest.truncate(PEAKS - 1);
    Some(Arrival {
        seconds: window.start + delay,
        sigma: deviation(&correlation, delay, &delays).unwrap_or(NEAR),
        alternatives: rest.into_iter().map(|k| window.start + time(k)).collect(),
    })
}

/// The tops of an envelope that are strong enough for a direct sound; none if its largest is not above the noise before it.
fn pulses(envelope: &[f64]) -> Vec<usize> {
    let largest = |best: (usize, f64), (k, e): (usize, &f64)| if *e > best.1 { (k, *e) } else { best };
    let (at, top) = envelope.iter().enumerate().fold((0, 0.0), largest);
    let noise = quantile(envelope[..at].to_vec(), 0.5);
    let Some(noise) = noise.filter(|noise| top > HEARD * noise) else { return Vec::new() };
    let least = (STRONG * top).max(HEARD * noise);
    let is_top = |k: &usize| envelope[*k] >= least && envelope[*k] > envelope[k - 1] && envelope[*k] >= envelope[k + 1];
    (1..envelope.len().saturating_sub(1)).filter(is_top).collect()
}
