//! Options are checked before anything is made of their size.

use super::error::RoomError;
use super::options::{Placement, RoomOptions, Sound};

/// Most samples of all channels together: 4 GB.
const MAX_SAMPLES: f64 = 1e9;
/// Most samples of a sound, and of a response.
const MAX_LENGTH: f64 = 1e7;
/// Most echoes of all sources at all microphones: some minutes of work.
const MAX_ECHOES: f64 = 5e9;

/// Checks the options, but not the length of the recordings, which may depend on random times.
///
/// # Errors
/// If a number is out of its range, lists do not fit, or there is too much to do.
pub(super) fn check(options: &RoomOptions) -> Result<(), RoomError> {
    ranges(options)?;
    let (microphones, sources) = (options.microphones.count(), options.sources.count());
    if let Some(times) = &options.times {
        fits("times", times.len(), "sources", sources)?;
    }
    let channels = options.all_recorders().iter().fold(0, |sum: usize, recorder| sum.saturating_add(recorder.channels));
    fits("channels", channels, "microphones", microphones)?;
    for (kind, placement) in [("microphone", &options.microphones), ("source", &options.sources)] {
        let Placement::Given(points) = placement else { continue };
        for (&point, number) in points.iter().zip(1..) {
            if !(0..3).all(|axis| point[axis] > 0.0 && point[axis] < options.extent[axis]) {
                return Err(RoomError::Outside { kind, number, point });
            }
        }
    }
    let rate = f64::from(options.sample_rate);
    let shorten = "shorten the sounds or the time of the echoes, or lower the sample rate";
    let length = options.sound_length().max(options.echo_time()) * rate;
    at_most("samples of a sound or its echoes", length, MAX_LENGTH, shorten)?;
    let fewer = "shorten the time of the echoes, limit their order, or take fewer microphones or sources";
    at_most("echoes", echoes(options) * microphones as f64 * sources as f64, MAX_ECHOES, fewer)
}

/// Checks the size of the recordings, whose duration is in seconds.
///
/// # Errors
/// If they are too large.
pub(super) fn check_duration(options: &RoomOptions, duration: f64) -> Result<(), RoomError> {
    if !(duration > 0.0 && duration < 1e9) {
        return Err(RoomError::Range { name: "the duration", range: "positive and below 1e9 s", value: duration });
    }
    let samples = (duration * f64::from(options.sample_rate) + 1.0) * options.microphones.count() as f64;
    at_most("samples", samples, MAX_SAMPLES, "shorten the recordings or take fewer microphones")
}

/// An upper limit for the number of echoes of one sound at one microphone: those in a box around the sphere in which
/// images are kept.
fn echoes(options: &RoomOptions) -> f64 {
    if options.reverberation == 0.0 {
        return 1.0;
    }
    let diagonal = options.extent.iter().map(|side| side * side).sum::<f64>().sqrt();
    let radius = diagonal + options.speed * options.echo_time();
    let order = options.max_order.map_or(f64::INFINITY, f64::from);
    options.extent.iter().map(|side| 2.0 * (radius / side).min(order) + 2.0).product()
}

fn fits(name: &'static str, found: usize, of: &'static str, expected: usize) -> Result<(), RoomError> {
    if found == expected { Ok(()) } else { Err(RoomError::Count { name, found, of, expected }) }
}

fn at_most(name: &'static str, amount: f64, limit: f64, remedy: &'static str) -> Result<(), RoomError> {
    if amount <= limit { Ok(()) } else { Err(RoomError::TooMuch { name, amount, limit, remedy }) }
}

fn ranges(options: &RoomOptions) -> Result<(), RoomError> {
    let nyquist = f64::from(options.sample_rate) / 2.0;
    let within = |name, range, value: f64, least: f64, most: f64| {
        if (least..=most).contains(&value) { Ok(()) } else { Err(RoomError::Range { name, range, value }) }
    };
    let above_zero = |name, range, value: f64, most: f64| within(name, range, value, f64::MIN_POSITIVE, most);
    for (name, side) in ["the length", "the width", "the height"].into_iter().zip(options.extent) {
        within(name, "0.1 to 1000 m", side, 0.1, 1000.0)?;
    }
    within("the reverberation time", "0 to 30 s", options.reverberation, 0.0, 30.0)?;
    within("the time of echoes", "0 to 30 s", options.echo_time(), 0.0, 30.0)?;
    within("the speed of sound", "1 to 1e5 m/s", options.speed, 1.0, 1e5)?;
    within("the sample rate", "100 to 1e6 Hz", options.sample_rate.into(), 100.0, 1e6)?;
    within("the signal-to-noise ratio", "-200 to 200 dB", options.signal_to_noise.unwrap_or(0.0), -200.0, 200.0)?;
    match options.sound {
        Sound::Clap { length, decay } => {
            above_zero("the length of claps", "positive and at most 10 s", length, 10.0)?;
            above_zero("the decay of claps", "positive and finite", decay, f64::MAX)?;
        }
        Sound::Chirp { from, to, length } => {
            above_zero("the length of chirps", "positive and at most 60 s", length, 60.0)?;
            for frequency in [from, to] {
                let range = "positive and at most half of the sample rate";
                above_zero("the frequency of chirps", range, frequency, nyquist)?;
            }
        }
    }
    within("the number of microphones", "1 to 1000", options.microphones.count() as f64, 1.0, 1000.0)?;
    within("the number of sources", "1 to 10000", options.sources.count() as f64, 1.0, 10000.0)?;
    within("the distance from walls", "0 to 1000 m", options.wall_distance, 0.0, 1000.0)?;
    within("the distance between points", "0.01 to 1000 m", options.separation, 0.01, 1000.0)?;
    for &time in options.times.iter().flatten().chain([&options.first]) {
        within("a time of emission", "-1e6 to 1e6 s", time, -1e6, 1e6)?;
    }
    within("the interval", "0 to 1e4 s", options.interval, 0.0, 1e4)?;
    within("the jitter", "0 to 1e4 s", options.jitter, 0.0, 1e4)?;
    for recorder in &options.recorders {
        within("the start of a recorder", "-1e6 to 1e6 s", recorder.start, -1e6, 1e6)?;
        within("the rate of a recorder", "-1e4 to 1e4 ppm", recorder.rate, -1e4, 1e4)?;
    }
    for obstacle in &options.obstacles {
        let last = options.microphones.count().saturating_sub(1) as f64;
        let range = "less than the number of microphones";
        within("the microphone of an obstacle, counted from 0", range, obstacle.microphone as f64, 0.0, last)?;
        within("the attenuation of an obstacle", "0 to 200 dB", obstacle.attenuation_db, 0.0, 200.0)?;
    }
    above_zero("the peak", "positive and at most 1", options.peak, 1.0)
}
