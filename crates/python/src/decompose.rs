//! `hc.decompose`.

use crate::errors::{Failure, guarded};
use crate::json::{self, FORMAT};
use crate::system::WrittenSystem;
use crate::work::{Done, WorkOptions, run, whole};
use hc::witness::Decomposition;
use hc::{Run, SolveOptions};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

/// The JSON of the program, without the seconds.
#[derive(Serialize)]
struct Report<'a> {
    format: u32,
    variables: &'a [String],
    seed: u64,
    #[serde(flatten)]
    found: &'a Decomposition,
}

/// All solutions of a system: a dict of the JSON and the words of the program, and the seconds.
#[pyfunction]
pub(crate) fn decompose(
    py: Python<'_>,
    system: WrittenSystem,
    seed: u64,
    max_paths: u64,
    how: WorkOptions,
) -> PyResult<Bound<'_, PyAny>> {
    guarded(|| {
        let system = system.system()?;
        let options = SolveOptions::new().seed(seed).max_paths(max_paths);
        let Done { result: found, stopped, seconds } =
            run(py, &how, move |monitor| Run::new().watched(monitor).decompose(&system, &options))?;
        let found = found.map_err(Failure::input)?;
        let report = Report { format: FORMAT, variables: &found.variables, seed, found: &found };
        let result = PyDict::new(py);
        result.set_item("json", json::text(&report)?)?;
        result.set_item("summary", found.to_string())?;
        result.set_item("seconds", seconds)?;
        whole(py, result.into_any(), stopped)
    })
}
