//! Recorders that were started apart hear the same sounds, each by its own clock.

use std::path::PathBuf;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use sound::{
    Heard, ListenError, ListenOptions, Placement, Recorder, RoomOptions, RoomRecording, SampleFormat, UnalignedReason,
    listen, simulate_room, write_wav,
};

/// Claps at uneven times, seconds: pauses of 1 to 2.2 s.
fn uneven(count: usize, first: f64, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    let mut time = first;
    let mut next = |_| {
        time += 1.0 + 1.2 * rng.random::<f64>();
        time
    };
    (0..count).map(&mut next).collect()
}

fn room(recorders: &[(f64, f64)], times: Vec<f64>, seed: u64) -> RoomRecording {
    let mut options = RoomOptions::default();
    options.recorders = recorders.iter().map(|&(start, rate)| Recorder { channels: 2, start, rate }).collect();
    options.microphones = Placement::Random(2 * recorders.len());
    (options.sources, options.times) = (Placement::Random(times.len()), Some(times));
    (options.signal_to_noise, options.seed) = (Some(20.0), seed);
    simulate_room(&options).unwrap()
}

/// A file for each recorder.
fn written(folder: &tempfile::TempDir, name: &str, made: &RoomRecording) -> Vec<Vec<PathBuf>> {
    let write = |(number, channels): (usize, &std::ops::Range<usize>)| {
        let path = folder.path().join(format!("{name}{number}.wav"));
        write_wav(&path, made.sample_rate, &made.channels[channels.clone()], SampleFormat::Int16).unwrap();
        vec![path]
    };
    made.recorders.iter().enumerate().map(write).collect()
}

fn heard(recorders: &[Vec<PathBuf>]) -> Heard {
    listen(recorders, &ListenOptions::default()).unwrap()
}

/// Of 20 claps in these channels: how far arrivals are from the truth by the recorders' own clocks, but for what all of an
/// event have in common, in order, seconds.
fn errors(heard: &Heard, channels: &[usize], made: &RoomRecording) -> Vec<f64> {
    assert_eq!((heard.arrivals.len(), heard.events.dropped.len()), (20, 0), "{:?}", heard.events.dropped);
    let mut errors = Vec::new();
    for (j, arrivals) in heard.arrivals.iter().enumerate() {
        let late = channels.iter().zip(&made.truth.arrivals);
        let late: Vec<f64> = late.map(|(&k, truth)| arrivals[k].as_ref().unwrap().seconds - truth[j]).collect();
        let mut sorted = late.clone();
        sorted.sort_by(f64::total_cmp);
        errors.extend(late.iter().map(|late| (late - sorted[4]).abs()));
    }
    errors.sort_by(f64::total_cmp);
    errors
}

#[test]
fn claps_are_heard_to_microseconds_by_recorders_that_were_started_apart() {
    let folder = tempfile::tempdir().unwrap();
    let clocks = [(-3.0, 20.0), (-60.0, -20.0), (-17.25, 7.0), (-41.5, -11.0)];
    let made = room(&clocks, uneven(20, 0.0, 1), 3);
    let mut recorders = written(&folder, "here", &made);
    // Another one, between these, was in another room where others clapped.
    let stranger = room(&[(-20.0, 0.0)], uneven(20, 3.0, 2), 4);
    recorders.splice(2..2, written(&folder, "elsewhere", &stranger));
    let heard = heard(&recorders);
    let all = errors(&heard, &[0, 1, 2, 3, 6, 7, 8, 9], &made);
    println!("median {:.2} us, 98 % {:.2} us, most {:.2} us", 1e6 * all[80], 1e6 * all[156], 1e6 * all[159]);
    // Within 30 us in 98 %, and half of them within 5: by the clocks of the recorders as they are.
    assert_eq!(all.len(), 160);
    assert!(all[156] < 30e-6 && all[80] < 5e-6, "{} {}", all[156], all[80]);
    assert!(heard.arrivals.iter().all(|arrivals| arrivals[4].is_none() && arrivals[5].is_none()));
    assert_eq!((heard.events.channels[4].used, heard.recorders[4..7].to_vec()), (0, vec![2, 2, 3]));

    let alignment = &heard.alignment;
    assert_eq!(alignment.recorders.iter().map(|aligned| aligned.recorder).collect::<Vec<_>>(), [0, 1, 3, 4]);
    for (aligned, (start, rate)) in alignment.recorders.iter().zip(clocks) {
        // Sound takes at most 10.5 m / 343 m/s = 30 ms in the room.
        let drift = 4.0 * aligned.rate_sigma * 1e-6;
        assert!((aligned.start - (start - clocks[0].0)).abs() < 0.03 + 100.0 * drift, "{aligned:?}");
        assert!(1e-6 * (aligned.rate - (rate - 20.0)).abs() <= drift, "{aligned:?}");
    }
    let reason = alignment.unaligned[0].reason;
    assert_eq!((alignment.unaligned.len(), alignment.unaligned[0].recorder), (1, 2));
    assert!(matches!(reason, UnalignedReason::OtherSounds { .. } | UnalignedReason::Ambiguous { .. }), "{reason:?}");

    let list = heard.list();
    let lines: Vec<&str> = list.lines().collect();
    assert_eq!((lines.len(), lines[0]), (161, "receiver,event,time_s,weight,recorder"));
    let cells: Vec<&str> = lines[5].split(',').collect();
    assert_eq!([cells[0], cells[1], cells[4]], ["here2:1", "1", "here2"]);
    assert!((cells[2].parse::<f64>().unwrap() - made.truth.arrivals[4][0]).abs() < 1e-3, "{}", lines[5]);
    assert!(serde_json::to_string(alignment).unwrap().contains("\"unaligned\":[{\"recorder\":2,"));
}

#[test]
fn claps_at_regular_times_are_ambiguous() {
    let folder = tempfile::tempdir().unwrap();
    let times = (0..8).map(|k| 1.0 + 1.5 * f64::from(k)).collect();
    let made = room(&[(0.0, 0.0), (-4.0, 0.0)], times, 5);
    let heard = heard(&written(&folder, "here", &made));
    let unaligned = &heard.alignment.unaligned[0];
    assert!(matches!(unaligned.reason, UnalignedReason::Ambiguous { other: 0, .. }), "{unaligned}");
    // Two channels are too few for an event.
    assert_eq!((heard.arrivals.len(), heard.events.dropped.len()), (0, 8));
    assert_eq!(heard.list(), "receiver,event,time_s,weight,recorder\n");
}

#[test]
fn recorders_begin_late_and_end_early() {
    let folder = tempfile::tempdir().unwrap();
    let mut made = room(&[(0.0, 0.0), (8.0, 50.0)], uneven(24, 0.0, 6), 7);
    // The first recorder ends after the 18th clap.
    let end = made.truth.arrivals[0][17] + 0.4;
    made.channels[..2].iter_mut().for_each(|channel| channel.truncate((48_000.0 * end) as usize));
    let recorders = written(&folder, "here", &made);
    let mut options = ListenOptions::default();
    options.events.least_channels = 2;
    let heard = listen(&recorders, &options).unwrap();
    assert_eq!((heard.alignment.recorders.len(), heard.arrivals.len()), (2, 24), "{:?}", heard.alignment);
    for (j, arrivals) in heard.arrivals.iter().enumerate() {
        for ((arrival, truth), &recorder) in arrivals.iter().zip(&made.truth.arrivals).zip(&heard.recorders) {
            let is_running = if recorder == 0 { truth[j] < end } else { truth[j] > 0.0 };
            assert_eq!(arrival.is_some(), is_running, "clap {} by recorder {recorder}", j + 1);
            let error = arrival.as_ref().map_or(0.0, |arrival| arrival.seconds - truth[j]);
            assert!(error.abs() < 1e-3, "clap {} by recorder {recorder}: {error}", j + 1);
        }
    }
}

#[test]
fn recorders_need_files() {
    let none: [Vec<PathBuf>; 0] = [];
    assert!(matches!(listen(&none, &ListenOptions::default()), Err(ListenError::Events(_))));
    let empty = listen(&[vec!["a.wav"], vec![]], &ListenOptions::default()).unwrap_err();
    assert_eq!(empty.to_string(), "recorder 2 has no files; give at least one for each recorder");
    let many = listen(&vec![vec!["a.wav"]; 129], &ListenOptions::default()).unwrap_err();
    assert!(matches!(many, ListenError::TooManyRecorders { found: 129, most: 128 }));
    let mut options = ListenOptions::default();
    options.alignment.max_rate = f64::NAN;
    assert!(listen(&[vec!["a.wav"]], &options).unwrap_err().to_string().contains("rate"));
}

#[test]
fn files_that_follow_one_another_are_not_taken_side_by_side_in_silence() {
    let folder = tempfile::tempdir().unwrap();
    let mut options = RoomOptions::default();
    let times = uneven(24, 0.0, 9);
    (options.microphones, options.sources) = (Placement::Random(4), Placement::Random(times.len()));
    (options.times, options.signal_to_noise, options.seed) = (Some(times), Some(20.0), 9);
    let made = simulate_room(&options).unwrap();
    let warned = |name: &str, parts: [Vec<Vec<f32>>; 2]| {
        let paths = ["1", "2"].map(|number| folder.path().join(format!("{name}{number}.wav")));
        for (path, channels) in paths.iter().zip(parts) {
            write_wav(path, made.sample_rate, &channels, SampleFormat::Int16).unwrap();
        }
        let heard = heard(&[paths.to_vec()]);
        let mut warnings = heard.warnings();
        warnings.retain(|warning| warning.contains("join them"));
        warnings
    };
    // Both halves, as a recorder splits them; and two channels in each file.
    let half = made.channels[0].len() / 2;
    let part =
        |range: std::ops::Range<usize>| made.channels.iter().map(|channel| channel[range.clone()].to_vec()).collect();
    let split = warned("split", [part(0..half), part(half..2 * half)]);
    assert!(split.len() == 1 && split[0].contains("split1.wav and ") && split[0].contains("split2.wav"), "{split:?}");
    let beside = warned("beside", [made.channels[..2].to_vec(), made.channels[2..].to_vec()]);
    assert!(beside.is_empty(), "{beside:?}");
}
