//! Listening is watched, and stopped.

use std::path::PathBuf;

use sound::{ListenError, ListenMonitor, ListenOptions, Placement, RoomOptions, SampleFormat, listen, listen_watched};
use sound::{simulate_room, write_wav};

use crate::flac::WAVES_16;

/// Two recorders with two channels each, and how many samples these have in all.
fn recorded(folder: &tempfile::TempDir) -> (Vec<Vec<PathBuf>>, u64) {
    let mut options = RoomOptions::default();
    (options.microphones, options.sources) = (Placement::Random(4), Placement::Random(5));
    let made = simulate_room(&options).unwrap();
    let file = |(number, channels): (usize, &[Vec<f32>])| {
        let path = folder.path().join(format!("{number}.wav"));
        write_wav(&path, made.sample_rate, channels, SampleFormat::Int16).unwrap();
        vec![path]
    };
    let samples = made.channels.iter().map(|channel| channel.len() as u64).sum();
    (made.channels.chunks(2).enumerate().map(file).collect(), samples)
}

#[test]
fn progress_reaches_its_total_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (recorders, samples) = recorded(&folder);
    let monitor = ListenMonitor::default();
    assert_eq!(monitor.progress().total, 0);
    // Twice by the same monitor, which begins anew.
    for _ in 0..2 {
        let heard = listen_watched(&recorders, &ListenOptions::default(), &monitor).unwrap();
        let progress = monitor.progress();
        assert_eq!((progress.done, progress.total), (2 * samples, 2 * samples));
        assert_eq!(heard, listen(&recorders, &ListenOptions::default()).unwrap());
        assert_eq!(heard.arrivals.len(), 5);
    }
}

#[test]
fn a_file_that_is_cut_off_does_not_keep_progress_from_its_total() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("waves.flac");
    std::fs::write(&path, &WAVES_16[..WAVES_16.len() - 10]).unwrap();
    let monitor = ListenMonitor::default();
    let mut options = ListenOptions::default();
    options.events.least_channels = 2;
    listen_watched(&[vec![path]], &options, &monitor).unwrap();
    let progress = monitor.progress();
    // The header says 2000 samples of two channels, and three blocks of 576 are there, which are read twice.
    assert_eq!((progress.done, progress.total), (6912, 6912));
}

#[test]
fn who_stops_it_gets_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let (recorders, _) = recorded(&folder);
    let monitor = ListenMonitor::default();
    monitor.stop();
    let heard = listen_watched(&recorders, &ListenOptions::default(), &monitor);
    assert!(matches!(heard, Err(ListenError::Stopped)));
    assert_eq!(monitor.progress().done, 0);
}
