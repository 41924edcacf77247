//! Writes a parameter family as Rust source:
//! `cargo run -p poly --features emit --example emit_program -- FAMILY.toml > family.rs`.
//!
//! Without an argument it writes the program of a small family of its own.

use poly::parse;
use poly::program::{EmitOptions, emit};

const FAMILY: &str = r#"
    name = "circle and hyperbola"
    unknowns = ["x", "y"]
    parameters = ["r", "a"]
    equations = ["x^2 + y^2 - r^2", "x*y - a"]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = match std::env::args().nth(1) {
        Some(path) => std::fs::read_to_string(path)?,
        None => FAMILY.to_owned(),
    };
    let family = parse::family(&text)?;
    let interpreter = family.system.compile()?;
    let mut options = EmitOptions::default();
    options.type_name = "Family".to_owned();
    options.source = family.name;
    print!("{}", emit(interpreter.program(), &options)?);
    Ok(())
}
