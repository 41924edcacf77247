//! Filters of second order.

use std::f64::consts::PI;

/// Below this, states of filters are zero: arithmetic on denormal numbers is slow.
const TINY: f64 = 1e-60;

/// Two poles and two zeros, by the bilinear transform, in the transposed direct form II.
pub(crate) struct Biquad {
    forward: [f64; 3],
    back: [f64; 2],
    state: [f64; 2],
}

impl Biquad {
    /// A high-pass of second order at a frequency, which is a share of the sample rate, and of this quality.
    pub(crate) fn high_pass(frequency: f64, quality: f64) -> Biquad {
        let (k, norm) = Biquad::warped(frequency, quality);
        Biquad::new([norm, -2.0 * norm, norm], k, norm, quality)
    }

    /// A low-pass of second order at a frequency, which is a share of the sample rate, and of this quality.
    pub(crate) fn low_pass(frequency: f64, quality: f64) -> Biquad {
        let (k, norm) = Biquad::warped(frequency, quality);
        Biquad::new([k * k * norm, 2.0 * k * k * norm, k * k * norm], k, norm, quality)
    }

    fn warped(frequency: f64, quality: f64) -> (f64, f64) {
        let k = (PI * frequency).tan();
        (k, 1.0 / (1.0 + k / quality + k * k))
    }

    fn new(forward: [f64; 3], k: f64, norm: f64, quality: f64) -> Biquad {
        let back = [2.0 * (k * k - 1.0) * norm, (1.0 - k / quality + k * k) * norm];
        Biquad { forward, back, state: [0.0; 2] }
    }

    /// The next sample.
    #[inline]
    pub(crate) fn next(&mut self, sample: f64) -> f64 {
        let value = self.forward[0] * sample + self.state[0];
        self.state[0] = self.forward[1] * sample - self.back[0] * value + self.state[1];
        self.state[1] = self.forward[2] * sample - self.back[1] * value;
        value
    }

    /// Forgets what is too small to matter; to be called now and then.
    pub(crate) fn settle(&mut self) {
        for state in self.state.iter_mut().filter(|state| state.abs() < TINY) {
            *state = 0.0;
        }
    }
}
