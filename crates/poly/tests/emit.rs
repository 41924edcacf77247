//! Emitted source is deterministic: the files under benches/generated are what the emitter writes today.
//!
//! Run with the environment variable `POLY_WRITE_GENERATED` set to write the files anew.

#[path = "../benches/common/mod.rs"]
mod common;

use poly::program::{EmitError, EmitOptions, emit};
use std::path::Path;

/// File and type of the generated code of a case.
fn names(case: &str) -> (String, String) {
    let file: String = case.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
    let file = if file.starts_with(char::is_numeric) { format!("s{file}") } else { file };
    let type_name = file.split('_').map(|part| part[..1].to_uppercase() + &part[1..]).collect();
    (file, type_name)
}

#[test]
fn files_are_what_the_emitter_writes() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/generated");
    for case in common::cases() {
        let (file, type_name) = names(case.name);
        let mut options = EmitOptions::default();
        options.type_name = type_name;
        options.source = case.name.to_owned();
        let text = emit(case.system.compile().unwrap().program(), &options).unwrap();
        let path = folder.join(format!("{file}.rs"));
        if std::env::var_os("POLY_WRITE_GENERATED").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let found = std::fs::read_to_string(&path).unwrap();
        assert!(text == found, "{} is stale: set POLY_WRITE_GENERATED and run again", path.display());
    }
}

#[test]
fn names_that_are_not_rust_are_refused() {
    let system = poly::System::build(|s| vec![s.variable("x")]).unwrap();
    let program = system.compile().unwrap();
    let mut options = EmitOptions::default();
    options.type_name = "2x".to_owned();
    assert_eq!(emit(program.program(), &options), Err(EmitError::TypeName("2x".to_owned())));
    options.type_name = "X".to_owned();
    options.crate_path = "hc::".to_owned();
    assert_eq!(emit(program.program(), &options), Err(EmitError::CratePath("hc::".to_owned())));
}

#[test]
fn long_programs_are_split() {
    let case = common::cases().into_iter().next_back().unwrap();
    let mut options = EmitOptions::default();
    options.operations_per_function = 50;
    let text = emit(case.system.compile().unwrap().program(), &options).unwrap();
    for part in text.split("fn run(self)").skip(1) {
        let operations = part.matches("let t").count();
        assert!(operations <= 50, "{operations} in one function");
    }
    assert!(text.contains("Jacobian3"));
}
