//! `tdoa.listen`.

use crate::arrays::elements;
use crate::errors::{Failure, guarded};
use crate::json;
use crate::work::{Done, WorkOptions, run, whole};
use hc::Stage;
use numpy::PyReadonlyArrayDyn;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use serde::Serialize;
use sound::{Heard, ListenError, ListenMonitor, ListenOptions, SampleFormat, Signal, listen_watched, write_wav};
use tdoa::Monitor;

/// ListenSettings as Python gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ListenSettings {
    /// Metres per second.
    speed: f64,
    /// Metres.
    extent: f64,
    /// Hz.
    band: Option<[f64; 2]>,
    /// dB.
    threshold: Option<f64>,
    least_channels: usize,
    /// From, to, Hz; seconds.
    chirp: Option<[f64; 3]>,
    /// A file.
    template: Option<String>,
}

impl ListenSettings {
    fn options(self) -> Result<ListenOptions, Failure> {
        let signal = match (self.template, self.chirp) {
            (Some(path), _) => Signal::read(path).map_err(Failure::input)?,
            (None, Some([from, to, seconds])) => Signal::Chirp { from, to, seconds },
            (None, None) => Signal::Unknown,
        };
        let mut options = ListenOptions::of(signal);
        if let Some(band) = self.band {
            (options.events.band, options.times.band) = (band, band);
        }
        (options.events.extent, options.events.speed) = (self.extent, self.speed);
        options.events.least_channels = self.least_channels;
        if let Some(decibels) = self.threshold {
            options.events.threshold = 10f64.powf(decibels / 20.0);
        }
        Ok(options)
    }
}

/// What was heard, in the form of the program's JSON, and the list of arrivals.
#[derive(Serialize)]
struct Report {
    names: Vec<String>,
    recorder_names: Vec<String>,
    warnings: Vec<String>,
    counts: String,
    list: String,
    #[serde(flatten)]
    heard: Heard,
}

/// Listens to the files of each recorder; the JSON of what was heard.
#[pyfunction]
pub(crate) fn listen<'py>(
    py: Python<'py>,
    recorders: Vec<Vec<String>>,
    settings: ListenSettings,
    how: WorkOptions,
) -> PyResult<Bound<'py, PyAny>> {
    guarded(|| {
        let options = settings.options()?;
        let Done { result, stopped, .. } = run(py, &how, move |monitor| {
            let heard = match listen_watched(&recorders, &options, &asking(monitor)) {
                Err(ListenError::Stopped) => return Ok::<_, Failure>(None),
                heard => heard.map_err(Failure::input)?,
            };
            let report = json::text(&Report {
                names: heard.names(),
                recorder_names: heard.recorder_names(),
                warnings: heard.warnings(),
                counts: heard.counts(),
                list: heard.list(),
                heard,
            })?;
            Ok(Some(report))
        })?;
        whole(py, result?.into_bound_py_any(py)?, stopped)
    })
}

/// A monitor of listening that tells another one how far it is, and stops with it.
fn asking(monitor: &Monitor) -> ListenMonitor {
    let monitor = monitor.clone();
    ListenMonitor::asking(move |progress| {
        if monitor.progress().total != progress.total {
            monitor.enter(Stage::Preparing, progress.total);
        }
        monitor.reach(progress.done, 0);
        monitor.is_cancelled()
    })
}

/// The speed of sound in air of this temperature in degrees Celsius, metres per second.
#[pyfunction]
pub(crate) fn speed_of_sound(celsius: f64) -> f64 {
    sound::speed_of_sound(celsius)
}

/// Writes samples, a row a channel, as a recording of floats.
#[pyfunction]
pub(crate) fn write_recording(path: &str, samples: PyReadonlyArrayDyn<'_, f32>, rate: u32) -> PyResult<()> {
    guarded(|| {
        let (values, shape) = elements(&samples, 2)?;
        let channels: Vec<&[f32]> = match shape[1] {
            0 => vec![&[]; shape[0]],
            length => values.chunks_exact(length).collect(),
        };
        write_wav(path, rate, &channels, SampleFormat::Float32).map_err(Failure::input)
    })
}
