//! Systems as Python gives them.

use crate::errors::Failure;
use hc::System;
use pyo3::prelude::*;

/// A text in any of the formats, or formulas; in unknowns of a given order where these come with it.
#[derive(FromPyObject)]
pub(crate) enum Given {
    Text(String, Option<Vec<String>>),
    Formulas(Vec<String>, Option<Vec<String>>),
}

impl Given {
    /// The system, which has no parameters.
    pub(crate) fn system(&self) -> Result<System, Failure> {
        let system = match self {
            Given::Text(text, None) => text.parse(),
            Given::Text(text, Some(unknowns)) => System::from_text_in(unknowns, text),
            Given::Formulas(formulas, None) => System::from_formulas(formulas),
            Given::Formulas(formulas, Some(unknowns)) => System::from_formulas_in(unknowns, formulas),
        };
        let system: System = system.map_err(Failure::input)?;
        if let [first, ..] = system.parameters() {
            return Err(Failure::Input(format!(
                "a family of systems, not one: it has parameters ({first}, ...); write numbers for them, or see hc.Family"
            )));
        }
        Ok(system)
    }
}
