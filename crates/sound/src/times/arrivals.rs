//! Arrival times from the parts of all channels in which an event is.

use super::arrival::{Arrival, PEAKS, STRONG};
use super::consistent::{Channel, Pair, consistent};
use super::correlation::{Correlation, Delays};
use super::deviation::deviations;
use super::edge::edge;
use super::error::TimeError;
use super::known;
use super::options::{TimeOptions, Window};
use super::spectrum::Spectrum;
use crate::signal::{Compression, Signal};

/// How much more than is compared at last is compared first, and how often.
const WIDER: f64 = 1.5;
const PASSES: usize = 2;

/// How large peaks of a pair of channels are at least beside the largest.
const LEAST: f64 = 0.4;

/// The times at which an event begins in each channel, from the part of each in which it is; `None` for channels that have
/// no such part, or in whose part nothing rises above the noise. Parts in which a signal is looked for hold all of it.
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
    let mut edges: Vec<Option<f64>> = windows.iter().map(|window| edge(window.as_ref()?, options)).collect();
    // An echo may have been the first to rise above the noise, or above its share of the loudest one.
    let wide = TimeOptions { length: WIDER * options.length, before: WIDER * options.length / 2.0, ..options.clone() };
    let delays = Delays::new(&wide);
    for _ in 0..PASSES {
        let spectra = spectra(windows, &edges, &wide);
        let found = compared(&spectra, options.whitening, &delays, true);
        let Some(sound) = Spectrum::common(&delayed(&spectra, &found)) else { break };
        for (k, spectrum) in &spectra {
            let strong = Correlation::of(spectrum, &sound, options.whitening).peaks(STRONG, &delays);
            let first = strong.iter().map(|peak| peak.delay).min_by(f64::total_cmp);
            if let (Some(edge), Some(delay)) = (&mut edges[*k], first) {
                *edge += delay;
            }
        }
    }
    let spectra = spectra(windows, &edges, options);
    let delays = Delays::new(options);
    let found = compared(&spectra, options.whitening, &delays, false);
    let sigmas = deviations(&delayed(&spectra, &found), options.whitening, &delays);
    let mut all = vec![None; windows.len()];
    for (((k, _), channel), sigma) in spectra.iter().zip(found).zip(sigmas) {
        let Some(edge) = edges[*k] else { continue };
        let alternatives = channel.alternatives.iter().map(|off| edge + off).collect();
        // Both see the same noise and echoes; the pairs also see where a channel is not one with the others.
        let sigma = sigma.unwrap_or(options.length).max(channel.spread);
        all[*k] = Some(Arrival { seconds: edge + channel.off, sigma, alternatives });
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

/// The spectra of the channels that have an edge, with their places.
fn spectra(windows: &[Option<Window<'_>>], edges: &[Option<f64>], options: &TimeOptions) -> Vec<(usize, Spectrum)> {
    let of = |k: usize| Some((k, Spectrum::new(windows[k].as_ref()?, edges[k]?, options)));
    (0..windows.len()).filter_map(of).collect()
}

/// Spectra and their delays beside the leading edges.
fn delayed<'a>(spectra: &'a [(usize, Spectrum)], found: &[Channel]) -> Vec<(&'a Spectrum, f64)> {
    spectra.iter().zip(found).map(|((_, spectrum), channel)| (spectrum, channel.off)).collect()
}

/// What the pairs of channels say of each.
fn compared(spectra: &[(usize, Spectrum)], whitening: f64, delays: &Delays, are_edges_rough: bool) -> Vec<Channel> {
    let mut pairs = Vec::new();
    for (a, (_, first)) in spectra.iter().enumerate() {
        for (b, (_, second)) in spectra.iter().enumerate().skip(a + 1) {
            let mut peaks = Correlation::of(first, second, whitening).peaks(LEAST, delays);
            peaks.truncate(PEAKS);
            pairs.push(Pair { channels: [a, b], peaks });
        }
    }
    consistent(spectra.len(), &pairs, are_edges_rough)
}

#[cfg(test)]
mod tests {
    use super::{Arrival, Signal, TimeOptions, Window, arrival_times};
    use crate::{Placement, RoomOptions, simulate_room};

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
        // At 10 dB distant microphones lose some.
        let conditions = [(0.2, 20.0, 98), (0.4, 20.0, 98), (0.7, 20.0, 98), (0.4, 10.0, 90)];
        for (seed, (reverberation, signal_to_noise, least)) in (0..).zip(conditions) {
            let mut options = RoomOptions::default();
            (options.microphones, options.sources) = (Placement::Random(10), Placement::Random(10));
            (options.reverberation, options.signal_to_noise) = (reverberation, Some(signal_to_noise));
            options.seed = seed;
            let mut all: Vec<f64> = errors(&options).into_iter().map(|(error, _)| error).collect();
            all.sort_by(f64::total_cmp);
            let near = all.iter().filter(|error| **error < 30e-6).count();
            let said = format!("{reverberation} s, {signal_to_noise} dB: {near} of 100, median {:e}", all[50]);
            assert!(near >= least && all[50] < 2e-6, "{said}");
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
                let median = |mut all: Vec<f64>| {
                    all.sort_by(f64::total_cmp);
                    all[all.len() / 2]
                };
                let scale = median(all.iter().map(|(sigma, error)| error / sigma).collect()) / 0.6745;
                let said = format!("{reverberation} s, {signal_to_noise} dB, {sample_rate} Hz: {scale}");
                assert!((0.8..1.3).contains(&scale), "{said}");
                // Those that are said to be worse are worse.
                all.sort_by(|a, b| a.0.total_cmp(&b.0));
                let third = all.len() / 3;
                let error = |part: &[(f64, f64)]| median(part.iter().map(|(_, error)| *error).collect());
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
