//! What an interrupted calibration leaves.

use std::path::Path;

use serde::Serialize;
use tdoa::{Pseudoranges, Unfinished};

use crate::{Failure, output};

/// The best network so far, with a mark that it is no result.
#[derive(Serialize)]
#[serde(bound = "Unfinished<D>: Serialize")]
struct Partial<'a, const D: usize> {
    unfinished: bool,
    dimensions: usize,
    configuration: String,
    receiver_names: &'a [String],
    transmitter_names: &'a [String],
    #[serde(flatten)]
    best: &'a Unfinished<D>,
}

/// Writes the best network so far to the file for the JSON, if one is asked for, and says so.
pub(crate) fn write<const D: usize>(best: &Unfinished<D>, measured: &Pseudoranges, json: Option<&Path>) -> Failure
where
    Unfinished<D>: Serialize,
{
    let found = format!("{} of {} starts agreed on the best network so far", best.agreeing, best.starts);
    let Some(path) = json else {
        return Failure::Stopped(format!("{found}, which nothing asked for (--json); nothing was written"));
    };
    let partial = Partial {
        unfinished: true,
        dimensions: D,
        configuration: measured.configuration(),
        receiver_names: measured.receiver_names(),
        transmitter_names: measured.transmitter_names(),
        best,
    };
    match output::json(path, &partial) {
        Ok(()) => Failure::Stopped(format!("{found}, which is the partial result (\"unfinished\": true)")),
        Err(failure) => failure,
    }
}
