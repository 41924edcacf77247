//! What the emitter refuses, how it splits long programs, and that it writes the same source every time. Whether the files under
//! benches/generated are what it writes, `cargo xtask codegen --check` says.

#[path = "../benches/common/mod.rs"]
mod common;

use poly::program::{EmitError, EmitOptions, emit};

#[test]
fn source_is_the_same_every_time() {
    let source = || {
        let text = |case: common::Case| {
            let mut options = EmitOptions::default();
            options.source = case.name.to_owned();
            emit(case.system.compile().unwrap().program(), &options).unwrap()
        };
        common::cases().into_iter().map(text).collect::<Vec<String>>()
    };
    assert!(source() == source());
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
