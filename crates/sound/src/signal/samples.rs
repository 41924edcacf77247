//! Signals as samples of a recording.

use super::chirp::chirp;
use super::known::Signal;
use crate::kernel::{BEFORE, Kernel, TAPS};

/// The samples of a signal at this rate, and how many of them are before its beginning.
pub(super) fn samples(signal: &Signal, rate: f64) -> (Vec<f64>, usize) {
    match signal {
        Signal::Unknown => (Vec::new(), 0),
        Signal::Chirp { from, to, seconds } => {
            let count = (seconds * rate).ceil() as usize + 1;
            let sample = |k: usize| {
                let time = k as f64 / rate;
                // What is above half of the rate would come back as a lower frequency.
                let is_there = from + (to - from) * time / seconds < 0.5 * rate;
                if is_there { chirp(time, *from, *to, *seconds) } else { 0.0 }
            };
            ((0..count).map(sample).collect(), 0)
        }
        Signal::Template { samples, sample_rate } => (resampled(samples, rate / sample_rate), BEFORE),
    }
}

/// Samples at a rate that is this many times theirs, [`BEFORE`] of them before the beginning. What is above half of the lower
/// rate is not right.
fn resampled(samples: &[f32], ratio: f64) -> Vec<f64> {
    let kernel = Kernel::new();
    let mut all = vec![0.0; (samples.len() as f64 * ratio).ceil() as usize + TAPS];
    for (k, sample) in samples.iter().enumerate() {
        kernel.add(&mut all, BEFORE as f64 + k as f64 * ratio, f64::from(*sample));
    }
    all
}
