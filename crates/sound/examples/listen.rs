//! Arrival times of the sounds in the recordings of one recorder, as a list that `tdoa calibrate` reads:
//!
//!     cargo run --release -p sound --example listen -- claps.wav > arrivals.csv
//!     cargo run --release -p tdoa-cli -- calibrate arrivals.csv --units s --speed 343

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let heard = sound::listen(&paths, &sound::ListenOptions::default())?;
    for channel in &heard.events.channels {
        let sound::EventChannel { file, channel, heard, used, .. } = channel;
        eprintln!("{file} channel {channel}: {heard} sounds heard, {used} used");
    }
    heard.events.dropped.iter().for_each(|dropped| eprintln!("{dropped}"));
    print!("{}", heard.list());
    Ok(())
}
