//! Writes the measured systems as Rust source.

// Each system is made from its formula, here and in the benches.
#[path = "src/systems.rs"]
#[expect(unreachable_pub, reason = "the module is public in the library")]
mod systems;

use poly::program::{EmitOptions, emit};
use std::error::Error;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut source = String::new();
    for case in systems::cases() {
        let mut options = EmitOptions::default();
        options.type_name = case.type_name.to_owned();
        options.source = case.name.to_owned();
        let code = emit(case.system.compile()?.program(), &options)?;
        source += &format!("/// {}.\npub mod {} {{\n{code}}}\n", case.name, case.module);
    }
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);
    std::fs::write(folder.join("generated.rs"), source)?;
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/systems.rs");
    Ok(())
}
