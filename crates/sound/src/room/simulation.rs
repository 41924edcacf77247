//! Recordings in a room, and the truth about them.

use std::ops::Range;

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use crate::fourier::Fourier;

use super::check::{check, check_duration};
use super::error::RoomError;
use super::options::{Recorder, RoomOptions};
use super::placement::{distance, place, times};
use super::response::Response;
use super::walls::reflection;
use super::waveform::Waveform;
use crate::kernel::{BEFORE, Kernel};

/// Simulated recordings.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct RoomRecording {
    /// Samples per second of the recorder's clock, Hz.
    pub sample_rate: u32,
    /// Samples of each microphone, all the same number.
    pub channels: Vec<Vec<f32>>,
    /// Which channels each recorder has.
    pub recorders: Vec<Range<usize>>,
    /// What is to be found in the recordings.
    pub truth: RoomTruth,
}

/// The truth about simulated recordings.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RoomTruth {
    /// Where the microphones are, metres from the corner of the room.
    pub microphones: Vec<[f64; 3]>,
    /// Where the sources are, metres from the corner of the room.
    pub sources: Vec<[f64; 3]>,
    /// When the sources sound, seconds.
    pub times: Vec<f64>,
    /// When the direct sound of each source begins to arrive, seconds of the recorder's clock from its first sample: one
    /// row a microphone. Outside the recording if it was not running.
    pub arrivals: Vec<Vec<f64>>,
    /// What a sound of amplitude 1 at 1 metre has become in the samples.
    pub gain: f64,
    /// Standard deviation of the noise, in the samples.
    pub noise: f64,
}

/// Simulates recordings in a room. The same options give the same samples, on any number of processors.
///
/// Sounds are filtered as a recorder does it: up to 0.84 of half the sample rate they are there in full, and at half the
/// sample rate not at all. Impulses of the filter reach 32 samples before their time.
///
/// # Errors
/// If an option is out of range, or there is too much to compute.
///
/// ```
/// let mut options = sound::RoomOptions::default();
/// options.microphones = sound::Placement::Given(vec![[1.0, 1.0, 1.0], [4.43, 1.0, 1.0]]);
/// options.sources = sound::Placement::Given(vec![[7.86, 1.0, 1.0]]);
/// options.times = Some(vec![0.5]);
/// let recording = sound::simulate_room(&options)?;
/// // 6.86 m and 3.43 m at 343 m/s.
/// let arrivals = &recording.truth.arrivals;
/// assert!((arrivals[0][0] - 0.52).abs() < 1e-12 && (arrivals[1][0] - 0.51).abs() < 1e-12);
/// assert_eq!(recording.channels.len(), 2);
/// # Ok::<(), sound::RoomError>(())
/// ```
pub fn simulate_room(options: &RoomOptions) -> Result<RoomRecording, RoomError> {
    check(options)?;
    let (sample_rate, kernel) = (f64::from(options.sample_rate), Kernel::new());
    let response = Response { options, reflection: reflection(options)?, kernel: &kernel };
    let mut rng = Pcg64Mcg::seed_from_u64(options.seed);
    let (microphones, sources) = place(options, &mut rng)?;
    let times = times(options, &mut rng);
    let recorders = options.all_recorders();
    let duration = options.duration.unwrap_or_else(|| default_duration(options, &times, &recorders));
    check_duration(options, duration)?;
    let frames = (duration * sample_rate).ceil() as usize;
    let waveforms: Vec<Waveform> = times.iter().map(|_| Waveform::new(options.sound, sample_rate, &mut rng)).collect();

    // Singles: their errors are below 10^-7 of the samples, 140 dB, and the samples are what takes the memory.
    let mut channels = vec![vec![0.0_f32; frames]; microphones.len()];
    let mut arrivals = vec![Vec::with_capacity(times.len()); microphones.len()];
    let mut ranges = Vec::with_capacity(recorders.len());
    let mut begin = 0;
    for recorder in &recorders {
        let range = begin..begin + recorder.channels;
        begin = range.end;
        let pace = pace(recorder);
        let longest = waveforms.iter().map(|waveform| waveform.samples(sample_rate, pace, &kernel).len()).max();
        // An echo is one impulse of 64 samples, whatever the sound. Added as the sound itself, each of the many thousand echoes
        // would be some hundred samples for a clap and many thousand for a chirp; transforms are two for every sound at
        // every microphone.
        let fourier = Fourier::new(response.length(pace) + longest.unwrap_or(0));
        for ((waveform, &source), &time) in waveforms.iter().zip(&sources).zip(&times) {
            let sound = fourier.spectrum(&waveform.samples(sample_rate, pace, &kernel));
            for k in range.clone() {
                let travel = distance(source, microphones[k]) / options.speed;
                let arrival = pace * (time + travel - recorder.start);
                arrivals[k].push(arrival);
                let place = arrival * sample_rate;
                let (fraction, passed) = (place - place.floor(), options.passed(k));
                let way = response.samples(source, microphones[k], pace, fraction, passed);
                let heard = fourier.product(&sound, &fourier.spectrum(&way));
                // Both signals begin before their time.
                add(&mut channels[k], place.floor() as i64 - 2 * BEFORE as i64, &heard);
            }
        }
        ranges.push(range);
    }

    let loudest = f64::from(channels.iter().flatten().fold(0.0_f32, |most, sample| most.max(sample.abs())));
    let gain = if loudest > 0.0 { options.peak / loudest } else { 1.0 };
    let power = gain * gain * direct_power(options, &waveforms, &sources, &microphones, &kernel);
    let noise = options.signal_to_noise.map_or(0.0, |decibel| (power / 10.0_f64.powf(decibel / 10.0)).sqrt());
    for sample in channels.iter_mut().flatten() {
        let noise = if noise > 0.0 { noise * rng.sample::<f64, _>(StandardNormal) } else { 0.0 };
        *sample = (gain * f64::from(*sample) + noise) as f32;
    }
    let truth = RoomTruth { microphones, sources, times, arrivals, gain, noise };
    Ok(RoomRecording { sample_rate: options.sample_rate, channels, recorders: ranges, truth })
}

/// The factor by which a clock is fast.
fn pace(recorder: &Recorder) -> f64 {
    1.0 + recorder.rate * 1e-6
}

/// A second more than the last sound and its echoes take, by every clock; at least a second.
fn default_duration(options: &RoomOptions, times: &[f64], recorders: &[Recorder]) -> f64 {
    let last = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let diagonal = options.extent.iter().map(|side| side * side).sum::<f64>().sqrt();
    let end = last + diagonal / options.speed + options.echo_time() + options.sound_length();
    recorders.iter().map(|recorder| pace(recorder) * (end - recorder.start)).fold(0.0, f64::max) + 1.0
}

/// The mean power of the direct sounds at the microphones while they last, at a gain of 1 and without obstacles.
fn direct_power(
    options: &RoomOptions,
    waveforms: &[Waveform],
    sources: &[[f64; 3]],
    microphones: &[[f64; 3]],
    kernel: &Kernel,
) -> f64 {
    let sample_rate = f64::from(options.sample_rate);
    let count = (options.sound_length() * sample_rate).max(1.0);
    let mut sum = 0.0;
    for (waveform, &source) in waveforms.iter().zip(sources) {
        let samples = waveform.samples(sample_rate, 1.0, kernel);
        let power = samples.iter().map(|sample| sample * sample).sum::<f64>() / count;
        sum += microphones.iter().map(|&at| power / distance(source, at).powi(2)).sum::<f64>();
    }
    sum / (sources.len() * microphones.len()).max(1) as f64
}

/// Adds a signal that begins at this sample, as far as it is in the channel.
fn add(channel: &mut [f32], begin: i64, signal: &[f64]) {
    let (into, from) = match usize::try_from(begin) {
        Ok(begin) => (begin, 0),
        Err(_) => (0, usize::try_from(begin.unsigned_abs()).unwrap_or(usize::MAX)),
    };
    let (Some(channel), Some(signal)) = (channel.get_mut(into..), signal.get(from..)) else { return };
    channel.iter_mut().zip(signal).for_each(|(sample, heard)| *sample += *heard as f32);
}
