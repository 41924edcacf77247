//! Surveys recordings: `cargo run -p sound --example survey FILE...`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for channel in sound::survey(std::env::args_os().skip(1))? {
        println!("{}", serde_json::to_string(&channel)?);
    }
    Ok(())
}
