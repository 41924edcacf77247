//! Random numbers: every stream is named by a seed and a purpose, never by a thread.

use num_complex::Complex64;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A stream of generic complex numbers.
pub struct Random(Pcg64);

impl Random {
    /// The stream of a seed; `stream` tells apart streams of one seed.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mixed = seed ^ stream.wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(17);
        Random(Pcg64::seed_from_u64(mixed))
    }

    /// A complex standard normal number: `E |z|^2 = 1`.
    pub fn normal(&mut self) -> Complex64 {
        // Box and Muller; 1 - u lies in (0, 1].
        let radius = (-(1.0 - self.0.random::<f64>()).ln()).sqrt();
        Complex64::from_polar(radius, std::f64::consts::TAU * self.0.random::<f64>())
    }

    /// A point on the unit circle.
    pub fn unit(&mut self) -> Complex64 {
        Complex64::from_polar(1.0, std::f64::consts::TAU * self.0.random::<f64>())
    }

    /// Independent complex standard normal numbers.
    pub fn normals(&mut self, len: usize) -> Vec<Complex64> {
        (0..len).map(|_| self.normal()).collect()
    }
}
