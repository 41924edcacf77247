//! `tdoa.calibrate`.

use crate::arrays::array;
use crate::errors::{Failure, guarded};
use crate::measured::Table;
use crate::work::{Done, How, run, whole};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;
use tdoa::{
    CalibrateError, CalibrateOptions, Calibration, Errors, KnownDistance, MeasuredPosition, ReceiverDelays, Unfinished,
    calibrate_with,
};

/// Settings as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Settings {
    sigma: Option<f64>,
    anchors: Vec<Option<[f64; 2]>>,
    /// Receiver, x and y, standard deviation.
    positions: Vec<(usize, [Option<f64>; 2], f64)>,
    distances: Vec<(usize, usize, f64)>,
    receiver_delays: String,
    errors: String,
    estimate_speed: bool,
    seed: u64,
    max_starts: Option<usize>,
    agreeing: Option<usize>,
}

impl Settings {
    fn options(self) -> Result<CalibrateOptions, Failure> {
        let mut options = CalibrateOptions::default();
        options.sigma = self.sigma;
        options.seed = self.seed;
        options.anchors = self.anchors;
        let measured = |(receiver, position, sigma)| MeasuredPosition { receiver, position, sigma: [sigma; 2] };
        options.positions = self.positions.into_iter().map(measured).collect();
        options.estimate_speed = self.estimate_speed;
        let known = |(a, b, distance)| KnownDistance { receivers: [a, b], distance };
        options.distances = self.distances.into_iter().map(known).collect();
        options.max_starts = self.max_starts.unwrap_or(options.max_starts);
        options.min_starts = options.min_starts.min(options.max_starts);
        options.agreeing = self.agreeing.unwrap_or(options.agreeing);
        options.receiver_delays = match self.receiver_delays.as_str() {
            "none" => ReceiverDelays::None,
            "auto" => ReceiverDelays::Auto,
            "all" => ReceiverDelays::All,
            other => {
                return Err(Failure::Input(format!("receiver_delays must be none, auto or all, not {other:?}")));
            }
        };
        options.errors = match self.errors.as_str() {
            "symmetric" => Errors::Symmetric,
            "one-sided" => Errors::OneSided,
            other => return Err(Failure::Input(format!("errors must be symmetric or one-sided, not {other:?}"))),
        };
        Ok(options)
    }
}

/// The JSON of the program: offsets in seconds too, where the measurements were times.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    calibration: &'a Calibration,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<Unit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offsets_in_units: Option<Vec<Option<f64>>>,
}

#[derive(Serialize)]
struct Unit {
    name: &'static str,
    metres: f64,
}

/// Calibrates, and gives the JSON that the program writes; as partial result a dict of the best
/// network so far, or `None`.
#[pyfunction]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    table: Table<'py>,
    settings: Settings,
    speed: Option<f64>,
    how: How,
) -> PyResult<Bound<'py, PyAny>> {
    guarded(|| {
        let measured = table.measured()?;
        let options = settings.options()?;
        let Done { result: found, stopped, .. } =
            run(py, &how, move |monitor| calibrate_with(&measured, &options, &[], monitor))?;
        let mut calibration = match found {
            Ok(calibration) => calibration,
            Err(CalibrateError::Cancelled(best)) => {
                let best = best.map(|best| unfinished(py, &best)).transpose()?;
                return whole(py, best.into_bound_py_any(py)?, stopped);
            }
            Err(
                error @ (CalibrateError::Degenerate(_) | CalibrateError::NotFound(_) | CalibrateError::Delays { .. }),
            ) => {
                return Err(Failure::undetermined(error));
            }
            Err(error) => return Err(Failure::input(error)),
        };
        if speed.is_none() {
            calibration.warnings.extend(tdoa::summary::doubt_of_units(&calibration));
        }
        if let (Some(speed), Some(found)) = (speed, &mut calibration.speed) {
            found.metres_per_second = Some(speed * found.factor);
        }
        let metres = speed.map(|speed| speed * calibration.speed.map_or(1.0, |found| found.factor));
        let offsets = |metres: f64| calibration.offsets.iter().map(|o| o.map(|o| o / metres)).collect();
        let report = Report {
            calibration: &calibration,
            units: metres.map(|metres| Unit { name: "s", metres }),
            offsets_in_units: metres.map(offsets),
        };
        let mut json = serde_json::to_string_pretty(&report).map_err(Failure::input)?;
        json.push('\n');
        whole(py, json.into_bound_py_any(py)?, stopped)
    })
}

fn unfinished<'py>(py: Python<'py>, best: &Unfinished) -> Result<Bound<'py, PyDict>, Failure> {
    let found = PyDict::new(py);
    for (name, points) in [("receivers", &best.receivers), ("transmitters", &best.transmitters)] {
        let numbers: Vec<f64> = points.iter().flat_map(|point| point.unwrap_or([f64::NAN; 2])).collect();
        found.set_item(name, array(py, numbers, &[points.len(), 2])?)?;
    }
    let offsets: Vec<f64> = best.offsets.iter().map(|offset| offset.unwrap_or(f64::NAN)).collect();
    found.set_item("offsets", array(py, offsets, &[best.offsets.len()])?)?;
    found.set_item("starts", best.starts)?;
    found.set_item("agreeing", best.agreeing)?;
    Ok(found)
}

fn parsed(json: &str) -> Result<Calibration, Failure> {
    serde_json::from_str(json).map_err(|error| Failure::Input(format!("no calibration: {error}")))
}

/// The report of a calibration for a browser, from its JSON.
#[pyfunction]
pub(crate) fn calibration_html(json: &str) -> PyResult<String> {
    guarded(|| Ok(tdoa::html::html(&parsed(json)?)))
}

/// The picture of a calibration as SVG, from its JSON.
#[pyfunction]
pub(crate) fn calibration_svg(json: &str) -> PyResult<String> {
    guarded(|| Ok(tdoa::picture::picture(&parsed(json)?)))
}

/// The words of the program on a calibration, from its JSON.
#[pyfunction]
pub(crate) fn calibration_summary(json: &str) -> PyResult<String> {
    guarded(|| Ok(tdoa::summary::summary(&parsed(json)?)))
}

/// The standard deviation of the measurements in words, and by how much ellipses are to be drawn
/// larger than they are, from the JSON.
#[pyfunction]
pub(crate) fn calibration_style(json: &str) -> PyResult<(String, f64)> {
    guarded(|| {
        let calibration = parsed(json)?;
        Ok((tdoa::summary::deviation(&calibration), tdoa::picture::ellipse_magnification(&calibration)))
    })
}
