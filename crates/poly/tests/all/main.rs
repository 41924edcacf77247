//! Tests of `poly` through its public items, in one program: each program of tests links the library
//! anew.

mod double_double;
#[cfg(feature = "emit")]
mod emit;
mod exact;
mod fuzz;
mod recorded_systems;
