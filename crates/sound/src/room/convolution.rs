//! Convolution by Fourier transforms. An echo is then one impulse of 64 samples, whatever the sound; added as the sound
//! itself, each of the many thousand echoes would be some hundred samples for a clap and many thousand for a chirp. The
//! transforms are few: two for every sound at every microphone.

use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Transforms of one length.
pub(super) struct Convolution {
    length: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Convolution {
    /// For signals whose lengths sum to at most this.
    pub(super) fn new(length: usize) -> Convolution {
        let length = length.max(2).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        Convolution { length, forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
    }

    /// The transform of a signal, with zeros after it.
    pub(super) fn spectrum(&self, signal: &[f64]) -> Vec<Complex<f64>> {
        let (mut input, mut spectrum) = (self.forward.make_input_vec(), self.forward.make_output_vec());
        input.iter_mut().zip(signal).for_each(|(input, sample)| *input = *sample);
        // It fails for vectors of other lengths alone.
        let done = self.forward.process(&mut input, &mut spectrum);
        debug_assert!(done.is_ok());
        spectrum
    }

    /// The signal whose transform is the product of these.
    pub(super) fn product(&self, a: &[Complex<f64>], b: &[Complex<f64>]) -> Vec<f64> {
        let (mut spectrum, mut signal) = (self.inverse.make_input_vec(), self.inverse.make_output_vec());
        for ((product, a), b) in spectrum.iter_mut().zip(a).zip(b) {
            *product = a * b / self.length as f64;
        }
        // Of real signals these are real.
        let last = spectrum.len() - 1;
        (spectrum[0].im, spectrum[last].im) = (0.0, 0.0);
        let done = self.inverse.process(&mut spectrum, &mut signal);
        debug_assert!(done.is_ok());
        signal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_polynomials() {
        // (1 + 2x + 3x^2) (4 + 5x) = 4 + 13x + 22x^2 + 15x^3.
        let convolution = Convolution::new(5);
        let product = convolution.product(&convolution.spectrum(&[1.0, 2.0, 3.0]), &convolution.spectrum(&[4.0, 5.0]));
        let expected = [4.0, 13.0, 22.0, 15.0, 0.0, 0.0, 0.0, 0.0];
        assert!(product.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{product:?}");
    }
}
