//! Arrival times from the parts of all channels in which an event is.

use super::arrival::{Arrival, PEAKS};
use super::consistent::{Pair, consistent};
use super::correlation::{Correlation, Delays};
use super::direct;
use super::edge::edge;
use super::error::TimeError;
use super::known;
use super::options::{TimeOptions, Window};
use super::spectrum::Spectrum;
use crate::signal::{Compression, Signal};

/// How much more than is compared at last is compared first: an echo may have been the first to rise above the noise, or above
/// its share of the loudest one.
const WIDER: f64 = 1.5;

/// How large peaks of a pair of channels are at least beside the largest.
const LEAST: f64 = 0.4;

/// The times at which an event begins in each channel, from the part of each in which it is; `None` for channels that have
/// no such part, or in whose part nothing rises above the noise, or nothing
/// that the others have too. Parts in which a signal is looked for hold all of it.
///
/// # Errors
/// If an option is out of range, the sample rate of a part is not from 100 Hz to 10 MHz, or the signal has too little in the
/// band.
///
/// ```
/// let mut options = sound::RoomOptions::default();
/// (options.microphones, options.sources) = (sound::Placement::Random(5), sound::Placement::Random(1));
/// let made = sound::simulate_room(&options)?;
/// // Half a second of each channel from half a second on: the clap comes after a second.
/// let part = |samples: &Vec<f32>| samples[24_000..].iter().copied().take(48_000).collect::<Vec<f32>>();
/// let parts: Vec<Vec<f32>> = made.channels.iter().map(part).collect();
/// let window = |part| Some(sound::Window { samples: part, start: 0.5, sample_rate: 48_000.0 });
/// let windows: Vec<_> = parts.iter().map(Vec::as_slice).map(window).collect();
/// let found = sound::arrival_times(&windows, &sound::TimeOptions::default())?;
/// let late = |k: usize| found[k].as_ref().map(|arrival| arrival.seconds - made.truth.arrivals[k][0]);
/// let (first, second) = (late(0).unwrap(), late(1).unwrap());
/// assert!((first - second).abs() < 2e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn arrival_times(windows: &[Option<Window<'_>>], options: &TimeOptions) -> Result<Vec<Option<Arrival>>, TimeError> {
    options.validate()?;
    if let Some(window) = windows.iter().flatten().find(|window| !(100.0..=1e7).contains(&window.sample_rate)) {
        let range = "from 100 to 10,000,000 Hz";
        return Err(TimeError::Option { name: "a sample rate", value: window.sample_rate, range });
    }
    if options.signal != Signal::Unknown {
        return known_times(windows, options);
    }
    let edges: Vec<Option<f64>> = windows.iter().map(|window| edge(window.as_ref()?, options)).collect();
    let wide = TimeOptions { length: WIDER * options.length, before: WIDER * options.length / 2.0, ..options.clone() };
    let heard: Vec<(usize, f64)> = edges.iter().enumerate().filter_map(|(k, edge)| Some((k, (*edge)?))).collect();
    let of = |&(k, edge): &(usize, f64)| Some(Spectrum::new(windows[k].as_ref()?, edge, &wide, Spectrum::step(&wide)));
    let spectra: Vec<Spectrum> = heard.iter().filter_map(of).collect();
    let off = compared(&spectra, options.whitening, &Delays::new(&wide));
    let channel = |(&(k, edge), off): (&(usize, f64), f64)| {
        Some(direct::Channel { window: windows[k].as_ref()?, edge, time: edge + off })
    };
    let channels: Vec<direct::Channel<'_>> = heard.iter().zip(off).filter_map(channel).collect();
    let mut all = vec![None; windows.len()];
    for ((k, _), arrival) in heard.iter().zip(direct::arrivals(channels, options, &wide)) {
        all[*k] = arrival;
    }
    Ok(all)
}

/// The times at which a known signal begins in each channel.
fn known_times(windows: &[Option<Window<'_>>], options: &TimeOptions) -> Result<Vec<Option<Arrival>>, TimeError> {
    let longest = windows.iter().flatten().map(|window| window.samples.len()).max().unwrap_or(0);
    let mut compressions: Vec<(f64, Compression)> = Vec::new();
    for window in windows.iter().flatten() {
        let rate = window.sample_rate;
        if compressions.iter().all(|(other, _)| *other != rate) {
            let made = Compression::new(&options.signal, options.band, rate, longest)?;
            compressions.extend(made.map(|compression| (rate, compression)));
        }
    }
    let of = |window: &Option<Window<'_>>| {
        let window = window.as_ref()?;
        let (_, compression) = compressions.iter().find(|(rate, _)| *rate == window.sample_rate)?;
        known::arrival(window, compression)
    };
    Ok(windows.iter().map(of).collect())
}

/// The delays of channels beside their leading edges, by what each two have in common, seconds.
fn compared(spectra: &[Spectrum], whitening: f64, delays: &Delays) -> Vec<f64> {
    let mut pairs = Vec::new();
    for (a, first) in spectra.iter().enumerate() {
        for (b, second) in spectra.iter().enumerate().skip(a + 1) {
            let mut peaks = Correlation::of(first, second, whitening).peaks(LEAST, delays);
            peaks.truncate(PEAKS);
            pairs.push(Pair { channels: [a, b], peaks });
        }
    }
    consistent(spectra.len(), &pairs)
}

#[cfg(test)]
mod tests {
    use super::{Arrival, Signal, TimeOptions, Window, arrival_times};
    use crate::quantile::{MEDIAN, quantile};
    use crate::{Obstacle, Placement, RoomOptions, simulate_room};

    /// Seconds of a channel before and after the direct sound at the first microphone that hears it.
    const BEFORE: f64 = 0.05;
    const AFTER: f64 = 0.1;

    /// How far the arrivals of all events are from the truth, but for what those of an event have in common, seconds.
    fn errors(options: &RoomOptions) -> Vec<(f64, Option<Arrival>)> {
        let made = simulate_room(options).unwrap();
        let rate = f64::from(made.sample_rate);
        let mut errors = Vec::new();
        for j in 0..made.truth.times.len() {
            let truth: Vec<f64> = made.truth.arrivals.iter().map(|all| all[j]).collect();
            let first = truth.iter().copied().fold(f64::INFINITY, f64::min);
            let (begin, end) = (((first - BEFORE) * rate) as usize, ((first + AFTER) * rate) as usize);
            let windows: Vec<Option<Window<'_>>> = (made.channels.iter())
                .map(|samples| {
                    let samples = &samples[begin..end];
                    Some(Window { samples, start: begin as f64 / rate, sample_rate: rate })
                })
                .collect();
            let found = arrival_times(&windows, &TimeOptions::default()).unwrap();
            let off = |(found, truth): (&Option<Arrival>, &f64)| found.as_ref().map(|found| found.seconds - truth);
            let mut all: Vec<f64> = found.iter().zip(&truth).filter_map(off).collect();
            all.sort_by(f64::total_cmp);
            let middle = all[all.len() / 2];
            errors.extend(found.iter().zip(&truth).map(|(found, truth)| {
                (found.as_ref().map_or(f64::INFINITY, |found| (found.seconds - truth - middle).abs()), found.clone())
            }));
        }
        errors
    }

    /// The bounds are those that a program must keep to bring a network of microphones to millimetres. Another room for each
    /// condition, of ten microphones and ten claps.
    #[test]
    fn claps_in_a_room_are_told_to_microseconds() {
        for (seed, (reverberation, signal_to_noise)) in (0..).zip([(0.2, 20.0), (0.4, 20.0), (0.7, 20.0), (0.4, 10.0)])
        {
            let mut options = RoomOptions::default();
            (options.microphones, options.sources) = (Placement::Random(10), Placement::Random(10));
            (options.reverberation, options.signal_to_noise) = (reverberation, Some(signal_to_noise));
            options.seed = seed;
            let mut all: Vec<f64> = errors(&options).into_iter().map(|(error, _)| error).collect();
            all.sort_by(f64::total_cmp);
            let near = all.iter().filter(|error| **error < 30e-6).count();
            let said = format!("{reverberation} s, {signal_to_noise} dB: {near} of 100, median {:e}", all[50]);
            assert!(near >= 98 && all[50] < 2e-6, "{said}");
        }
    }

    /// A pillar takes 10 or 14 dB of the direct sound, which is then about as much weaker than the first echo, less some 5 dB
    /// that the echo loses on its way. By 10 dB nine of ten are right; where one is not, also by 14 dB, the standard deviation
    /// tells in 95 %.
    #[test]
    fn the_direct_sound_behind_an_obstacle_comes_before_the_echo() {
        for (attenuation_db, least) in [(10.0, 36), (14.0, 0)] {
            let (mut right, mut told) = (0, 0);
            for seed in 30..34 {
                let obstacles = vec![Obstacle { microphone: 0, attenuation_db }];
                let mut options = RoomOptions { obstacles, seed, ..RoomOptions::default() };
                (options.microphones, options.sources) = (Placement::Random(10), Placement::Random(10));
                for (error, found) in errors(&options).into_iter().step_by(10) {
                    right += usize::from(error < 30e-6);
                    told += usize::from(found.is_none_or(|found| error < f64::max(30e-6, 5.0 * found.sigma)));
                }
            }
            assert!(right >= least && told >= 38, "{attenuation_db} dB: {right} and {told} of 40");
        }
    }

    /// Errors over their standard deviations have a median of 0.6745 where they are normal.
    #[test]
    fn standard_deviations_are_those_of_errors() {
        for reverberation in [0.2, 0.4, 0.7] {
            for (signal_to_noise, sample_rate) in [(20.0, 48_000), (20.0, 16_000), (10.0, 48_000), (10.0, 16_000)] {
                let mut all = Vec::new();
                for seed in 10..14 {
                    let mut options = RoomOptions { reverberation, sample_rate, seed, ..RoomOptions::default() };
                    (options.microphones, options.sources) = (Placement::Random(10), Placement::Random(10));
                    // Later echoes are not compared.
                    (options.signal_to_noise, options.echo_time) = (Some(signal_to_noise), Some(0.03));
                    all.extend(
                        errors(&options).iter().filter_map(|(error, found)| Some((found.as_ref()?.sigma, *error))),
                    );
                }
                // A wrong arrival with a small standard deviation is the worst that can be told.
                let wrong = all.iter().filter(|(sigma, error)| *error > f64::max(30e-6, 5.0 * sigma)).count();
                let share = wrong as f64 / all.len() as f64;
                assert!(share < 0.01, "{reverberation} s, {signal_to_noise} dB, {sample_rate} Hz: {share}");
                let scale = quantile(all.iter().map(|(sigma, error)| error / sigma).collect(), 0.5).unwrap() / MEDIAN;
                let said = format!("{reverberation} s, {signal_to_noise} dB, {sample_rate} Hz: {scale}");
                assert!((0.8..1.3).contains(&scale), "{said}");
                // Those that are said to be worse are worse.
                all.sort_by(|a, b| a.0.total_cmp(&b.0));
                let third = all.len() / 3;
                let error =
                    |part: &[(f64, f64)]| quantile(part.iter().map(|(_, error)| *error).collect(), 0.5).unwrap();
                let (low, high) = (error(&all[..third]), error(&all[all.len() - third..]));
                assert!(high > 1.5 * low, "{said}: {low:e}, {high:e}");
            }
        }
    }

    #[test]
    fn nothing_is_heard_in_silence_and_noise() {
        let options = TimeOptions::default();
        let signal = Signal::Chirp { from: 1000.0, to: 6000.0, seconds: 0.05 };
        let chirp = TimeOptions { signal, ..options.clone() };
        let (silence, short) = (vec![0.0; 9600], vec![0.5; 3]);
        let mut made = RoomOptions::default();
        (made.microphones, made.sources) = (Placement::Random(2), Placement::Random(1));
        (made.first, made.duration, made.signal_to_noise) = (3.0, Some(4.0), Some(20.0));
        let made = simulate_room(&made).unwrap();
        let noise: Vec<&[f32]> = made.channels.iter().map(|samples| &samples[..9600]).collect();
        for parts in [vec![&silence[..], &silence[..]], vec![&short[..], &[]], noise] {
            let window = |samples| Some(Window { samples, start: 0.0, sample_rate: 48_000.0 });
            let windows: Vec<Option<Window<'_>>> = parts.into_iter().map(window).chain([None]).collect();
            assert_eq!(arrival_times(&windows, &options), Ok(vec![None; 3]));
            assert_eq!(arrival_times(&windows, &chirp), Ok(vec![None; 3]));
        }
        assert_eq!(arrival_times(&[], &options), Ok(Vec::new()));
        let wrong = TimeOptions { length: 1e9, ..options.clone() };
        assert!(arrival_times(&[], &wrong).unwrap_err().to_string().contains("length"));
        let slow = [Some(Window { samples: &[], start: 0.0, sample_rate: f64::NAN })];
        assert!(arrival_times(&slow, &options).unwrap_err().to_string().contains("sample rate"));
    }
}
