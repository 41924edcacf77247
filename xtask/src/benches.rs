//! The generated code of poly's benches: one module for each system that is measured.

// The systems are those of the benches.
#[path = "../../crates/poly/benches/common/mod.rs"]
mod common;

use anyhow::Result;
use hc::poly::program::{EmitOptions, emit};

/// A generated module: where it is, from the root of the repository, and what it says.
pub(crate) struct Module {
    pub(crate) output: String,
    pub(crate) text: String,
}

/// All modules.
pub(crate) fn modules() -> Result<Vec<Module>> {
    common::cases().into_iter().map(|case| module(case.name, &case.system)).collect()
}

fn module(name: &str, system: &poly::System) -> Result<Module> {
    let (file, type_name) = names(name);
    let mut options = EmitOptions::default();
    options.type_name = type_name;
    options.source = name.to_owned();
    let text = emit(system.compile()?.program(), &options)?;
    Ok(Module { output: format!("crates/poly/benches/generated/{file}.rs"), text })
}

/// File and type for a system: `6r/3s` becomes `s6r_3s` and `S6r3s`.
fn names(system: &str) -> (String, String) {
    let file: String = system.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    let file = if file.starts_with(char::is_numeric) { format!("s{file}") } else { file };
    let type_name = file.split('_').map(|part| part[..1].to_uppercase() + &part[1..]).collect();
    (file, type_name)
}
