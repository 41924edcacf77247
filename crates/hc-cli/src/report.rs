//! What `hc solve` and `hc track` write as JSON.

use hc::Solutions;
use serde::Serialize;

/// The JSON of one system.
#[derive(Serialize)]
pub(crate) struct Report<'a> {
    variables: &'a [String],
    seed: u64,
    seconds: f64,
    #[serde(flatten)]
    found: &'a Solutions,
}

impl<'a> Report<'a> {
    pub(crate) fn new(found: &'a Solutions, seed: u64, seconds: f64) -> Report<'a> {
        Report { variables: &found.variables, seed, seconds, found }
    }
}
