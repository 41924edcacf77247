//! A minute of twelve channels with twenty claps at 48 kHz, written to a file, and listened to. Allocations are those at
//! once, in bytes.

use divan::{AllocProfiler, Bencher, black_box};
use sound::{
    EventOptions, ListenOptions, Placement, RoomOptions, SampleFormat, find_events, listen, simulate_room, write_wav,
};

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

fn main() {
    divan::main();
}

/// The file, in a folder that goes with the first of these.
fn recorded() -> (tempfile::TempDir, std::path::PathBuf) {
    let mut options = RoomOptions::default();
    (options.microphones, options.sources) = (Placement::Random(12), Placement::Random(20));
    (options.interval, options.duration, options.signal_to_noise) = (2.8, Some(60.0), Some(20.0));
    let made = simulate_room(&options).expect("a room");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("claps.wav");
    write_wav(&path, made.sample_rate, &made.channels, SampleFormat::Int24).expect("a file");
    (folder, path)
}

/// Events alone.
#[divan::bench(sample_count = 10)]
fn events(bencher: Bencher<'_, '_>) {
    let (_folder, path) = recorded();
    bencher.bench_local(|| find_events([black_box(&path)], &EventOptions::default()));
}

/// Events and their arrival times.
#[divan::bench(sample_count = 10)]
fn arrivals(bencher: Bencher<'_, '_>) {
    let (_folder, path) = recorded();
    bencher.bench_local(|| listen(&[black_box(&path)], &ListenOptions::default()));
}
