//! `hc.solve`.

use crate::arrays::array;
use crate::errors::{Failure, guarded};
use crate::networks::numbers;
use crate::system::WrittenSystem;
use crate::work::{Done, WorkOptions, run, whole};
use hc::{Run, Solutions, SolveOptions, Start};
use num_complex::Complex64;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// SolveSettings as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct SolveSettings {
    seed: u64,
    start: String,
    /// Names of unknowns.
    groups: Vec<Vec<String>>,
    torus_only: bool,
    max_paths: Option<u64>,
    certify: bool,
}

/// All isolated solutions of a system: a dict of arrays.
#[pyfunction]
pub(crate) fn solve(
    py: Python<'_>,
    system: WrittenSystem,
    settings: SolveSettings,
    how: WorkOptions,
) -> PyResult<Bound<'_, PyAny>> {
    guarded(|| {
        let system = system.system()?;
        let unknowns = system.variables();
        let index = |name: &String| {
            let found = unknowns.iter().position(|v| v == name);
            found.ok_or_else(|| {
                Failure::Input(format!("no unknown `{name}` for groups; there are {}", unknowns.join(", ")))
            })
        };
        let groups: Result<Vec<Vec<usize>>, Failure> =
            settings.groups.iter().map(|group| group.iter().map(index).collect()).collect();
        let start = match settings.start.as_str() {
            "auto" => Start::Auto,
            "polyhedral" => Start::Polyhedral,
            "multihomogeneous" => Start::Multihomogeneous,
            "total-degree" | "total_degree" => Start::TotalDegree,
            other => {
                return Err(Failure::Input(format!(
                    "start must be auto, polyhedral, multihomogeneous or total-degree, not {other:?}"
                )));
            }
        };
        if settings.certify && system.len() != unknowns.len() {
            let message = "only systems of as many equations as unknowns can be certified; leave out certify";
            return Err(Failure::Input(message.to_owned()));
        }
        let mut options = SolveOptions::new().seed(settings.seed).start(start).groups(groups?);
        options = options.torus_only(settings.torus_only).certify(settings.certify);
        options.max_paths = settings.max_paths.unwrap_or(options.max_paths);
        let Done { result: found, stopped, seconds } =
            run(py, &how, move |monitor| Run::new().watched(monitor).solve(&system, &options))?;
        let result = solutions(py, &found.map_err(Failure::input)?)?;
        result.set_item("seed", settings.seed)?;
        result.set_item("seconds", seconds)?;
        whole(py, result.into_any(), stopped)
    })
}

/// Solutions as a dict of arrays, one row a solution, and of what became of the paths.
pub(crate) fn solutions<'py>(py: Python<'py>, found: &Solutions) -> Result<Bound<'py, PyDict>, Failure> {
    let (k, n) = (found.len(), found.variables.len());
    let points = |all: &mut dyn Iterator<Item = &Vec<Complex64>>| all.flatten().copied().collect::<Vec<Complex64>>();
    let result = PyDict::new(py);
    result.set_item("variables", &found.variables)?;
    result.set_item("points", array(py, points(&mut found.iter().map(|s| &s.value)), &[k, n])?)?;
    result.set_item("multiplicities", array(py, found.iter().map(|s| s.multiplicity as i64).collect(), &[k])?)?;
    result.set_item("winding_numbers", array(py, found.iter().map(|s| s.winding_number as i64).collect(), &[k])?)?;
    result.set_item("singular", array(py, found.iter().map(|s| s.singular).collect(), &[k])?)?;
    result.set_item("is_real", array(py, found.iter().map(|s| s.is_real).collect(), &[k])?)?;
    result.set_item("residuals", array(py, found.iter().map(|s| s.residual).collect(), &[k])?)?;
    result.set_item("conditions", array(py, found.iter().map(|s| s.condition).collect(), &[k])?)?;
    let certified: Option<Vec<bool>> = found.iter().map(|s| s.certified).collect();
    // Without solutions nobody can tell whether certificates were asked for.
    let certified = certified.filter(|_| k > 0).map(|all| array(py, all, &[k])).transpose()?;
    result.set_item("certified", certified)?;
    let components = points(&mut found.component_points.iter());
    result.set_item("component_points", array(py, components, &[found.component_points.len(), n])?)?;
    let directions = found.directions.iter().map(|d| (d.valuations.clone(), d.denominator, d.paths));
    result.set_item("directions", directions.collect::<Vec<_>>())?;
    let unresolved = found.unresolved.iter().map(|end| {
        let value = array(py, end.value.clone(), &[n])?;
        Ok((value, end.paths, end.reason.as_str()))
    });
    result.set_item("unresolved", unresolved.collect::<Result<Vec<_>, Failure>>()?)?;
    let paths = &found.paths;
    let counts = [
        ("tracked", paths.tracked),
        ("finite", paths.finite),
        ("at_infinity", paths.at_infinity),
        ("failed", paths.failed),
        ("dropped", paths.dropped),
        ("retracked", paths.retracked),
        ("on_components", found.on_components),
        ("excess", found.excess),
    ];
    result.set_item("paths", numbers(py, &counts)?)?;
    result.set_item("start", found.start.map(|start| start.to_string().replace(' ', "-")))?;
    result.set_item("mixed_volume", found.mixed_volume)?;
    result.set_item("bezout_number", found.bezout_number)?;
    result.set_item("multihomogeneous_number", found.multihomogeneous_number)?;
    result.set_item("start_systems", found.start_systems)?;
    result.set_item("partial", found.interrupted)?;
    let limited = serde_json::to_value(found.limited).map_err(Failure::input)?;
    result.set_item("limited", limited.as_str())?;
    result.set_item("warnings", found.warnings().iter().map(ToString::to_string).collect::<Vec<_>>())?;
    result.set_item("summary", found.to_string())?;
    Ok(result)
}
