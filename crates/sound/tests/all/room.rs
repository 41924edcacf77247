//! Recordings in rooms, against formulas.

use std::f64::consts::PI;

use proptest::prelude::*;
use sound::{Placement, Recorder, RoomError, RoomOptions, RoomRecording, Sound, simulate_room};

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Two microphones and one source in a room without echoes and noise.
fn silent_room() -> RoomOptions {
    let mut options = RoomOptions::default();
    options.reverberation = 0.0;
    options.signal_to_noise = None;
    options.microphones = Placement::Given(vec![[1.0, 1.0, 1.0], [2.0, 5.0, 2.5]]);
    options.sources = Placement::Given(vec![[6.1, 4.2, 1.3]]);
    options.times = Some(vec![0.5]);
    options
}

#[test]
fn sounds_come_by_every_clock_when_and_as_loud_as_they_should() {
    let mut options = silent_room();
    let (from, to, length) = (500.0, 9000.0, 0.2);
    options.sound = Sound::Chirp { from, to, length };
    let clocks = [(0.0, 0.0), (0.25, 300.0), (-0.125, -80.0)];
    for (start, rate) in clocks {
        options.recorders =
            vec![Recorder { channels: 1, start: 0.0, rate: 0.0 }, Recorder { channels: 1, start, rate }];
        let recording = simulate_room(&options).unwrap();
        assert_eq!(recording.recorders, [0..1, 1..2]);
        let truth = &recording.truth;
        for (k, (start, pace)) in [(0.0, 1.0), (start, 1.0 + rate * 1e-6)].into_iter().enumerate() {
            let away = distance(truth.microphones[k], truth.sources[0]);
            assert!((truth.arrivals[k][0] - pace * (0.5 + away / 343.0 - start)).abs() < 1e-12);
            // Between the fades.
            let (begin, end) = (truth.arrivals[k][0] + 0.06 * length, truth.arrivals[k][0] + 0.94 * length);
            for n in (begin * 48000.0) as usize..(end * 48000.0) as usize {
                // The time at which this sample is taken, after the sound begins to arrive.
                let time = start + n as f64 / 48000.0 / pace - 0.5 - away / 343.0;
                let phase = 2.0 * PI * (from * time + (to - from) * time * time / (2.0 * length));
                let error = f64::from(recording.channels[k][n]) * away / truth.gain - phase.sin();
                // A thousandth of a sample is 2 pi 9000 / 48000 / 1000 = 1.2e-3 of the amplitude.
                assert!(error.abs() < 1e-3, "sample {n} of {k} is wrong by {error}");
            }
        }
    }
}

#[test]
fn claps_begin_at_their_arrivals() {
    let recording = simulate_room(&silent_room()).unwrap();
    for (samples, arrivals) in recording.channels.iter().zip(&recording.truth.arrivals) {
        let begin = (arrivals[0] * 48000.0).floor() as usize;
        let energy = |range: std::ops::Range<usize>| -> f64 {
            samples[range].iter().map(|&sample| f64::from(sample).powi(2)).sum()
        };
        // Nothing but what transforms round.
        assert!(energy(0..begin - 64) < 1e-24 * energy(0..samples.len()));
        // 1.5 ms are 72 samples, after which 1 - exp(-2) = 86 % of the energy has come, give or take the noise.
        let all = energy(0..samples.len());
        assert!(energy(0..begin - 2) < 0.05 * all);
        assert!((energy(0..begin + 72) / all - 0.86).abs() < 0.1);
        // It ends after 8 ms.
        assert!(energy(begin + 384 + 64..samples.len()) < 1e-24 * all);
    }
}

#[test]
fn the_loudest_sample_is_the_peak() {
    let recording = simulate_room(&silent_room()).unwrap();
    let loudest = recording.channels.iter().flatten().fold(0.0_f32, |most, sample| most.max(sample.abs()));
    assert_eq!(loudest, 0.5);
}

#[test]
fn noise_is_as_loud_as_it_should_be() {
    let mut options = silent_room();
    options.duration = Some(2.0);
    let sounds = simulate_room(&options).unwrap();
    options.signal_to_noise = Some(20.0);
    let recording = simulate_room(&options).unwrap();
    // Power of the sounds while they last, 8 ms: mean over the microphones.
    let squares = |samples: &[f32]| samples.iter().map(|&sample| f64::from(sample).powi(2)).sum::<f64>();
    let power = sounds.channels.iter().map(|samples| squares(samples) / 384.0).sum::<f64>() / 2.0;
    let expected = (power / 100.0).sqrt();
    assert!((recording.truth.noise / expected - 1.0).abs() < 0.02, "{} {expected}", recording.truth.noise);
    for samples in &recording.channels {
        // Of 20,000 normal numbers, the deviation is known to 0.5 %.
        let measured = (squares(&samples[..20_000]) / 20_000.0).sqrt();
        assert!((measured / recording.truth.noise - 1.0).abs() < 0.02);
    }
}

fn echoing(seed: u64) -> RoomRecording {
    let mut options = RoomOptions::default();
    options.reverberation = 0.2;
    options.microphones = Placement::Random(3);
    options.sources = Placement::Random(2);
    options.seed = seed;
    simulate_room(&options).unwrap()
}

#[test]
fn a_seed_gives_the_same_recordings() {
    let recording = echoing(1);
    assert_eq!(echoing(1), recording);
    assert_ne!(echoing(2).truth.microphones, recording.truth.microphones);
}

#[test]
fn random_points_keep_their_distance() {
    let mut options = silent_room();
    options.microphones = Placement::Random(40);
    options.sources = Placement::Random(20);
    options.times = None;
    options.sample_rate = 8000;
    (options.wall_distance, options.separation) = (0.4, 0.5);
    let truth = simulate_room(&options).unwrap().truth;
    let all = [truth.microphones, truth.sources].concat();
    for (k, &point) in all.iter().enumerate() {
        assert!((0..3).all(|axis| point[axis] >= 0.4 && point[axis] <= options.extent[axis] - 0.4));
        assert!(all[..k].iter().all(|&other| distance(point, other) >= 0.5));
    }
    for (k, time) in truth.times.iter().enumerate() {
        let late = time - 1.0 - 1.5 * k as f64;
        assert!((0.0..=0.3).contains(&late));
    }
}

/// Changes the options of a small room, and gives what is said of them.
fn refusal(change: impl FnOnce(&mut RoomOptions)) -> RoomError {
    let mut options = silent_room();
    change(&mut options);
    simulate_room(&options).unwrap_err()
}

#[test]
fn what_cannot_be_simulated_is_said() {
    let range = |change: fn(&mut RoomOptions)| assert!(matches!(refusal(change), RoomError::Range { .. }));
    range(|o| o.extent[1] = f64::NAN);
    range(|o| o.reverberation = -1.0);
    range(|o| o.speed = 0.0);
    range(|o| o.sample_rate = 0);
    range(|o| o.signal_to_noise = Some(f64::INFINITY));
    range(|o| o.sound = Sound::Clap { length: 0.0, decay: 1.0 });
    range(|o| o.sound = Sound::Chirp { from: 100.0, to: 24001.0, length: 1.0 });
    range(|o| o.microphones = Placement::Random(usize::MAX));
    range(|o| o.sources = Placement::Given(Vec::new()));
    range(|o| o.times = Some(vec![f64::NAN]));
    range(|o| o.duration = Some(0.0));
    range(|o| o.duration = Some(f64::NAN));
    range(|o| o.recorders = vec![Recorder { channels: 2, start: 0.0, rate: 1e5 }]);
    range(|o| o.peak = 0.0);
    let too_much = |change: fn(&mut RoomOptions)| assert!(matches!(refusal(change), RoomError::TooMuch { .. }));
    too_much(|o| o.duration = Some(1e8));
    too_much(|o| (o.reverberation, o.echo_time) = (0.5, Some(30.0)));
    let count = |change: fn(&mut RoomOptions)| assert!(matches!(refusal(change), RoomError::Count { .. }));
    count(|o| o.times = Some(vec![1.0, 2.0]));
    count(|o| o.recorders = vec![Recorder { channels: usize::MAX, start: 0.0, rate: 0.0 }; 2]);
    let outside = refusal(|o| o.sources = Placement::Given(vec![[1.0, 1.0, 3.0]]));
    assert!(outside.to_string().contains("source 1"), "{outside}");
    let together = refusal(|o| o.sources = Placement::Given(vec![[2.0, 5.0, 2.505]]));
    assert_eq!(together, RoomError::Together { microphone: 2, source_number: 1 });
    let full = refusal(|o| {
        o.microphones = Placement::Random(50);
        o.separation = 3.0;
    });
    assert!(matches!(full, RoomError::Full { .. }));
}

/// Small numbers of every size, and some that are none.
fn number(most: f64) -> impl Strategy<Value = f64> {
    prop_oneof![40 => 0.0..most, 1 => -1e9..1e9, 1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY), Just(1e-300)]]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_options_are_simulated_or_refused(
        extent in [number(6.0), number(6.0), number(6.0)],
        echoes in (number(0.05), prop::option::of(number(0.05)), prop::option::of(0..4_u32)),
        sound in (any::<bool>(), number(0.05), number(5000.0), number(5000.0)),
        times in (number(0.2), number(0.2), number(0.2), prop::option::of(number(0.5))),
        clock in (number(0.3), number(500.0), 1..4_usize),
        noise in prop::option::of(number(100.0)),
        (sample_rate, speed, wall, separation) in (100..20_000_u32, number(1000.0), number(0.5), number(0.5)),
    ) {
        let mut options = RoomOptions::default();
        options.extent = extent;
        (options.reverberation, options.echo_time, options.max_order) = echoes;
        let (is_clap, length, from, to) = sound;
        options.sound = if is_clap { Sound::Clap { length, decay: from / 1e6 } } else { Sound::Chirp { from, to, length } };
        (options.first, options.interval, options.jitter, options.duration) = times;
        let (start, rate, channels) = clock;
        options.recorders = vec![Recorder { channels, start, rate }; 2];
        options.microphones = Placement::Random(2 * channels);
        options.sources = Placement::Random(2);
        options.signal_to_noise = noise;
        (options.sample_rate, options.speed, options.wall_distance, options.separation) = (sample_rate, speed, wall, separation);
        // Long recordings are right, and take long.
        if options.duration.is_some_and(|duration| duration > 10.0) || options.first < -10.0 {
            return Ok(());
        }
        if let Ok(recording) = simulate_room(&options) {
            prop_assert!(recording.channels.iter().flatten().all(|sample| sample.is_finite()));
            prop_assert!(recording.truth.arrivals.iter().all(|row| row.len() == 2 && row.iter().all(|time| time.is_finite())));
        }
    }
}
