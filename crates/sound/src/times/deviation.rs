//! How well arrival times are known.
//!
//! A sound alone, compared with itself, has a correlation that is even about its delay. Noise, and echoes too near to have
//! a peak of their own, add something that is not; where its slope is not zero, it moves the peak, in all pairs of the
//! channel alike. What its slope is at the peak cannot be told, as there the slope of all is zero, but how large it is
//! on either side. Over the sharpness of the peak that is a standard deviation of its place.

use super::correlation::Correlation;
use super::options::TimeOptions;
use super::spectrum::Spectrum;

/// Share of the length of what is compared within which slopes are looked at, on either side.
const NEAR: f64 = 0.5;

/// The median of the amounts of a normal variable of standard deviation 1.
const MEDIAN: f64 = 0.6745;

/// Standard deviations of the times of channels, seconds: at most the length of what is compared, as of a single channel,
/// which has nothing to compare with. The channels have these delays beside their leading edges.
pub(super) fn deviations(channels: &[(&Spectrum, f64)], options: &TimeOptions) -> Vec<f64> {
    let deviation = |k: usize| {
        let (own, delay) = channels[k];
        // Compared with itself, a channel would have less than it has.
        let others: Vec<(&Spectrum, f64)> = [&channels[..k], &channels[k + 1..]].concat();
        let sound = Spectrum::common(&others)?;
        let correlation = Correlation::new(own, &sound, options);
        let (spacing, sharpness) = (correlation.spacing(), correlation.sharpness(delay));
        let odd = |off: f64| 0.5 * (correlation.slope(delay + off) + correlation.slope(delay - off)).abs();
        let count = (NEAR * options.length / spacing) as usize;
        let mut slopes: Vec<f64> = (1..=count).map(|k| odd(k as f64 * spacing)).collect();
        // The median leaves out the peaks of echoes.
        slopes.sort_by(f64::total_cmp);
        let typical = slopes.get(slopes.len() / 2)? / MEDIAN;
        (sharpness > 0.0).then(|| typical / sharpness)
    };
    let most = options.length;
    (0..channels.len()).map(|k| deviation(k).filter(|sigma| *sigma <= most).unwrap_or(most)).collect()
}
