//! Finds the sounds in files of one recorder: `cargo run --release -p sound --example events FILE...`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let events = sound::find_events(std::env::args_os().skip(1), &sound::EventOptions::default())?;
    for dropped in &events.dropped {
        eprintln!("{dropped}");
    }
    println!("{}", serde_json::to_string(&events)?);
    Ok(())
}
