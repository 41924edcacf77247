//! Systems, and numbers in JSON.

pub(crate) use cli::input::text;

use cli::Failure;
use hc::poly::{Exact, Polynomial, System, parse::phcpack};
use num_complex::Complex64;
use serde::Deserialize;
use std::path::Path;

/// Reads a system in PHCpack's format.
pub(crate) fn system(file: &Path) -> Result<System, Failure> {
    phcpack(&text(file)?).map_err(|e| Failure::in_file(file, e))
}

/// Reads a system and multiplies it out.
pub(crate) fn polynomials(file: &Path) -> Result<(System, Vec<Polynomial<Exact>>), Failure> {
    let system = system(file)?;
    let polynomials = system.expand(&Default::default()).map_err(|e| Failure::in_file(file, e))?;
    Ok((system, polynomials))
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
