//! Fills a generic fibre of each family and writes its solver.

use hc::family::StartFile;
use hc::{Family, MonodromyOptions, codegen};
use std::error::Error;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let output = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("no OUT_DIR")?);
    for name in ["five_point", "chicago"] {
        let path = Path::new("../families").join(name).with_extension("toml");
        println!("cargo::rerun-if-changed={}", path.display());
        let family: Family = std::fs::read_to_string(&path)?.parse()?;
        // The families state their numbers of roots, at which the search stops.
        let found = family.monodromy(&MonodromyOptions::new())?;
        if !found.stopped.is_complete() {
            return Err(format!("{name}: only {} solutions found", found.fibre.len()).into());
        }
        let start = StartFile::new(&found.fibre, None, &found.stopped.to_string());
        let code = codegen::generate(&family, &start, &format!("{name}.toml"))?;
        std::fs::write(output.join(name).with_extension("rs"), format!("mod {name} {{\n{code}}}\n"))?;
    }
    Ok(())
}
