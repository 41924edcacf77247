//! A band of frequencies is let pass.

use std::f64::consts::PI;

use crate::biquad::Biquad;

/// A Butterworth filter of fourth order against low frequencies (wind, traffic, hum), and one of second order against high
/// ones. They have no overshoot before a sound begins, and little delay.
pub(super) struct BandPass {
    sections: [Biquad; 3],
    /// The first sample: recordings with an offset do not begin with a jump.
    offset: Option<f64>,
}

impl BandPass {
    /// A filter from `lower` to `upper` at this sample rate, all in Hz; `upper` is below half of the sample rate.
    pub(super) fn new(lower: f64, upper: f64, sample_rate: f64) -> BandPass {
        // Quality of the pairs of poles: 1 / (2 cos(k pi / 8)) for k = 1 and 3, and 1 / sqrt(2).
        let quality = |angle: f64| 1.0 / (2.0 * angle.cos());
        BandPass {
            sections: [
                Biquad::high_pass(lower / sample_rate, quality(PI / 8.0)),
                Biquad::high_pass(lower / sample_rate, quality(3.0 * PI / 8.0)),
                Biquad::low_pass(upper / sample_rate, quality(PI / 4.0)),
            ],
            offset: None,
        }
    }

    /// The next sample.
    pub(super) fn next(&mut self, sample: f32) -> f64 {
        let sample = f64::from(sample);
        let centred = sample - *self.offset.get_or_insert(sample);
        self.sections.iter_mut().fold(centred, |value, section| section.next(value))
    }

    /// Forgets what is too small to matter; to be called now and then.
    pub(super) fn settle(&mut self) {
        self.sections.iter_mut().for_each(Biquad::settle);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gain at a frequency, Hz, after a second in which the filter settles, of the band 500 Hz to 10 kHz at 48 kHz.
    fn gain(frequency: f64) -> f64 {
        let mut filter = BandPass::new(500.0, 10_000.0, 48_000.0);
        let tone = |k: i32| (2.0 * PI * frequency * f64::from(k) / 48_000.0).sin() as f32;
        let values: Vec<f64> = (0..96_000).map(|k| filter.next(tone(k))).collect();
        (values[48_000..].iter().map(|value| value * value).sum::<f64>() / 24_000.0).sqrt()
    }

    #[test]
    fn the_band_passes_and_the_rest_does_not() {
        // Butterworth: 1 / sqrt(1 + (f0 / f)^8) below, and half the power at either edge.
        assert!((gain(2000.0) - 1.0).abs() < 0.01);
        assert!((gain(500.0) - 0.5_f64.sqrt()).abs() < 0.001);
        assert!((gain(10_000.0) - 0.5_f64.sqrt()).abs() < 0.001);
        assert!((gain(250.0) * (1.0 + 2.0_f64.powi(8)).sqrt() - 1.0).abs() < 0.01);
        assert!(gain(20_000.0) < 0.1);
    }

    #[test]
    fn an_offset_makes_no_sound() {
        let mut filter = BandPass::new(500.0, 10_000.0, 48_000.0);
        assert!((0..1000).all(|_| filter.next(0.25) == 0.0));
    }
}
