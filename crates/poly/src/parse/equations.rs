//! Lists of equations, each a text of its own.

use super::error::ParseError;
use super::formula::{Names, whole_equation};
use crate::arena::Arena;
use crate::system::System;

/// A system of these equations; errors name the `part` and its number.
pub(super) fn equations<S: AsRef<str>>(
    mut arena: Arena,
    mut names: Names,
    part: &str,
    formulas: &[S],
) -> Result<System, ParseError> {
    let mut equations = Vec::with_capacity(formulas.len());
    for (k, formula) in formulas.iter().enumerate() {
        let equation = whole_equation(&mut arena, &mut names, formula.as_ref());
        equations.push(equation.map_err(|e| e.within(format!("{part} {}", k + 1)))?);
    }
    Ok(System { arena, equations })
}
