//! Records twenty claps by ten microphones in a room with echoes, and says how long that takes:
//! `cargo run --release -p sound --example room [FILE.wav]`.

use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut options = sound::RoomOptions::default();
    options.microphones = sound::Placement::Random(10);
    options.sources = sound::Placement::Random(20);
    (options.interval, options.duration) = (1.6, Some(34.0));
    let begin = Instant::now();
    let recording = sound::simulate_room(&options)?;
    eprintln!("{} channels of 34 s in {:.2} s", recording.channels.len(), begin.elapsed().as_secs_f64());
    if let Some(path) = std::env::args_os().nth(1) {
        sound::write_wav(path, recording.sample_rate, &recording.channels, sound::SampleFormat::Int24)?;
    }
    println!("{}", serde_json::to_string(&recording.truth)?);
    Ok(())
}
