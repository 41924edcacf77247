//! Systems, and numbers in JSON.

pub(crate) use cli::input::{is_standard, name, text};

use cli::Failure;
use cli::files::Files;
use hc::System;
use hc::ranks::Ranks;
use num_complex::Complex64;
use serde::Deserialize;
use std::path::Path;

/// Checks, before the work begins, the files of one of several processes, or of the only one.
pub(crate) fn check(files: &Files<'_>, ranks: Option<&Ranks<'_>>) -> Result<(), Failure> {
    match ranks {
        Some(ranks) => files.check_shared(ranks.is_lead()),
        None => files.check(),
    }
}

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
