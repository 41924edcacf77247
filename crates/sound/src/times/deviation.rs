//! How well arrival times are known.
//!
//! A sound alone, compared with itself, has a correlation that is even about its delay. Noise, and echoes too near to have
//! a peak of their own, add something that is not; where its slope is not zero, it moves the peak, in all pairs of the
//! channel alike. What its slope is at the peak cannot be told, as there the slope of all is zero, but how large it is
//! on either side. Over the sharpness of the peak that is a standard deviation of its place.

use super::correlation::{Correlation, Delays};
use crate::quantile::{MEDIAN, quantile};
use std::f64::consts::SQRT_2;

/// The standard deviation of the place of a peak, seconds, by what is within these delays of it.
pub(super) fn deviation(correlation: &Correlation, delay: f64, delays: &Delays) -> Option<f64> {
    let sharpness = correlation.sharpness(delay);
    let slopes: Vec<f64> = correlation.odd_slopes(delay, delays).into_iter().map(f64::abs).collect();
    // At the peak both sides of what is odd are one; elsewhere they are independent, and it is half of their sum.
    // The median leaves out the peaks of echoes.
    let typical = SQRT_2 * quantile(slopes, 0.5)? / MEDIAN;
    (sharpness > 0.0).then(|| typical / sharpness).filter(|sigma| sigma.is_finite())
}
