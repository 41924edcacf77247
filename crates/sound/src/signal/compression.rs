//! A signal becomes a pulse.

use num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::Arc;

use super::error::SignalError;
use super::known::Signal;
use super::samples::samples;
use crate::fade::fade;
use crate::format::HIGHEST;
use crate::fourier::Fourier;

/// Most samples of a signal: transforms are of some times as many.
const MOST: f64 = 4e6;

/// Power at which a frequency counts half, as a share of the typical one: strong frequencies count alike, for a short
/// pulse, and weak ones little, for little noise.
const HALF: f64 = 0.1;

/// Share of the power over which either end of the band fades: a band that ends at once has a pulse with long ends.
const FADE: f64 = 0.25;

/// Least width of the band, Hz, and least share of the power that is in it.
const WIDTH: f64 = 100.0;
const SHARE: f64 = 1e-3;

/// A filter that makes a pulse of a signal, at the time of its beginning.
pub(crate) struct Compression {
    pub(crate) fourier: Arc<Fourier>,
    /// The filter, from the lowest frequency on.
    values: Vec<Complex64>,
    /// The lowest frequency, in steps.
    pub(crate) first: usize,
    /// Width of the band, Hz: that of the same power if all of it were as strong.
    pub(crate) width: f64,
    /// Samples of the signal.
    pub(crate) length: usize,
}

impl Compression {
    /// A filter of recordings of this rate, in transforms of at least `length` samples more than those of the signal;
    /// `None` if the signal is not known.
    pub(crate) fn new(
        signal: &Signal,
        [lower, upper]: [f64; 2],
        rate: f64,
        length: usize,
    ) -> Result<Option<Compression>, SignalError> {
        signal.validate()?;
        if *signal == Signal::Unknown {
            return Ok(None);
        }
        let (seconds, most) = (signal.seconds(), MOST / rate);
        if seconds > most {
            return Err(SignalError::TooLong { seconds, most });
        }
        let own = if let Signal::Template { sample_rate, .. } = signal { *sample_rate } else { f64::INFINITY };
        let upper = upper.min(HIGHEST * rate.min(own));
        let (samples, before) = samples(signal, rate);
        let fourier = Fourier::new(samples.len() + length);
        let step = rate / fourier.length() as f64;
        let first = (lower / step).ceil() as usize;
        let spectrum = fourier.spectrum(&samples);
        // Samples that are before the beginning delay the rest.
        let turn =
            |k: usize| Complex64::cis(2.0 * PI * (k * before % fourier.length()) as f64 / fourier.length() as f64);
        let last = ((upper / step) as usize + 1).min(spectrum.len());
        let band = spectrum.get(first..last).unwrap_or_default();
        let powers: Vec<f64> = band.iter().map(Complex64::norm_sqr).collect();
        let all: f64 = spectrum.iter().map(Complex64::norm_sqr).sum();
        let sum: f64 = powers.iter().sum();
        if sum <= SHARE * all {
            return Err(SignalError::Band { width: 0.0, lower, upper });
        }
        // The power of a frequency, as a mean over the power.
        let typical = powers.iter().map(|power| power * power).sum::<f64>() / sum;
        let (mut passed, mut width) = (0.0, 0.0);
        let value = |(k, (value, power)): (usize, (&Complex64, &f64))| {
            passed += power / sum;
            let fade = fade(passed, FADE);
            width += fade * power / (power + HALF * typical);
            // White noise remains as loud as it is in the band.
            value.conj() * turn(first + k).conj() * (fade * typical.sqrt() / (power + HALF * typical))
        };
        let values = band.iter().zip(&powers).enumerate().map(value).collect();
        let width = width * step;
        if width < WIDTH {
            return Err(SignalError::Band { width, lower, upper });
        }
        Ok(Some(Compression { fourier: Arc::new(fourier), values, first, width, length: samples.len() }))
    }

    /// The spectrum of compressed samples, from the lowest frequency of the band on.
    pub(crate) fn compressed<S: Copy + Into<f64>>(&self, samples: &[S]) -> Vec<Complex64> {
        let spectrum = self.fourier.spectrum(samples);
        let band = spectrum.get(self.first..).unwrap_or_default();
        band.iter().zip(&self.values).map(|(value, filter)| value * filter).collect()
    }

    /// The signal of a spectrum from the lowest frequency of the band on.
    pub(crate) fn signal(&self, values: impl Iterator<Item = Complex64>) -> Vec<f64> {
        self.fourier.signal(std::iter::repeat_n(Complex64::default(), self.first).chain(values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::chirp;

    const CHIRP: Signal = Signal::Chirp { from: 1000.0, to: 6000.0, seconds: 0.05 };
    const BAND: [f64; 2] = [500.0, 10_000.0];

    /// A second at this rate in which a chirp begins at a time.
    fn second(begin: f64, rate: f64) -> Vec<f64> {
        (0..rate as usize).map(|k| chirp(k as f64 / rate - begin, 1000.0, 6000.0, 0.05)).collect()
    }

    /// Where the compressed second is largest, samples, how large it is there, and how large elsewhere.
    fn pulse(signal: &Signal, begin: f64, rate: f64) -> (usize, f64, f64) {
        let compression = Compression::new(signal, BAND, rate, rate as usize).unwrap().unwrap();
        let values = compression.compressed(&second(begin, rate));
        let wave = compression.signal(values.into_iter());
        let largest = |best: (usize, f64), (k, x): (usize, &f64)| if *x > best.1 { (k, *x) } else { best };
        let (at, top) = wave.iter().enumerate().fold((0, 0.0), largest);
        // Apart by some times 1 / 5000 Hz.
        let far = (5e-3 * rate) as usize;
        let rest = wave.iter().enumerate().filter(|(k, _)| k.abs_diff(at) > far && *k < rate as usize);
        (at, top, rest.map(|(_, x)| x.abs()).fold(0.0, f64::max))
    }

    #[test]
    fn a_chirp_becomes_a_pulse_where_it_begins() {
        let template = |rate: f64| {
            let samples = second(0.0, rate).into_iter().take((0.05 * rate) as usize).map(|x| x as f32).collect();
            Signal::Template { samples, sample_rate: rate }
        };
        for signal in [CHIRP, template(48_000.0), template(44_100.0), template(16_000.0), template(96_000.0)] {
            for rate in [48_000.0, 16_000.0] {
                let (at, top, rest) = pulse(&signal, 0.25, rate);
                assert!(at == (0.25 * rate) as usize && top > 10.0 * rest, "{rate}: {at} {top} {rest} {signal:?}");
            }
        }
    }

    #[test]
    fn noise_remains_as_loud_as_it_is_in_the_band() {
        let compression = Compression::new(&CHIRP, BAND, 48_000.0, 48_000).unwrap().unwrap();
        // An impulse has the spectrum of white noise: 1.
        let values = compression.compressed(&[1.0]);
        let power: f64 = 2.0 * values.iter().map(Complex64::norm_sqr).sum::<f64>();
        let share = power / compression.fourier.length() as f64;
        // Of 24 kHz the chirp has 5, whose ends fade.
        assert!((3000.0..5000.0).contains(&compression.width), "{} Hz", compression.width);
        assert!((0.5..1.0).contains(&(share * 24_000.0 / compression.width)), "{share}");
    }

    #[test]
    fn signals_that_cannot_be_looked_for_are_refused() {
        let new = |signal: &Signal, rate: f64| Compression::new(signal, BAND, rate, 1000).map(|made| made.is_some());
        assert_eq!(new(&Signal::Unknown, 48_000.0), Ok(false));
        assert_eq!(new(&CHIRP, 48_000.0), Ok(true));
        let high = Signal::Chirp { from: 12_000.0, to: 16_000.0, seconds: 0.1 };
        let tone = Signal::Chirp { from: 1000.0, to: 1000.0, seconds: 0.5 };
        for (signal, rate) in [(&high, 48_000.0), (&CHIRP, 2000.0), (&tone, 48_000.0)] {
            assert!(matches!(new(signal, rate), Err(SignalError::Band { .. })), "{signal:?}");
        }
        let long = Signal::Chirp { from: 1000.0, to: 6000.0, seconds: 10.0 };
        assert!(matches!(new(&long, 1e6), Err(SignalError::TooLong { .. })));
        let silent = Signal::Template { samples: vec![0.0; 1000], sample_rate: 48_000.0 };
        assert_eq!(new(&silent, 48_000.0), Err(SignalError::Silent));
        let wrong = Signal::Template { samples: vec![f32::NAN; 1000], sample_rate: 48_000.0 };
        let none = Signal::Template { samples: vec![1.0], sample_rate: 0.0 };
        let endless = Signal::Chirp { from: 1000.0, to: 6000.0, seconds: f64::NAN };
        for signal in [&wrong, &none, &endless] {
            assert!(matches!(new(signal, 48_000.0), Err(SignalError::Range { .. })), "{signal:?}");
        }
        let tiny =
            Signal::Template { samples: vec![f32::from_bits(1), 0.0, f32::MAX, 1.0, 1.0], sample_rate: 48_000.0 };
        assert_eq!(new(&tiny, 48_000.0), Ok(true));
    }
}
