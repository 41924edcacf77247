//! Fourier transforms of real signals.

use std::sync::Arc;

use realfft::num_complex::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Transforms of one length, which is a power of two.
pub(crate) struct Fourier {
    length: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

impl Fourier {
    /// For signals of at least this length.
    pub(crate) fn new(length: usize) -> Fourier {
        let length = length.max(2).next_power_of_two();
        let mut planner = RealFftPlanner::new();
        Fourier { length, forward: planner.plan_fft_forward(length), inverse: planner.plan_fft_inverse(length) }
    }

    /// Length of signals; spectra have half of it and one.
    pub(crate) fn length(&self) -> usize {
        self.length
    }

    /// The transform of a signal, with zeros after it.
    pub(crate) fn spectrum<S: Copy + Into<f64>>(&self, signal: &[S]) -> Vec<Complex<f64>> {
        let (mut input, mut spectrum) = (self.forward.make_input_vec(), self.forward.make_output_vec());
        input.iter_mut().zip(signal).for_each(|(input, sample)| *input = (*sample).into());
        // It fails for vectors of other lengths alone.
        let done = self.forward.process(&mut input, &mut spectrum);
        debug_assert!(done.is_ok());
        spectrum
    }

    /// The signal that has this transform; what is missing of it is zero.
    pub(crate) fn signal(&self, spectrum: impl Iterator<Item = Complex<f64>>) -> Vec<f64> {
        let (mut values, mut signal) = (self.inverse.make_input_vec(), self.inverse.make_output_vec());
        values.iter_mut().zip(spectrum).for_each(|(value, given)| *value = given / self.length as f64);
        // Of real signals these are real.
        let last = values.len() - 1;
        (values[0].im, values[last].im) = (0.0, 0.0);
        let done = self.inverse.process(&mut values, &mut signal);
        debug_assert!(done.is_ok());
        signal
    }

    /// The signal whose transform is the product of these: for signals whose lengths sum to at most that of the transforms,
    /// their convolution.
    pub(crate) fn product(&self, a: &[Complex<f64>], b: &[Complex<f64>]) -> Vec<f64> {
        self.signal(a.iter().zip(b).map(|(a, b)| a * b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_of_polynomials() {
        // (1 + 2x + 3x^2) (4 + 5x) = 4 + 13x + 22x^2 + 15x^3.
        let fourier = Fourier::new(5);
        let product = fourier.product(&fourier.spectrum(&[1.0, 2.0, 3.0]), &fourier.spectrum(&[4.0, 5.0]));
        let expected = [4.0, 13.0, 22.0, 15.0, 0.0, 0.0, 0.0, 0.0];
        assert!(product.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{product:?}");
    }
}
