//! A minute of twelve channels with twenty claps or chirps at 48 kHz, written to a file, and listened to. Allocations are
//! those at once, in bytes.

use divan::{AllocProfiler, Bencher, black_box};
use sound::{
    EventOptions, ListenOptions, Placement, RoomOptions, SampleFormat, Signal, Sound, find_events, listen,
    simulate_room, write_wav,
};

#[global_allocator]
static ALLOCATIONS: AllocProfiler = AllocProfiler::system();

fn main() {
    divan::main();
}

const CLAP: Sound = Sound::Clap { length: 0.008, decay: 0.0015 };

/// The file, in a folder that goes with the first of these.
fn recorded(sound: Sound, decibel: f64) -> (tempfile::TempDir, std::path::PathBuf) {
    let mut options = RoomOptions::default();
    (options.microphones, options.sources) = (Placement::Random(12), Placement::Random(20));
    (options.interval, options.duration) = (2.8, Some(60.0));
    (options.sound, options.signal_to_noise) = (sound, Some(decibel));
    let made = simulate_room(&options).expect("a room");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("claps.wav");
    write_wav(&path, made.sample_rate, &made.channels, SampleFormat::Int24).expect("a file");
    (folder, path)
}

/// Events alone.
#[divan::bench(sample_count = 10)]
fn events(bencher: Bencher<'_, '_>) {
    let (_folder, path) = recorded(CLAP, 20.0);
    bencher.bench_local(|| find_events([black_box(&path)], &EventOptions::default()));
}

/// Events and their arrival times.
#[divan::bench(sample_count = 10)]
fn arrivals(bencher: Bencher<'_, '_>) {
    let (_folder, path) = recorded(CLAP, 20.0);
    bencher.bench_local(|| listen(&[vec![black_box(&path)]], &ListenOptions::default()));
}

/// Chirps of half a second that are known, as loud as the noise.
#[divan::bench(sample_count = 10)]
fn chirps(bencher: Bencher<'_, '_>) {
    let (from, to) = (1000.0, 6000.0);
    let (_folder, path) = recorded(Sound::Chirp { from, to, length: 0.5 }, 0.0);
    let options = ListenOptions::of(Signal::Chirp { from, to, seconds: 0.5 });
    bencher.bench_local(|| listen(&[vec![black_box(&path)]], &options));
}
