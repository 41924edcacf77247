//! Whatever samples and options are, events are found or options refused.

use proptest::collection::vec;
use proptest::prelude::*;
use sound::{EventError, EventOptions, ListenOptions, Signal, event_windows, find_events, listen};

use super::written;

/// What is said of options that are changed in this way.
fn refusal(change: impl FnOnce(&mut EventOptions)) -> EventError {
    let mut options = EventOptions::default();
    change(&mut options);
    let said = options.validate().unwrap_err();
    // Before files are looked at.
    assert_eq!(find_events(["/there/is/no/such.wav"], &options).unwrap_err().to_string(), said.to_string());
    said
}

#[test]
fn options_that_cannot_be_are_refused() {
    let range = |change: fn(&mut EventOptions)| assert!(matches!(refusal(change), EventError::Range { .. }));
    range(|o| o.band = [0.0, 1000.0]);
    range(|o| o.band = [500.0, f64::NAN]);
    range(|o| o.band = [1000.0, 500.0]);
    range(|o| o.floor_seconds = 0.1);
    range(|o| o.threshold = 1.0);
    range(|o| o.weakest_first_db = -1.0);
    range(|o| o.extent = f64::INFINITY);
    range(|o| o.speed = 0.0);
    range(|o| o.dead_time = Some(f64::NAN));
    range(|o| o.least_channels = 0);
    assert!(matches!(refusal(|o| (o.extent, o.speed) = (1e4, 343.0)), EventError::Spread { .. }));
    let said = refusal(|o| o.dead_time = Some(0.05)).to_string();
    assert!(said.contains("the dead time is 0.05 s") && said.contains("lengthen it"), "{said}");
    let said = refusal(|o| o.threshold = 0.5).to_string();
    assert_eq!(said, "the threshold must be 1.5 to 1e6, not 0.5");
}

#[test]
fn files_that_do_not_fit_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let three = written(&folder, "three.wav", 48_000, &vec![vec![0.0; 10]; 3]);
    let slow = written(&folder, "slow.wav", 1200, &[vec![0.0; 10]]);
    let options = EventOptions::default();
    let none: [&str; 0] = [];
    assert!(matches!(find_events(none, &options), Err(EventError::NoRecordings)));
    assert!(matches!(find_events([&three], &options), Err(EventError::Channels { found: 3, least: 4 })));
    assert!(matches!(find_events(["/there/is/no/such.wav"], &options), Err(EventError::Read(_))));
    // 0.45 x 1200 Hz are 540 Hz.
    let said = find_events([&three, &slow], &options).unwrap_err().to_string();
    assert!(
        said.contains("slow.wav: at 1200 Hz there are no frequencies above 540 Hz") && said.contains("440 Hz"),
        "{said}"
    );
}

/// Samples of every kind.
fn sample() -> impl Strategy<Value = f32> {
    prop_oneof![8 => -1e-3_f32..1e-3, 2 => -1.0_f32..1.0, 1 => any::<f32>(), 1 => Just(0.0)]
}

/// Parts of a channel: so many samples, all times the same factor.
fn channel() -> impl Strategy<Value = Vec<f32>> {
    let part = (vec(sample(), 1..40), 1..60_usize, prop_oneof![Just(1.0_f32), Just(0.0), Just(1e-4)]);
    let part = part.prop_map(|(samples, times, factor)| {
        let count = samples.len() * times;
        samples.into_iter().cycle().take(count).map(|sample| sample * factor).collect::<Vec<f32>>()
    });
    vec(part, 0..8).prop_map(|parts| parts.concat())
}

/// Signals, most of which can be looked for.
fn signal() -> impl Strategy<Value = Signal> {
    let chirp = (number(600.0..3000.0), number(600.0..3000.0), number(0.001..0.3));
    let template = (vec(sample(), 0..300), number(8000.0..50_000.0));
    prop_oneof![
        6 => Just(Signal::Unknown),
        2 => chirp.prop_map(|(from, to, seconds)| Signal::Chirp { from, to, seconds }),
        2 => template.prop_map(|(samples, sample_rate)| Signal::Template { samples, sample_rate }),
    ]
}

fn number(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    prop_oneof![30 => range, 1 => any::<f64>(), 1 => prop_oneof![Just(0.0), Just(f64::NAN), Just(f64::INFINITY)]]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_samples_give_events_or_an_error(
        mut channels in vec(channel(), 1..5),
        rate in prop_oneof![1 => Just(1_u32), 1 => Just(700), 8 => Just(8000), 4 => Just(44_100), 1 => Just(1_000_000)],
        band in [number(1.0..500.0), number(600.0..5000.0)],
        (floor, threshold, weakest) in (number(0.5..5.0), number(1.5..8.0), number(0.0..20.0)),
        (extent, speed, dead) in (number(0.1..30.0), number(200.0..500.0), prop::option::of(number(0.15..0.3))),
        signal in signal(),
        least in prop_oneof![1 => Just(0_usize), 12 => 1..4_usize],
    ) {
        let mut options = EventOptions::default();
        options.signal = signal.clone();
        (options.band, options.floor_seconds, options.threshold, options.weakest_first_db) = (band, floor, threshold, weakest);
        (options.extent, options.speed, options.dead_time, options.least_channels) = (extent, speed, dead, least);
        let frames = channels.iter().map(Vec::len).max().unwrap_or(0);
        channels.iter_mut().for_each(|channel| channel.resize(frames, 0.0));
        let folder = tempfile::tempdir().unwrap();
        let path = written(&folder, "any.wav", rate, &channels);
        let Ok(found) = find_events([&path], &options) else { return Ok(()) };
        for channel in &found.channels {
            prop_assert_eq!(channel.heard, channel.used + channel.echoes + channel.dropped);
        }
        for onset in found.events.iter().flat_map(|event| event.onsets.iter().flatten()) {
            prop_assert!(onset.strength_db.is_finite() && onset.seconds.is_finite());
        }
        for (event, samples) in event_windows([&path], &found).unwrap().enumerate() {
            prop_assert_eq!(samples.unwrap().event, event);
        }
        let mut all = ListenOptions::of(signal);
        all.events = options;
        // Bands may be too wide for times.
        if let Ok(heard) = listen(&[vec![&path]], &all) {
            let arrivals = heard.arrivals.iter().flatten().flatten();
            let is_number = |x: &f64| x.is_finite();
            prop_assert!(arrivals.into_iter().all(|arrival| is_number(&arrival.seconds) && arrival.sigma >= 0.0));
        }
        for event in &found.events {
            prop_assert!(event.onsets.iter().flatten().count() >= least);
            prop_assert!(event.onsets.iter().flatten().all(|onset| event.window.contains(&onset.seconds)));
        }
    }
}
