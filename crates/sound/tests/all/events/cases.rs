//! Recordings in which something is different.

use std::path::Path;

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use sound::{
    DropReason, EventError, EventOptions, Events, RoomOptions, RoomRecording, Sound, event_windows, find_events,
    simulate_room,
};

use super::{CLOSE, Score, found, found_with, room, written};

fn small_room(sources: usize, seed: u64) -> RoomOptions {
    let mut options = room(0.2, 30.0, seed);
    options.sources = sound::Placement::Random(sources);
    options
}

fn simulated(options: &RoomOptions) -> RoomRecording {
    simulate_room(options).unwrap()
}

fn heard(recording: &RoomRecording) -> Events {
    found(recording.sample_rate, &recording.channels)
}

fn scored(events: &Events, recording: &RoomRecording) -> Score {
    let mut score = Score::default();
    score.add(events, recording);
    score
}

/// All sounds are found, and by these channels close to the truth.
fn assert_all(events: &Events, recording: &RoomRecording, channels: usize) {
    let score = scored(events, recording);
    let sounds = recording.truth.times.len();
    assert_eq!((score.events, score.missed, score.wrong), (sounds, 0, 0), "{score:?}");
    assert_eq!(score.heard, score.close, "{score:?}");
    assert!(score.close as f64 >= 0.98 * (sounds * channels) as f64, "{score:?}");
}

fn noise(seed: u64, deviation: f64, count: usize) -> Vec<f32> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (0..count).map(|_| (deviation * rng.sample::<f64, _>(StandardNormal)) as f32).collect()
}

#[test]
fn claps_half_a_second_apart_are_two() {
    for seed in 0..4 {
        let mut options = small_room(2, seed);
        (options.reverberation, options.times) = (0.4, Some(vec![1.0, 1.5]));
        let recording = simulated(&options);
        assert_all(&heard(&recording), &recording, 10);
    }
}

#[test]
fn one_clap_is_one_event() {
    for seed in 0..4 {
        let recording = simulated(&small_room(1, seed));
        let events = heard(&recording);
        assert_all(&events, &recording, 10);
        assert!(events.dropped.is_empty());
    }
}

#[test]
fn chirps_are_events() {
    // Long ones, which change their strength by echoes as they go on.
    for (length, seed) in [(0.05, 0), (0.2, 1), (0.2, 2), (0.5, 3), (1.0, 4)] {
        let mut options = small_room(4, seed);
        (options.interval, options.reverberation) = (2.5, 0.4);
        options.sound = Sound::Chirp { from: 1000.0, to: 6000.0, length };
        let recording = simulated(&options);
        let score = scored(&heard(&recording), &recording);
        assert_eq!((score.events, score.missed, score.wrong), (4, 0, 0), "{length} s: {score:?}");
    }
}

#[test]
fn silence_and_noise_have_no_events() {
    for (rate, seed) in [(8000, 0), (44_100, 1), (48_000, 2), (96_000, 3)] {
        let channels: Vec<Vec<f32>> = (0..6).map(|k| noise(10 * seed + k, 0.05, rate as usize * 12)).collect();
        let events = found(rate, &channels);
        assert!(events.events.is_empty() && events.dropped.is_empty(), "{events:?}");
        assert!(events.channels.iter().all(|channel| channel.heard == 0));
        // Nothing, and nothing but an offset.
        let events = found(rate, &[0.0, 0.0, 0.5, -0.25].map(|offset| vec![offset; rate as usize]));
        assert!(events.channels.iter().all(|channel| channel.heard == 0) && events.dropped.is_empty());
    }
    let events = found(48_000, &[const { Vec::new() }; 4]);
    assert!(events.events.is_empty());
}

#[test]
fn dead_channels_hear_nothing_and_clipped_ones_do() {
    for seed in 0..2 {
        let mut recording = simulated(&small_room(8, seed));
        recording.channels[3].fill(0.0);
        let most = recording.channels[5].iter().fold(0.0_f32, |most, sample| most.max(sample.abs()));
        recording.channels[5].iter_mut().for_each(|sample| *sample = sample.clamp(-most / 20.0, most / 20.0));
        let events = heard(&recording);
        assert_all(&events, &recording, 9);
        assert_eq!((events.channels[3].heard, events.channels[3].used), (0, 0));
        assert_eq!(events.channels[5].used, 8);
    }
}

#[test]
fn noise_that_grows_is_followed() {
    for seed in 0..2 {
        let mut options = room(0.2, 40.0, seed);
        options.interval = 2.0;
        let mut recording = simulated(&options);
        let (count, deviation) = (recording.channels[0].len(), recording.truth.noise);
        for (channel, seed) in recording.channels.iter_mut().zip(100..) {
            for (k, (sample, noise)) in channel.iter_mut().zip(noise(seed, deviation, count)).enumerate() {
                *sample += noise * 10.0_f32.powf(k as f32 / count as f32);
            }
        }
        let events = heard(&recording);
        assert_all(&events, &recording, 10);
        assert!(events.dropped.is_empty());
        // What is 20 dB over the noise at the end is 37 dB over it at the beginning, where there are two noises.
        let strength = |event: usize| {
            let onsets = events.events[event].onsets.iter().flatten();
            onsets.map(|onset| onset.strength_db).sum::<f64>() / 10.0
        };
        assert!((0..5).map(strength).sum::<f64>() > (15..20).map(strength).sum::<f64>() + 5.0 * 8.0);
    }
}

#[test]
fn clicks_in_single_channels_are_dropped_one_by_one() {
    for seed in 0..2 {
        let mut recording = simulated(&small_room(8, seed));
        let rate = f64::from(recording.sample_rate);
        // Claps are 1.2 s apart or more, the last one is more than a second before the end.
        let clicks: Vec<f64> = recording.truth.times.iter().map(|time| time + 0.7).collect();
        for (k, &click) in clicks.iter().enumerate() {
            let begin = (click * rate) as usize;
            let sound = noise(seed * 10 + k as u64, 0.3, 50);
            recording.channels[k % 3][begin..begin + 50].copy_from_slice(&sound);
        }
        let events = heard(&recording);
        assert_all(&events, &recording, 10);
        assert_eq!(events.dropped.len(), clicks.len());
        for (dropped, click) in events.dropped.iter().zip(clicks) {
            assert_eq!(dropped.reason, DropReason::TooFewChannels { heard: 1, least: 4 });
            assert!((dropped.seconds - click).abs() < CLOSE);
        }
        assert_eq!(events.channels.iter().map(|channel| channel.dropped).sum::<usize>(), 8);
    }
}

#[test]
fn a_clap_that_three_channels_hear_is_dropped_and_said() {
    for seed in 0..2 {
        let mut recording = simulated(&small_room(3, seed));
        // The second clap and its echoes, in seven channels.
        let rate = f64::from(recording.sample_rate);
        for k in 3..10 {
            let begin = ((recording.truth.arrivals[k][1] - 0.01) * rate) as usize;
            let replaced = noise(seed * 10 + k as u64, recording.truth.noise, (0.5 * rate) as usize);
            recording.channels[k][begin..begin + replaced.len()].copy_from_slice(&replaced);
        }
        let events = heard(&recording);
        let score = scored(&events, &recording);
        assert_eq!((score.events, score.missed, score.wrong, score.dropped), (2, 1, 0, 1), "{score:?}");
        let dropped = &events.dropped[0];
        assert_eq!(dropped.reason, DropReason::TooFewChannels { heard: 3, least: 4 });
        let first = (0..3).map(|k| recording.truth.arrivals[k][1]).fold(f64::INFINITY, f64::min);
        assert!((dropped.seconds - first).abs() < CLOSE);
        let said = dropped.to_string();
        assert!(said.contains("3 channels heard it, and at least 4 must; make louder sounds"), "{said}");
        let mut options = EventOptions::default();
        options.least_channels = 3;
        assert_eq!(found_with(recording.sample_rate, &recording.channels, &options).events.len(), 3);
    }
}

#[test]
fn files_of_one_recorder_are_read_together_and_again() {
    let recording = simulated(&small_room(5, 0));
    let folder = tempfile::tempdir().unwrap();
    // Every second sample is 24 kHz: what is above 12 kHz is folded down, but begins when it does.
    let half = |samples: &Vec<f32>| samples.iter().step_by(2).copied().collect::<Vec<f32>>();
    let slow: Vec<Vec<f32>> = recording.channels[4..].iter().map(half).collect();
    let paths = [written(&folder, "a.wav", 48_000, &recording.channels[..4]), written(&folder, "b.wav", 24_000, &slow)];
    let events = find_events(&paths, &EventOptions::default()).unwrap();
    assert_all(&events, &recording, 10);
    let file = |path: &Path| path.display().to_string();
    assert_eq!((&events.channels[4].file, events.channels[4].channel), (&file(&paths[1]), 1));
    let mut count = 0;
    for samples in event_windows(&paths, &events).unwrap() {
        let samples = samples.unwrap();
        assert_eq!((samples.event, samples.channels.len()), (count, 10));
        let window = &events.events[count].window;
        count += 1;
        for (k, channel) in samples.channels.iter().enumerate() {
            let (rate, whole) = if k < 4 { (48_000, &recording.channels[k]) } else { (24_000, &slow[k - 4]) };
            assert_eq!(channel.sample_rate, rate);
            let begin = (channel.seconds * f64::from(rate)).round() as usize;
            let late = channel.seconds - window.start;
            assert!((-1e-9..1.0 / f64::from(rate)).contains(&late));
            // All that are in the window, give or take the one at its end.
            let expected = (window.end - window.start) * f64::from(rate);
            assert!((channel.samples.len() as f64 - expected).abs() <= 1.0);
            assert_eq!(channel.samples, whole[begin..begin + channel.samples.len()]);
        }
    }
    assert_eq!(count, 5);
    // Other files, or in another order.
    for other in [&[&paths[1], &paths[0]][..], &[&paths[0]], &[&paths[0], &paths[1], &paths[1]]] {
        assert!(matches!(event_windows(other, &events), Err(EventError::OtherFiles { .. })));
    }
    let mut events = events;
    events.events.swap(0, 1);
    let all: Vec<_> = event_windows(&paths, &events).unwrap().collect();
    assert!(matches!(all[..], [Ok(_), Err(EventError::Order { event: 2, .. })]));
}

#[test]
fn it_is_written_as_json() {
    let json = serde_json::to_value(heard(&simulated(&small_room(1, 0)))).unwrap();
    assert!(json["events"][0]["onsets"][9]["strength_db"].as_f64().unwrap() > 16.0);
    assert!(json["events"][0]["window"]["start"].is_f64() && json["dropped"] == serde_json::json!([]));
    let reason = serde_json::to_value(DropReason::TooFewChannels { heard: 1, least: 4 }).unwrap();
    assert_eq!(reason, serde_json::json!({"TooFewChannels": {"heard": 1, "least": 4}}));
}

#[test]
fn long_recordings_need_little_memory() {
    let channels: Vec<Vec<f32>> = (0..12).map(|k| noise(k, 0.05, 60 * 8000)).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = written(&folder, "long.wav", 8000, &channels);
    let counted = allocation_counter::measure(|| {
        find_events([&path], &EventOptions::default()).unwrap();
    });
    // Samples are 23 MB. A block is 0.8 MB, a minute of chunks 29 kB.
    assert!(counted.bytes_max < 4_000_000, "{} bytes", counted.bytes_max);
}
