//! Arrival times of the sounds in recordings, as a list that `tdoa calibrate` reads. All files are of one recorder, or, after
//! `--apart`, each is of a recorder of its own, which was started by itself:
//!
//!     cargo run --release -p sound --example listen -- claps.wav > arrivals.csv
//!     cargo run --release -p tdoa-cli -- calibrate arrivals.csv --units s --speed 343
//!     cargo run --release -p sound --example listen -- --apart kitchen.wav hall.wav > arrivals.csv
//!     cargo run --release -p tdoa-cli -- calibrate arrivals.csv --units s --speed 343 --receiver-clocks rate

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut paths: Vec<String> = std::env::args().skip(1).collect();
    let are_apart = paths.first().is_some_and(|first| first == "--apart");
    let recorders = if are_apart { paths.drain(1..).map(|path| vec![path]).collect() } else { vec![paths] };
    let heard = sound::listen(&recorders, &sound::ListenOptions::default())?;
    for channel in &heard.events.channels {
        let sound::EventChannel { file, channel, heard, used, .. } = channel;
        eprintln!("{file} channel {channel}: {heard} sounds heard, {used} used");
    }
    if are_apart {
        for sound::RecorderAlignment { recorder, start, rate, rate_sigma, matched, .. } in &heard.alignment.recorders {
            let number = recorder + 1;
            eprintln!(
                "recorder {number}: started at {start:.3} s, {rate:.0} +- {rate_sigma:.0} ppm fast, {matched} sounds"
            );
        }
    }
    heard.alignment.unaligned.iter().for_each(|unaligned| eprintln!("{unaligned}"));
    heard.events.dropped.iter().for_each(|dropped| eprintln!("{dropped}"));
    print!("{}", heard.list());
    Ok(())
}
