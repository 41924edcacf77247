//! Sounds are found in simulated recordings, whose truth is known.

mod any;
mod cases;

use std::path::PathBuf;

use sound::{
    EventOptions, Events, Placement, RoomOptions, RoomRecording, SampleFormat, find_events, simulate_room, write_wav,
};

/// How far an onset may be from the truth, seconds.
const CLOSE: f64 = 4e-3;

fn room(reverberation: f64, decibel: f64, seed: u64) -> RoomOptions {
    let mut options = RoomOptions::default();
    options.microphones = Placement::Random(10);
    options.sources = Placement::Random(20);
    (options.reverberation, options.signal_to_noise, options.seed) = (reverberation, Some(decibel), seed);
    options
}

fn written(folder: &tempfile::TempDir, name: &str, rate: u32, channels: &[Vec<f32>]) -> PathBuf {
    let path = folder.path().join(name);
    write_wav(&path, rate, channels, SampleFormat::Float32).unwrap();
    path
}

fn found(rate: u32, channels: &[Vec<f32>]) -> Events {
    found_with(rate, channels, &EventOptions::default())
}

/// The events; the counts of channels are checked.
fn found_with(rate: u32, channels: &[Vec<f32>], options: &EventOptions) -> Events {
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "claps.wav", rate, channels);
    let events = find_events([path], options).unwrap();
    for channel in &events.channels {
        assert_eq!(channel.heard, channel.used + channel.echoes + channel.dropped);
    }
    for (k, channel) in events.channels.iter().enumerate() {
        assert_eq!(channel.used, events.events.iter().filter(|event| event.onsets[k].is_some()).count());
    }
    events
}

/// What is right and wrong in events, beside the truth.
#[derive(Debug, Default)]
struct Score {
    events: usize,
    /// Sounds that are no event.
    missed: usize,
    /// Events that are no sound.
    wrong: usize,
    /// Sounds times channels, those with an onset, and those with one that is close.
    cells: usize,
    heard: usize,
    close: usize,
    dropped: usize,
    /// Errors of close onsets, seconds.
    errors: Vec<f64>,
}

impl Score {
    fn add(&mut self, events: &Events, recording: &RoomRecording) {
        let truth = &recording.truth;
        let mut is_found = vec![false; truth.times.len()];
        self.dropped += events.dropped.len();
        for event in &events.events {
            self.events += 1;
            let first = |k: usize| truth.arrivals.iter().map(|row| row[k]).fold(f64::INFINITY, f64::min);
            // The first microphone may not hear it; the others are at most 11 m, 32 ms away.
            let is_it = |&k: &usize| !is_found[k] && (-CLOSE..0.036).contains(&(event.seconds - first(k)));
            let Some(k) = (0..truth.times.len()).find(is_it) else {
                self.wrong += 1;
                continue;
            };
            is_found[k] = true;
            for (onset, row) in event.onsets.iter().zip(&truth.arrivals) {
                let Some(onset) = onset else { continue };
                self.heard += 1;
                let error = onset.seconds - row[k];
                if error.abs() <= CLOSE {
                    self.close += 1;
                    self.errors.push(error);
                }
            }
        }
        self.missed += is_found.iter().filter(|is_found| !**is_found).count();
        self.cells += truth.times.len() * truth.arrivals.len();
    }

    fn say(&mut self, name: &str) {
        self.errors.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let last = self.errors.len().saturating_sub(1) as f64;
            1e3 * self.errors.get((share * last) as usize).copied().unwrap_or(f64::NAN)
        };
        println!(
            "{name}: {} events, {} missed, {} wrong, {} dropped; of {} cells {} heard, {} close; errors {:.2} / {:.2} / {:.2} ms",
            self.events,
            self.missed,
            self.wrong,
            self.dropped,
            self.cells,
            self.heard,
            self.close,
            quantile(0.01),
            quantile(0.5),
            quantile(0.99)
        );
    }
}

fn score(reverberation: f64, decibel: f64, seed: u64, options: &EventOptions) -> Score {
    let mut score = Score::default();
    let recording = simulate_room(&room(reverberation, decibel, seed)).unwrap();
    score.add(&found_with(recording.sample_rate, &recording.channels, options), &recording);
    score.say(&format!("{reverberation} s, {decibel} dB, threshold {}", options.threshold));
    score
}

#[test]
fn claps_half_a_second_apart_are_all_found() {
    for (reverberation, seed) in [(0.2, 40), (0.4, 41), (0.7, 42)] {
        let mut options = room(reverberation, 20.0, seed);
        (options.interval, options.jitter) = (0.5, 0.0);
        let recording = simulate_room(&options).unwrap();
        let mut score = Score::default();
        score.add(&found(recording.sample_rate, &recording.channels), &recording);
        assert_eq!((score.events, score.missed, score.wrong, score.dropped), (20, 0, 0, 0), "{reverberation} s");
    }
}

#[test]
fn claps_are_found_in_echoes() {
    // Another room for each.
    for (seed, reverberation) in [(0, 0.2), (1, 0.4), (2, 0.7)] {
        let score = score(reverberation, 20.0, seed, &EventOptions::default());
        assert_eq!((score.events, score.missed, score.wrong), (20, 0, 0), "{reverberation} s");
        assert!(score.close as f64 >= 0.98 * score.cells as f64, "{reverberation} s: {} close", score.close);
    }
}

#[test]
fn loud_echoes_are_no_events() {
    // Echoes are above the noise for much longer than the dead time.
    let score = score(0.7, 60.0, 2, &EventOptions::default());
    assert_eq!((score.events, score.missed, score.wrong), (20, 0, 0));
    assert!(score.close as f64 >= 0.98 * score.cells as f64, "{} close", score.close);
}

#[test]
fn claps_in_loud_noise_are_found_or_missed() {
    let mut options = EventOptions::default();
    for (seed, reverberation) in [(0, 0.2), (1, 0.4), (2, 0.7)] {
        let score = score(reverberation, 10.0, seed, &options);
        assert!(score.missed <= 1 && score.wrong == 0, "{reverberation} s: {score:?}");
        assert!(score.close as f64 >= 0.98 * score.heard as f64 && score.heard > score.cells / 2, "{score:?}");
    }
    // Four of ten channels seldom have a clap 16 dB above the noise.
    options.threshold = 6.0;
    let high = score(0.4, 10.0, 0, &options);
    assert_eq!((high.wrong, high.heard), (0, high.close));
}
