//! Sounds as samples, also as a clock hears them that is fast or slow.

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use super::options::Sound;
use crate::kernel::{BEFORE, Kernel, TAPS};
use crate::signal::chirp;

/// A sound, one metre from its source.
pub(super) enum Waveform {
    /// Impulses, one a sample.
    Noise(Vec<f64>),
    /// Frequency, Hz, at its beginning and its end, and its length, seconds.
    Chirp { from: f64, to: f64, length: f64 },
}

impl Waveform {
    /// The next sound; claps differ.
    pub(super) fn new(sound: Sound, sample_rate: f64, rng: &mut Pcg64Mcg) -> Waveform {
        match sound {
            Sound::Clap { length, decay } => {
                let count = ((length * sample_rate).round() as usize).max(1);
                let envelope = |k: usize| (-(k as f64) / (decay * sample_rate)).exp();
                Waveform::Noise((0..count).map(|k| envelope(k) * rng.sample::<f64, _>(StandardNormal)).collect())
            }
            Sound::Chirp { from, to, length } => Waveform::Chirp { from, to, length },
        }
    }

    /// Samples of it by a clock that is faster by the factor `pace`. The first comes [`BEFORE`] samples before the
    /// sound begins.
    pub(super) fn samples(&self, sample_rate: f64, pace: f64, kernel: &Kernel) -> Vec<f64> {
        match self {
            Waveform::Noise(impulses) => {
                let mut samples = vec![0.0; (impulses.len() as f64 * pace).ceil() as usize + TAPS];
                for (k, &size) in impulses.iter().enumerate() {
                    kernel.add(&mut samples, BEFORE as f64 + k as f64 * pace, size);
                }
                samples
            }
            Waveform::Chirp { from, to, length } => {
                let count = (length * sample_rate * pace).ceil() as usize + 1;
                let at = |k: usize| chirp(k as f64 / (sample_rate * pace), *from, *to, *length);
                std::iter::repeat_n(0.0, BEFORE).chain((0..count).map(at)).collect()
            }
        }
    }
}
