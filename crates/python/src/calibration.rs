//! `tdoa.calibrate`, in the plane and in space.

use crate::arrays::array;
use crate::clocks;
use crate::errors::{Failure, guarded};
use crate::json::{self, FORMAT};
use crate::measured::Table;
use crate::work::{Done, WorkOptions, run, whole};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use tdoa::calibrate::{Calibrated, CalibratedError, calibrate_either};
use tdoa::{
    CalibrateError, CalibrateOptions, Calibration, Errors, KnownDistance, LocateError, LocatedEvent, Locator,
    MeasuredPosition, Node, Pseudoranges, ReceiverDelays, Unfinished, calibrate_with,
};

/// CalibrateSettings as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct CalibrateSettings {
    /// 2 or 3; the measurements decide where there is neither.
    dimensions: Option<usize>,
    sigma: Option<f64>,
    /// Of as many coordinates as there are dimensions, three where the measurements decide.
    anchors: Vec<Option<Vec<f64>>>,
    /// Place among receivers and then transmitters, coordinates, standard deviation.
    positions: Vec<(usize, Vec<Option<f64>>, f64)>,
    distances: Vec<(usize, usize, f64, Option<f64>)>,
    receiver_delays: String,
    emissions: String,
    receiver_clocks: String,
    offset_sigma: Option<f64>,
    rate_sigma: Option<f64>,
    /// Of each receiver, by name.
    recorders: Option<Vec<String>>,
    /// When each transmitter sends, metres.
    emission_times: Option<Vec<f64>>,
    errors: String,
    estimate_speed: bool,
    seed: u64,
    max_starts: Option<usize>,
    agreeing: Option<usize>,
}

impl CalibrateSettings {
    fn options<const D: usize>(self) -> Result<CalibrateOptions<D>, Failure> {
        let mut options = CalibrateOptions::new();
        options.sigma = self.sigma;
        options.seed = self.seed;
        let exact = self.anchors.into_iter().map(|position| position.map(coordinates).transpose());
        options.anchors = exact.collect::<Result<_, _>>()?;
        let receivers = options.anchors.len();
        let measured = |(node, position, sigma): (usize, _, _)| {
            let node = node.checked_sub(receivers).map_or(Node::Receiver(node), Node::Transmitter);
            Ok(MeasuredPosition { node, position: coordinates(position)?, sigma: [sigma; D] })
        };
        options.positions = self.positions.into_iter().map(measured).collect::<Result<_, Failure>>()?;
        options.estimate_speed = self.estimate_speed;
        let known = |(a, b, distance, sigma)| KnownDistance { receivers: [a, b], distance, sigma };
        options.distances = self.distances.into_iter().map(known).collect();
        options.search.max_starts = self.max_starts.unwrap_or(options.search.max_starts);
        options.search.min_starts = options.search.min_starts.min(options.search.max_starts);
        options.search.agreeing = self.agreeing.unwrap_or(options.search.agreeing);
        options.receiver_delays = match self.receiver_delays.as_str() {
            "none" => ReceiverDelays::None,
            "auto" => ReceiverDelays::Auto,
            other => {
                return Err(Failure::Input(format!("receiver_delays must be none, auto or all, not {other:?}")));
            }
        };
        options.clocks.emissions = clocks::emissions(&self.emissions)?;
        options.clocks.receivers = clocks::receivers(&self.receiver_clocks)?;
        (options.clocks.offset_sigma, options.clocks.rate_sigma) = (self.offset_sigma, self.rate_sigma);
        options.errors = match self.errors.as_str() {
            "auto" => Errors::Auto,
            "symmetric" => Errors::Symmetric,
            "one-sided" => Errors::OneSided,
            other => return Err(Failure::Input(format!("errors must be auto, symmetric or one-sided, not {other:?}"))),
        };
        Ok(options)
    }
}

fn coordinates<T, const D: usize>(all: Vec<T>) -> Result<[T; D], Failure> {
    all.try_into().map_err(|all: Vec<T>| Failure::Input(format!("a position has {D} coordinates, not {}", all.len())))
}

/// The JSON of the program: offsets in seconds too, where the measurements were times.
#[derive(Serialize, Deserialize)]
#[serde(bound(serialize = "Calibration<D>: Serialize", deserialize = "Calibration<D>: Deserialize<'de>"))]
struct Report<const D: usize> {
    #[serde(default = "format")]
    format: u32,
    #[serde(flatten)]
    calibration: Calibration<D>,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<Unit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offsets_in_units: Option<Vec<Option<f64>>>,
}

#[derive(Serialize, Deserialize)]
struct Unit {
    name: String,
    metres: f64,
}

fn format() -> u32 {
    FORMAT
}

/// Calibrates, and gives the JSON that the program writes; as partial result a dict of the best
/// network so far, or `None`.
#[pyfunction]
pub(crate) fn calibrate<'py>(
    py: Python<'py>,
    table: Table<'py>,
    settings: CalibrateSettings,
    speed: Option<f64>,
    how: WorkOptions,
) -> PyResult<Bound<'py, PyAny>> {
    guarded(|| {
        let mut measured = table.measured()?;
        if let Some(recorders) = &settings.recorders {
            measured = measured.with_recorders(recorders.clone()).map_err(Failure::input)?;
        }
        if let Some(times) = &settings.emission_times {
            measured = measured.with_emission_times(times.clone()).map_err(Failure::input)?;
        }
        let done = match settings.dimensions {
            Some(2) => {
                let options = settings.options()?;
                run(py, &how, move |monitor| Ok(Calibrated::Plane(calibrate_with(&measured, &options, &[], monitor)?)))?
            }
            Some(3) => {
                let options = settings.options()?;
                run(py, &how, move |monitor| Ok(Calibrated::Space(calibrate_with(&measured, &options, &[], monitor)?)))?
            }
            None => {
                let options = settings.options()?;
                run(py, &how, move |monitor| calibrate_either(&measured, &options, monitor))?
            }
            Some(other) => return Err(Failure::Input(format!("dimensions must be 2, 3 or auto, not {other}"))),
        };
        let Done { result: found, stopped, .. } = done;
        let ended = match found {
            Ok(Calibrated::Plane(calibration)) => report(calibration, speed)?.into_bound_py_any(py)?,
            Ok(Calibrated::Space(calibration)) => report(calibration, speed)?.into_bound_py_any(py)?,
            Err(CalibratedError::Plane(error)) => partial(py, error)?,
            Err(CalibratedError::Space(error)) => partial(py, error)?,
        };
        whole(py, ended, stopped)
    })
}

/// The JSON of a calibration.
fn report<const D: usize>(mut calibration: Calibration<D>, speed: Option<f64>) -> Result<String, Failure>
where
    Calibration<D>: Serialize,
{
    if speed.is_none() {
        calibration.warnings.extend(tdoa::summary::doubt_of_units(&calibration));
    }
    if let (Some(speed), Some(found)) = (speed, &mut calibration.speed) {
        found.metres_per_second = Some(speed * found.factor);
    }
    let metres = speed.map(|speed| speed * calibration.speed.map_or(1.0, |found| found.factor));
    let offsets = |metres: f64| calibration.offsets.iter().map(|o| o.map(|o| o / metres)).collect();
    let offsets_in_units = metres.map(offsets);
    let units = metres.map(|metres| Unit { name: "s".to_string(), metres });
    json::text(&Report { format: FORMAT, calibration, units, offsets_in_units })
}

/// What a calibration leaves that was stopped; why there is none, for all others.
fn partial<const D: usize>(py: Python<'_>, error: CalibrateError<D>) -> Result<Bound<'_, PyAny>, Failure> {
    match error {
        CalibrateError::Cancelled(best) => {
            let best = best.map(|best| unfinished(py, &best)).transpose()?;
            Ok(best.into_bound_py_any(py)?)
        }
        CalibrateError::Degenerate(_) | CalibrateError::NotFound(_) | CalibrateError::Clocks { .. } => {
            Err(Failure::undetermined(error))
        }
        error => Err(Failure::input(error)),
    }
}

fn unfinished<'py, const D: usize>(py: Python<'py>, best: &Unfinished<D>) -> Result<Bound<'py, PyDict>, Failure> {
    let found = PyDict::new(py);
    for (name, points) in [("receivers", &best.receivers), ("transmitters", &best.transmitters)] {
        let numbers: Vec<f64> = points.iter().flat_map(|point| point.unwrap_or([f64::NAN; D])).collect();
        found.set_item(name, array(py, numbers, &[points.len(), D])?)?;
    }
    let offsets: Vec<f64> = best.offsets.iter().map(|offset| offset.unwrap_or(f64::NAN)).collect();
    found.set_item("offsets", array(py, offsets, &[best.offsets.len()])?)?;
    found.set_item("starts", best.starts)?;
    found.set_item("agreeing", best.agreeing)?;
    Ok(found)
}

/// How calibrations of any dimension are shown.
trait Shown {
    fn html(&self) -> String;
    fn picture(&self) -> String;
    fn summary(&self) -> String;
    fn nodes(&self) -> String;
    fn deviation(&self) -> String;
    fn magnification(&self) -> f64;
    fn has_systematic_errors(&self) -> bool;
    fn located(&self, measured: &Pseudoranges, sigma: Option<f64>) -> Result<String, Failure>;
}

impl<const D: usize> Shown for Calibration<D>
where
    LocatedEvent<D>: Serialize,
{
    fn html(&self) -> String {
        tdoa::html::html(self)
    }

    fn picture(&self) -> String {
        tdoa::picture::picture(self)
    }

    fn summary(&self) -> String {
        tdoa::summary::summary(self)
    }

    fn nodes(&self) -> String {
        tdoa::node_table::node_table(self)
    }

    fn deviation(&self) -> String {
        tdoa::summary::deviation(self)
    }

    fn magnification(&self) -> f64 {
        tdoa::picture::ellipse_magnification(self)
    }

    fn has_systematic_errors(&self) -> bool {
        self.relevant_systematic().is_some()
    }

    fn located(&self, measured: &Pseudoranges, sigma: Option<f64>) -> Result<String, Failure> {
        let locator = Locator::new(self, sigma).map_err(|error| match error {
            LocateError::Distrust { .. } => Failure::Undetermined(error.to_string()),
            other => Failure::input(other),
        })?;
        json::text(&locator.locate(measured).map_err(Failure::input)?)
    }
}

/// What JSON says of its dimensions; without a word it is of the plane.
#[derive(Deserialize)]
struct Head {
    dimensions: Option<usize>,
}

fn parsed(json: &str) -> Result<Box<dyn Shown>, Failure> {
    match read::<Head>(json)?.dimensions {
        None | Some(2) => Ok(Box::new(read::<Calibration>(json)?)),
        Some(3) => Ok(Box::new(read::<Calibration<3>>(json)?)),
        Some(other) => Err(Failure::Input(format!("no calibration: its dimensions are {other}, not 2 or 3"))),
    }
}

fn read<T: DeserializeOwned>(json: &str) -> Result<T, Failure> {
    serde_json::from_str(json).map_err(|error| Failure::Input(format!("no calibration: {error}")))
}

/// The report of a calibration for a browser, from its JSON.
#[pyfunction]
pub(crate) fn calibration_html(json: &str) -> PyResult<String> {
    guarded(|| Ok(parsed(json)?.html()))
}

/// The picture of a calibration as SVG, from its JSON.
#[pyfunction]
pub(crate) fn calibration_svg(json: &str) -> PyResult<String> {
    guarded(|| Ok(parsed(json)?.picture()))
}

/// The words of the program on a calibration, from its JSON.
#[pyfunction]
pub(crate) fn calibration_summary(json: &str) -> PyResult<String> {
    guarded(|| Ok(parsed(json)?.summary()))
}

/// The table of the nodes as CSV, from the JSON of a calibration.
#[pyfunction]
pub(crate) fn calibration_nodes(json: &str) -> PyResult<String> {
    guarded(|| Ok(parsed(json)?.nodes()))
}

/// The JSON of a calibration that is compared with the true positions of receivers and transmitters, as many as there are,
/// and in the frame of these, unless known positions have given it a frame.
#[pyfunction]
pub(crate) fn calibration_compared(
    json: &str,
    receivers: Vec<Option<Vec<f64>>>,
    transmitters: Vec<Option<Vec<f64>>>,
    keeps_frame: bool,
) -> PyResult<String> {
    guarded(|| match read::<Head>(json)?.dimensions {
        Some(3) => compared(read::<Report<3>>(json)?, receivers, transmitters, keeps_frame),
        _ => compared(read::<Report<2>>(json)?, receivers, transmitters, keeps_frame),
    })
}

fn compared<const D: usize>(
    mut report: Report<D>,
    receivers: Vec<Option<Vec<f64>>>,
    transmitters: Vec<Option<Vec<f64>>>,
    keeps_frame: bool,
) -> Result<String, Failure>
where
    Calibration<D>: Serialize,
{
    let points = |all: Vec<Option<Vec<f64>>>| -> Result<Vec<Option<[f64; D]>>, Failure> {
        all.into_iter().map(|position| position.map(coordinates).transpose()).collect()
    };
    let (receivers, transmitters) = (points(receivers)?, points(transmitters)?);
    report.calibration.compare_all(&receivers, &transmitters);
    if report.calibration.truth.is_none() {
        let problem = "two receivers at least must have a place and a true position to compare them";
        return Err(Failure::Input(problem.to_string()));
    }
    if !keeps_frame {
        report.calibration.move_to_frame_of(&receivers);
    }
    json::text(&report)
}

/// The JSON of where transmitters are in the network of a calibration, from the JSON of that one.
#[pyfunction]
pub(crate) fn calibration_located(
    json: &str,
    table: Table<'_>,
    sigma: Option<f64>,
    recorders: Option<Vec<String>>,
) -> PyResult<String> {
    guarded(|| {
        let mut measured = table.measured()?;
        if let Some(recorders) = recorders {
            measured = measured.with_recorders(recorders).map_err(Failure::input)?;
        }
        parsed(json)?.located(&measured, sigma)
    })
}

/// The standard deviation of the measurements in words, by how much ellipses are to be drawn larger
/// than they are, and whether they are those with systematic errors, from the JSON.
#[pyfunction]
pub(crate) fn calibration_style(json: &str) -> PyResult<(String, f64, bool)> {
    guarded(|| {
        let calibration = parsed(json)?;
        Ok((calibration.deviation(), calibration.magnification(), calibration.has_systematic_errors()))
    })
}
