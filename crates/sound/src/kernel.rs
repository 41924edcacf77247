//! Impulses between samples: a windowed sinc, as a recorder's filter before its converter would make them.

/// Samples that an impulse takes.
pub(crate) const TAPS: usize = 64;
/// Samples before the one at or before an impulse.
pub(crate) const BEFORE: usize = TAPS / 2 - 1;
/// Places between two samples that are tabulated. Between them it is linear, with errors below pi^2 / 8 of the square
/// of their distance: 5e-6.
const PHASES: usize = 512;
/// Highest frequency, as a share of half the sample rate. What is above half the sample rate would come back as a lower
/// frequency with a wrong delay: the filter must have ended there, and is 0.16 wide (next constant), half of it above
/// this.
const CUTOFF: f64 = 0.92;
/// Shape of Kaiser's window for 80 dB: 0.1102 (80 - 8.7); with 64 taps, the filter falls over (80 - 7.95) / (2.285 63)
/// = 0.50 radians, which is 0.16 of pi (J. F. Kaiser, 1974).
const SHAPE: f64 = 7.857;

/// The table of impulses.
pub(crate) struct Kernel {
    /// One row for each place between two samples, and one more.
    rows: Vec<[f64; TAPS]>,
}

impl Kernel {
    pub(crate) fn new() -> Kernel {
        let row = |phase: usize| {
            let fraction = phase as f64 / PHASES as f64;
            std::array::from_fn(|tap| impulse(tap as f64 - BEFORE as f64 - fraction))
        };
        Kernel { rows: (0..=PHASES).map(row).collect() }
    }

    /// Adds an impulse of this size at a place in `signal`, samples from its first; nothing if it would not lie wholly
    /// in it.
    pub(crate) fn add(&self, signal: &mut [f64], place: f64, size: f64) {
        let whole = place.floor();
        if !(whole >= BEFORE as f64 && whole <= signal.len() as f64) {
            return;
        }
        let begin = whole as usize - BEFORE;
        let Some(signal) = signal.get_mut(begin..begin + TAPS) else { return };
        let phase = (place - whole) * PHASES as f64;
        let row = (phase as usize).min(PHASES - 1);
        let next = size * (phase - row as f64);
        let this = size - next;
        for ((sample, a), b) in signal.iter_mut().zip(&self.rows[row]).zip(&self.rows[row + 1]) {
            *sample += this * a + next * b;
        }
    }
}

/// The impulse, at a time in samples.
fn impulse(time: f64) -> f64 {
    let at = time / (TAPS / 2) as f64;
    if at.abs() >= 1.0 {
        return 0.0;
    }
    let window = bessel(SHAPE * (1.0 - at * at).sqrt()) / bessel(SHAPE);
    let x = std::f64::consts::PI * CUTOFF * time;
    window * CUTOFF * if x.abs() < 1e-9 { 1.0 } else { x.sin() / x }
}

/// The modified Bessel function of order 0, by its series: all terms are positive.
fn bessel(x: f64) -> f64 {
    let quarter = x * x / 4.0;
    let terms = (1..60).scan(1.0, |term, k| {
        *term *= quarter / f64::from(k * k);
        Some(*term)
    });
    1.0 + terms.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Size and delay, in samples, that an impulse at this place gives a tone of this frequency, radians a sample.
    fn response(place: f64, frequency: f64) -> (f64, f64) {
        let mut signal = vec![0.0; 200];
        Kernel::new().add(&mut signal, place, 1.0);
        let sum = |wave: fn(f64) -> f64| -> f64 {
            signal.iter().enumerate().map(|(k, sample)| sample * wave(frequency * (k as f64 - place.floor()))).sum()
        };
        let (real, imaginary) = (sum(f64::cos), sum(f64::sin));
        (real.hypot(imaginary), place.floor() + imaginary.atan2(real) / frequency)
    }

    #[test]
    fn bessel_function_in_more_digits() {
        // I0 at 1, 5 and 10, by 80 terms in 30 digits of Python's module decimal.
        for (x, value) in [(1.0, 1.266_065_877_752_008), (5.0, 27.239_871_823_604_447), (10.0, 2_815.716_628_466_254_5)]
        {
            assert!((bessel(x) / value - 1.0).abs() < 1e-14, "{x}");
        }
    }

    #[test]
    fn delays_are_right_to_a_thousandth_of_a_sample() {
        for fraction in [0.0, 0.37, 0.5, 0.999, 1.0 / 1024.0] {
            let place = 100.0 + fraction;
            for share in [0.01, 0.1, 0.3, 0.5, 0.7, 0.83] {
                let (size, delay) = response(place, share * PI);
                assert!((delay - place).abs() < 1e-3, "{share} at {place}: {delay}");
                // 80 dB are a factor of 10^4.
                assert!((size - 1.0).abs() < 2e-4, "{share} at {place}: {size}");
            }
        }
    }

    #[test]
    fn nothing_is_written_outside() {
        let kernel = Kernel::new();
        for place in [f64::NAN, f64::INFINITY, -1.0, 0.0, 30.9, 97.0, 1e300] {
            let mut signal = vec![0.0; 96];
            kernel.add(&mut signal, place, 1.0);
            assert!(signal.iter().all(|&sample| sample == 0.0), "{place}");
        }
        let mut signal = vec![0.0; TAPS];
        kernel.add(&mut signal, 31.0, 1.0);
        assert!((signal[31] - CUTOFF).abs() < 1e-12);
    }
}
