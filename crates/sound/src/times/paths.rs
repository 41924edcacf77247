//! The ways on which a sound comes to a channel.
//!
//! A short noise compared with itself has, beside its peak, others of a third of it, which are no echoes. Beside the sound
//! that all channels have in common, a channel is therefore taken apart: the strongest way is found, what comes on it is
//! taken away, and the ways that have been found are fitted again, until nothing is left that is above the rest (search,
//! subtract and readjust: C. Falsi, D. Dardari, L. Mucchi and M. Z. Win, Time of arrival estimation for UWB localizers in
//! realistic environments, EURASIP J. Appl. Signal Process., 2006; readjustment way by way as in J. Li and P. Stoica,
//! Efficient mixed-spectrum estimation with applications to target feature extraction, IEEE Trans. Signal Process. 44,
//! 1996).

use super::correlation::{Correlation, Delays};
use super::deviation::deviation;
use super::spectrum::Spectrum;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Most ways, and how often each is fitted again when a further one has been found.
const MOST: usize = 16;
const ROUNDS: usize = 3;

/// Least size of a way, as a share of the largest, and over what is left where no ways are.
const LEAST: f64 = 0.1;
const CLEAR: f64 = 4.0;

/// How far a delay moves at most when it is fitted again, as a share of the period of the highest frequency.
const MOVED: f64 = 0.25;

/// Power of a frequency that counts as noise, as a share of the mean: weak frequencies do not become as loud as others.
const WEAK: f64 = 0.1;

/// A way of a sound to a channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Path {
    /// How late the sound comes on it, beside the time about which the spectrum of the channel is, seconds.
    pub(super) delay: f64,
    /// Standard deviation of that, from what is left of the channel, seconds.
    pub(super) sigma: f64,
    /// Its size, as a share of the largest.
    pub(super) share: f64,
    /// Its size, over what is left of the channel where no ways are.
    pub(super) clear: f64,
}

/// The ways of a sound to a channel, the largest first; all sizes are positive.
pub(super) fn paths(channel: &Spectrum, sound: &Spectrum, whitening: f64, delays: &Delays) -> Vec<Path> {
    let mean = sound.values.iter().map(Complex64::norm_sqr).sum::<f64>() / sound.values.len().max(1) as f64;
    let weight = |value: &Complex64| (value.norm_sqr() + WEAK * mean).max(f64::MIN_POSITIVE).powf(-0.5 * whitening);
    let weights: Vec<f64> = sound.values.iter().map(weight).collect();
    let weighted = |all: &[Complex64]| -> Vec<Complex64> { all.iter().zip(&weights).map(|(x, w)| x * w).collect() };
    let values = weighted(&sound.values);
    let power: f64 = values.iter().map(Complex64::norm_sqr).sum();
    let mut rest = Rest { values: weighted(&channel.values), sound: Spectrum { values, ..*sound }, power };
    let mut found: Vec<(f64, f64)> = Vec::new();
    while power > 0.0 && found.len() < MOST {
        let correlation = rest.correlation();
        let Some((delay, noise)) = correlation.largest(delays) else { break };
        let size = correlation.at(delay)[0] / power;
        let largest = found.iter().map(|(_, size)| *size).fold(size, f64::max);
        // The largest of nothing but noise is some times as large as it; to take it away would lessen what is left.
        if size < LEAST * largest || (!found.is_empty() && size < CLEAR * noise / power) {
            break;
        }
        rest.add(delay, -size);
        found.push((delay, size));
        rest.fit_again(&mut found);
    }
    let noise = rest.correlation().largest(delays).map_or(0.0, |(_, noise)| noise / power).max(f64::MIN_POSITIVE);
    found.sort_by(|p, q| q.1.total_cmp(&p.1));
    let largest = found.first().map_or(1.0, |(_, size)| size.max(f64::MIN_POSITIVE));
    let path = |&(delay, size): &(f64, f64)| {
        rest.add(delay, size);
        let sigma = deviation(&rest.correlation(), delay, delays).unwrap_or(f64::INFINITY);
        rest.add(delay, -size);
        Path { delay, sigma, share: size / largest, clear: size / noise }
    };
    found.iter().map(path).collect()
}

/// What is left of a channel.
struct Rest {
    values: Vec<Complex64>,
    sound: Spectrum,
    /// Power of the sound.
    power: f64,
}

impl Rest {
    fn correlation(&self) -> Correlation {
        let values = self.values.iter().zip(&self.sound.values).map(|(rest, sound)| rest * sound.conj()).collect();
        Correlation { values, step: self.sound.step, first: self.sound.first }
    }

    /// Adds the sound on a way.
    fn add(&mut self, delay: f64, size: f64) {
        let Spectrum { values, step, first } = &self.sound;
        let mut factor = size * Complex64::cis(-TAU * *first as f64 * step * delay);
        let turn = Complex64::cis(-TAU * step * delay);
        for (rest, value) in self.values.iter_mut().zip(values) {
            *rest += factor * value;
            factor *= turn;
        }
    }

    /// Fits each way beside the others.
    fn fit_again(&mut self, found: &mut [(f64, f64)]) {
        let far = MOVED / (self.sound.step * (self.sound.first + self.sound.values.len()) as f64);
        for _ in 0..ROUNDS {
            for (delay, size) in found.iter_mut() {
                self.add(*delay, *size);
                let correlation = self.correlation();
                *delay = correlation.top(*delay, far);
                *size = (correlation.at(*delay)[0] / self.power).max(0.0);
                self.add(*delay, -*size);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::paths;
    use crate::times::correlation::Delays;
    use crate::times::options::{TimeOptions, Window};
    use crate::times::spectrum::Spectrum;
    use num_complex::Complex64;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;
    use rand_pcg::Pcg64Mcg;
    use std::f64::consts::TAU;

    /// Compared with itself, such a sound has peaks of a third and more; what is taken apart has none of these.
    #[test]
    fn a_channel_has_the_ways_that_were_laid_into_it() {
        let (options, rate) = (TimeOptions { length: 0.008, before: 0.004, ..TimeOptions::default() }, 48_000.0);
        let (step, delays) = (Spectrum::step(&options), Delays::new(&options));
        for seed in 0..20 {
            let mut rng = Pcg64Mcg::seed_from_u64(seed);
            let decay = |k: usize| if k < 192 { 0.0 } else { (-((k - 192) as f64) / (0.0015 * rate)).exp() };
            let samples: Vec<f32> =
                (0..384).map(|k| (decay(k) * rng.sample::<f64, _>(StandardNormal)) as f32).collect();
            let window = Window { samples: &samples, start: 0.0, sample_rate: rate };
            let sound = Spectrum::new(&window, 0.004, &options, step);
            let ways = [(-1.2345e-3, 0.25), (-1e-3, 0.5), (0.0, 1.0), (7.1e-4, 0.8)];
            let mut values = vec![Complex64::default(); sound.values.len()];
            for (delay, size) in ways {
                for (k, (sum, value)) in values.iter_mut().zip(&sound.values).enumerate() {
                    *sum += size * value * Complex64::cis(-TAU * (sound.first + k) as f64 * step * delay);
                }
            }
            let mut found = paths(&Spectrum { values, ..sound }, &sound_of(&window, &options), 0.7, &delays);
            assert_eq!(found.len(), 4, "{seed}: {found:?}");
            found.sort_by(|a, b| a.delay.total_cmp(&b.delay));
            for (path, (delay, size)) in found.iter().zip(ways) {
                assert!((path.delay - delay).abs() < 2e-6 && (path.share - size).abs() < 0.05, "{seed}: {found:?}");
            }
        }
    }

    fn sound_of(window: &Window<'_>, options: &TimeOptions) -> Spectrum {
        Spectrum::new(window, 0.004, options, Spectrum::step(options))
    }
}
