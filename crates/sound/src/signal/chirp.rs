//! Tones that rise or fall evenly.

use std::f64::consts::PI;

use crate::fade::fade;

/// Share of the length over which both ends fade.
const FADE: f64 = 0.05;

/// A chirp at a time after its beginning: frequencies at its beginning and its end, Hz, times in seconds.
pub(crate) fn chirp(time: f64, from: f64, to: f64, length: f64) -> f64 {
    let share = time / length;
    if !(0.0..=1.0).contains(&share) {
        return 0.0;
    }
    fade(share, FADE) * (2.0 * PI * time * (from + (to - from) * share / 2.0)).sin()
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
