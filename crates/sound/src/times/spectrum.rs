//! What an event is made of, by frequency.

use super::options::{TimeOptions, Window};
use crate::fade::fade;
use crate::format::HIGHEST;
use num_complex::Complex64;
use std::f64::consts::TAU;

/// Spectra are taken at steps of one over this many times the length of what is compared: twice keeps delays of its length
/// from folding.
const PADDING: f64 = 2.0;

/// Samples that are taken together.
const TOGETHER: usize = 8;

/// Share of the length over which both ends fade.
const FADE: f64 = 0.1;

/// The spectrum of a channel about its leading edge.
pub(super) struct Spectrum {
    pub(super) values: Vec<Complex64>,
    /// Step of frequencies, Hz, and the lowest one in steps.
    pub(super) step: f64,
    pub(super) first: usize,
}

impl Spectrum {
    /// Step of frequencies, Hz.
    pub(super) fn step(options: &TimeOptions) -> f64 {
        1.0 / (PADDING * options.length)
    }

    /// Of what is compared about a leading edge, seconds by the recorder's clock; frequencies have this step, Hz.
    pub(super) fn new(window: &Window<'_>, edge: f64, options: &TimeOptions, step: f64) -> Spectrum {
        let (rate, [low, high]) = (window.sample_rate, options.band);
        // Frequencies are whole steps.
        let lowest = (low / step).ceil();
        let count = (high.min(HIGHEST * rate) / step - lowest).max(0.0) as usize + 1;
        let begin = edge - options.before - window.start;
        let first = (begin * rate).ceil().max(0.0) as usize;
        let samples = window.samples.get(first..).unwrap_or_default();
        let samples = &samples[..samples.len().min((options.length * rate) as usize)];
        let mut values = vec![Complex64::default(); count];
        // The turn of a sample from one frequency to the next waits for the one before; those of several samples do not.
        for (part, samples) in samples.chunks(TOGETHER).enumerate() {
            let (mut turns, mut by) = ([Complex64::default(); TOGETHER], [Complex64::default(); TOGETHER]);
            for (k, sample) in samples.iter().enumerate() {
                let at = (first + part * TOGETHER + k) as f64 / rate - begin;
                // The edge is the time zero.
                let phase = |frequency: f64| Complex64::cis(-TAU * frequency * (at - options.before));
                let sample = f64::from(*sample) * fade(at / options.length, FADE);
                (turns[k], by[k]) = (sample * phase(lowest * step), phase(step));
            }
            for value in &mut values {
                for (turn, by) in turns.iter_mut().zip(&by) {
                    *value += *turn;
                    *turn *= by;
                }
            }
        }
        Spectrum { values, step, first: lowest as usize }
    }

    /// The sound that channels have in common, if these are about the time at which each hears it: what is on other ways is
    /// at other times in each.
    pub(super) fn common<'a>(all: impl IntoIterator<Item = &'a Spectrum>) -> Option<Spectrum> {
        let mut sound: Option<Spectrum> = None;
        for spectrum in all {
            let Spectrum { values, step, first } = spectrum;
            let power: f64 = values.iter().map(Complex64::norm_sqr).sum();
            let factor = 1.0 / power.sqrt().max(f64::MIN_POSITIVE);
            let silence = || Spectrum { values: vec![Complex64::default(); values.len()], step: *step, first: *first };
            let sums = &mut sound.get_or_insert_with(silence).values;
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
        }
        sound
    }
}
