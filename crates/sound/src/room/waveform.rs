//! Sounds as samples, also as a clock hears them that is fast or slow.

use std::f64::consts::PI;

use rand::RngExt;
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use super::kernel::{BEFORE, Kernel, TAPS};
use super::options::Sound;

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

/// A chirp at a time after its beginning, seconds.
fn chirp(time: f64, from: f64, to: f64, length: f64) -> f64 {
    let share = time / length;
    if !(0.0..=1.0).contains(&share) {
        return 0.0;
    }
    // Over a twentieth of the length at either end.
    let fade = (20.0 * share.min(1.0 - share)).min(1.0);
    let envelope = (1.0 - (PI * fade).cos()) / 2.0;
    envelope * (2.0 * PI * time * (from + (to - from) * share / 2.0)).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chirp_begins_and_ends_with_its_frequencies() {
        // Crossings of zero in the first and in the last fifth of a second, without the fades: a tone of f Hz has 2 f a
        // second. From 1000 to 3000 Hz in 1 s, it has 1200 Hz on the mean of 0.05 to 0.15 s, and 2800 Hz in the mirror
        // image of that.
        let crossings = |begin: f64| {
            let samples: Vec<f64> = (0..4800).map(|k| chirp(begin + k as f64 / 48000.0, 1000.0, 3000.0, 1.0)).collect();
            samples.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count() as i32
        };
        assert!((crossings(0.05) - 120).abs() <= 1);
        assert!((crossings(0.85) - 280).abs() <= 1);
    }
}
