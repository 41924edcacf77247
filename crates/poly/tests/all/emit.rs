//! What the emitter refuses, how it splits long programs, and that it writes the same source every
//! time. Whether generated code computes what the interpreter computes, the tests of crates/benches
//! say.

use poly::System;
use poly::program::{EmitError, EmitOptions, emit};

/// Three formulas of sixty products that have nothing in common.
fn long() -> System {
    let formula = |seed: usize| {
        let product = |k: usize| format!("(x + {}*y)*(z - {}*y)", seed + 7 * k, seed + 11 * k + 3);
        (0..60).map(product).collect::<Vec<_>>().join(" + ")
    };
    System::from_formulas(&[formula(1), formula(1000), formula(2000)]).unwrap()
}

#[test]
fn source_is_the_same_every_time() {
    let source = || emit(long().compile().unwrap().program(), &EmitOptions::default()).unwrap();
    assert!(source() == source());
}

#[test]
fn names_that_are_not_rust_are_refused() {
    let system = System::from_formulas(&["x"]).unwrap();
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
    let mut options = EmitOptions::default();
    options.operations_per_function = 50;
    let text = emit(long().compile().unwrap().program(), &options).unwrap();
    for part in text.split("fn run(self)").skip(1) {
        let operations = part.matches("let t").count();
        assert!(operations <= 50, "{operations} in one function");
    }
    assert!(text.contains("Jacobian3"));
}
