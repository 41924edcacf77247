//! What `hc solve`, `hc track` and `hc decompose` write as JSON.

use serde::Serialize;

/// The JSON of one system, of which this was found.
#[derive(Serialize)]
pub(crate) struct Report<'a, T> {
    pub(crate) variables: &'a [String],
    pub(crate) seed: u64,
    pub(crate) seconds: f64,
    #[serde(flatten)]
    pub(crate) found: &'a T,
}
