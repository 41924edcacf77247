//! Systems as Python gives them.

use crate::errors::Failure;
use hc::System;
use pyo3::prelude::*;

/// A text in any of the formats, or formulas; in unknowns of a given order where these come with it.
#[derive(FromPyObject)]
pub(crate) enum WrittenSystem {
    Text(String, Option<Vec<String>>),
    Formulas(Vec<String>, Option<Vec<String>>),
}

impl WrittenSystem {
    /// The system, which has no parameters.
    pub(crate) fn system(&self) -> Result<System, Failure> {
        let system = match self {
            WrittenSystem::Text(text, None) => text.parse(),
            WrittenSystem::Text(text, Some(unknowns)) => System::from_text_in(unknowns, text),
            WrittenSystem::Formulas(formulas, None) => System::from_formulas(formulas),
            WrittenSystem::Formulas(formulas, Some(unknowns)) => System::from_formulas_in(unknowns, formulas),
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
