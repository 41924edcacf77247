//! Systems, and numbers in JSON.

pub(crate) use cli::input::{check, is_standard, name, text};

use cli::Failure;
use hc::System;
use num_complex::Complex64;
use serde::Deserialize;
use std::path::Path;

/// Reads a system without parameters, in whichever format it is.
pub(crate) fn system(file: &Path) -> Result<System, Failure> {
    let system: System = text(file)?.parse().map_err(|e| Failure::in_file(file, e))?;
    if let [first, ..] = system.parameters() {
        let message = format!(
            "a family of systems, not one: it has parameters ({first}, ...); write numbers for them, or see `hc monodromy` and `hc track`"
        );
        return Err(Failure::in_file(file, message));
    }
    Ok(system)
}

/// A real number, or real and imaginary part.
#[derive(Deserialize, Clone, Copy)]
#[serde(untagged)]
pub(crate) enum Number {
    Real(f64),
    Complex([f64; 2]),
}

impl From<Number> for Complex64 {
    fn from(number: Number) -> Complex64 {
        match number {
            Number::Real(re) => Complex64::new(re, 0.0),
            Number::Complex([re, im]) => Complex64::new(re, im),
        }
    }
}
