//! Results as JSON, in the form of the programs.

use crate::errors::Failure;
use serde::Serialize;

/// Number of the form of results as JSON, that of the programs (`cli::output::FORMAT`): the tests compare the two.
pub(crate) const FORMAT: u32 = 1;

/// A report as the programs write it: indented, with a line's end.
pub(crate) fn text(report: &impl Serialize) -> Result<String, Failure> {
    Ok(serde_json::to_string_pretty(report).map_err(Failure::input)? + "\n")
}
