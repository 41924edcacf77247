//! `tdoa calibrate`.

mod arguments;

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use cli::files::Files;
use cli::input::name;
use serde::Serialize;
use sound::Arrival;
use tdoa::calibrate::{Calibrated, CalibratedError, Calibrates, Dimension, calibrate_either};
use tdoa::html::{Provenance, html_with};
use tdoa::node_table::node_table;
use tdoa::picture::picture;
use tdoa::read::{Nodes, Units};
use tdoa::summary::doubt_of_units;
use tdoa::{
    CalibrateError, CalibrateOptions, Calibration, Errors, Monitor, Pseudoranges, ReceiverDelays, Unfinished,
    calibrate_with,
};

pub(crate) use arguments::Arguments;
use arguments::{Delays, Dimensions, Side};

use crate::frame::Frame;
use crate::known::{self, Truth};
use crate::partial;
use crate::provenance;
use crate::recordings::{Expected, Recordings, sections};
use crate::summary::{self, Context};
use crate::units::Unit;
use crate::{Failure, input, interrupt, output};

/// The JSON form: offsets in the unit of the input too, where that is not the metre.
#[derive(Serialize)]
#[serde(bound = "Calibration<D>: Serialize")]
struct Report<'a, const D: usize> {
    #[serde(flatten)]
    calibration: &'a Calibration<D>,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<Unit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offsets_in_units: Option<Vec<Option<f64>>>,
}

impl<const D: usize> Report<'_, D> {
    fn new(calibration: &Calibration<D>, units: Option<Unit>) -> Report<'_, D> {
        let converted =
            |unit: Unit| calibration.offsets.iter().map(|offset| offset.map(|offset| unit.of(offset))).collect();
        Report { calibration, units, offsets_in_units: units.map(converted) }
    }
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let further = arguments.recording.further_files();
    let files = arguments.files.iter().chain(&further).fold(Files::new(), |files, file| files.reads(Some(file)));
    let files = files.reads(arguments.anchors.as_deref());
    let files = files.reads(arguments.distances.as_deref()).reads(arguments.truth.as_deref());
    let files = files.reads(arguments.clocks.recorders.as_deref()).reads(arguments.clocks.times.as_deref());
    arguments.outputs().into_iter().fold(files, |files, (option, path)| files.writes(option, path)).check()?;
    let date = arguments.html.as_ref().map(|_| provenance::Date::read()).transpose()?;
    let recordings = arguments.recordings()?;
    let (mut measured, units) = match &recordings {
        Some(recordings) => (recordings.measured()?, Some(Units::Seconds { speed: recordings.speed() })),
        None => {
            let options = arguments.input.options(arguments.estimate_speed)?;
            let units = options.units;
            (input::measurements(arguments.file(), options)?, units)
        }
    };
    let (units, said) = (units.unwrap_or_default(), units.is_some());
    if arguments.are_started_apart() {
        measured = arguments.clocks.apart(measured)?;
    }
    let measured = arguments.clocks.recorded(measured, arguments.sending, units)?;
    let nodes = |path: &Option<PathBuf>| path.as_deref().map(input::nodes).transpose();
    let (anchors, true_nodes) = (nodes(&arguments.anchors)?, nodes(&arguments.truth)?);
    let anchors = arguments.anchors.as_deref().zip(anchors);
    let frame = arguments.frame.as_deref().map(|text| Frame::parse(text, &measured)).transpose()?;
    let heights_differ = |nodes: &Nodes| nodes.dimensions() == 3;
    let given = match (arguments.dimensions, &anchors, &frame) {
        (Dimensions::Plane, _, Some(frame)) if frame.is_spatial() => {
            return Err(Frame::too_many_names());
        }
        (Dimensions::Plane, ..) => Some((2, "as --dimensions says")),
        (Dimensions::Space, ..) => Some((3, "as --dimensions says")),
        (Dimensions::Auto, Some((_, nodes)), _) if heights_differ(nodes) => Some((3, "as the anchors have it")),
        (Dimensions::Auto, _, Some(frame)) if frame.is_spatial() => Some((3, "as --frame has it")),
        (Dimensions::Auto, ..) => None,
    };
    let chosen = given.map(|(_, by)| by);
    let task = Task { arguments, measured: &measured, recordings, true_nodes, frame, units, said, date, chosen };
    match given.map(|(dimensions, _)| dimensions) {
        Some(3) => task.given::<3>(anchors),
        Some(_) => task.given::<2>(anchors),
        None => task.chosen(anchors),
    }
}

/// What is to be calibrated, and how.
struct Task<'a> {
    arguments: &'a Arguments,
    measured: &'a Pseudoranges,
    /// Where the measurements come from, if these are recordings.
    recordings: Option<Recordings>,
    /// What the file of --truth has.
    true_nodes: Option<Nodes>,
    frame: Option<Frame>,
    units: Units,
    /// Whether the unit was said.
    said: bool,
    /// The date of the report, if one is asked for.
    date: Option<provenance::Date>,
    /// Who chose between the plane and space, if not the measurements.
    chosen: Option<&'static str>,
}

impl Task<'_> {
    /// Calibrates in the plane or in space.
    fn given<const D: usize>(&self, anchors: Option<(&Path, Nodes)>) -> Result<(), Failure>
    where
        Calibration<D>: Serialize,
        Unfinished<D>: Serialize,
        Dimension<D>: Calibrates<D>,
    {
        let mut truth = self.truth::<D>()?;
        let mut options = self.options::<D>()?;
        if let Some((path, nodes)) = anchors {
            known::fit_dimension::<D>(path, &nodes)?;
            (options.anchors, options.positions) = known::anchors(path, &nodes, self.measured)?;
            truth.notes.extend(known::heights::<D>(path, &nodes));
        }
        tell(&truth.notes);
        let started = Instant::now();
        let solved = self.watched(|monitor| calibrate_with(self.measured, &options, &[], monitor))?;
        let calibration = solved.map_err(|error| self.failure(error))?;
        self.finish(calibration, truth, started)
    }

    /// Calibrates in the plane or in space, as the measurements have it.
    fn chosen(&self, anchors: Option<(&Path, Nodes)>) -> Result<(), Failure> {
        let mut truth = self.truth::<2>()?;
        let mut options = self.options::<3>()?;
        if let Some((path, nodes)) = anchors {
            (options.anchors, options.positions) = known::anchors(path, &nodes, self.measured)?;
            truth.notes.extend(known::heights::<2>(path, &nodes));
        }
        let started = Instant::now();
        let solved = self.watched(|monitor| calibrate_either(self.measured, &options, monitor))?;
        match solved {
            Ok(Calibrated::Plane(calibration)) => {
                tell(&truth.notes);
                self.finish(calibration, truth, started)
            }
            Ok(Calibrated::Space(calibration)) => {
                let truth = self.truth::<3>().unwrap_or_else(|failure| Truth {
                    warnings: vec![format!("nothing is compared with the truth: {failure}")],
                    ..Truth::default()
                });
                tell(&truth.notes);
                self.finish(calibration, truth, started)
            }
            Err(CalibratedError::Plane(error)) => Err(self.failure(error)),
            Err(CalibratedError::Space(error)) => Err(self.failure(error)),
        }
    }

    fn truth<const D: usize>(&self) -> Result<Truth<D>, Failure> {
        let given = self.arguments.truth.as_deref().zip(self.true_nodes.as_ref());
        let truth = Truth::read(given, self.arguments.file(), self.measured)?;
        if self.arguments.scale && truth.receivers.is_none() {
            return Err(Failure::Unusable("--scale needs --truth with the true positions".to_string()));
        }
        Ok(truth)
    }

    /// The options but for known positions.
    fn options<const D: usize>(&self) -> Result<CalibrateOptions<D>, Failure> {
        let arguments = self.arguments;
        let mut options = CalibrateOptions::new();
        if let Some(path) = &arguments.distances {
            options.distances = input::distances(path, self.measured.receiver_names())?;
        }
        options.receiver_delays = match arguments.receiver_delays {
            Delays::None | Delays::All => ReceiverDelays::None,
            Delays::Auto => ReceiverDelays::Auto,
        };
        let are_recorders = self.recordings.as_ref().is_some_and(Recordings::are_apart);
        options.clocks = arguments.clocks.clocks(arguments.sending, arguments.are_started_apart(), are_recorders);
        options.errors = match arguments.errors {
            Side::Auto => Errors::Auto,
            Side::Symmetric => Errors::Symmetric,
            Side::OneSided => Errors::OneSided,
        };
        options.estimate_speed = arguments.estimate_speed;
        options.sigma = arguments.sigma;
        options.seed = arguments.seed;
        options.search.max_starts = arguments.max_starts;
        options.search.agreeing = arguments.agreeing;
        options.search.min_starts = options.search.min_starts.min(arguments.max_starts);
        Ok(options)
    }

    /// Calibrates with a progress bar; an interrupt ends it.
    fn watched<T: Send>(&self, work: impl FnOnce(&Monitor) -> T + Send) -> Result<T, Failure> {
        let monitor = Monitor::heeding(interrupt::watch()?);
        let describe = || {
            let progress = monitor.progress();
            (progress.done, progress.total, progress.to_string())
        };
        cli::bar::while_shown(self.arguments.threads, describe, || work(&monitor))
    }

    fn failure<const D: usize>(&self, error: CalibrateError<D>) -> Failure
    where
        Unfinished<D>: Serialize,
    {
        match error {
            CalibrateError::Degenerate(_) | CalibrateError::NotFound(_) | CalibrateError::Clocks { .. } => {
                Failure::Undetermined(format!("{}: {error}", name(self.arguments.file())))
            }
            CalibrateError::Cancelled(Some(best)) => {
                partial::write(&best, self.measured, self.arguments.json.as_deref())
            }
            CalibrateError::Cancelled(None) => Failure::Interrupted,
            other => Failure::unusable(other),
        }
    }

    /// Where the result comes from, which took so long.
    fn provenance(&self, time: Duration) -> Provenance {
        let mut provenance = Provenance::default();
        provenance.program = Some(concat!("tdoa ", env!("CARGO_PKG_VERSION")).to_string());
        provenance.file = Some(name(self.arguments.file()));
        provenance.command = Some(provenance::command());
        provenance.settings = self.arguments.settings();
        provenance.dimensions = self.chosen.map(str::to_string);
        if let Some(date) = &self.date {
            provenance.date = Some(date.moment);
            provenance.time = Some(time).filter(|_| !date.fixed);
        }
        provenance
    }

    /// Compares a calibration with the truth, puts it in its frame, writes it and says what it is.
    fn finish<const D: usize>(
        &self,
        mut calibration: Calibration<D>,
        truth: Truth<D>,
        started: Instant,
    ) -> Result<(), Failure>
    where
        Calibration<D>: Serialize,
    {
        let (arguments, units) = (self.arguments, self.units);
        if let (Some(speed), Some(found)) = (units.speed(), &mut calibration.speed) {
            found.metres_per_second = Some(speed * found.factor);
        }
        let mut unit = Unit::new(units).map(|unit| unit.stretched(calibration.speed.map_or(1.0, |speed| speed.factor)));
        calibration.warnings.extend(truth.warnings);
        calibration.warnings.extend(doubt_of_units(&calibration).filter(|_| !self.said));
        if let Some(receivers) = &truth.receivers {
            calibration.compare_all(receivers, &truth.transmitters);
            if let Some(scale) = calibration.truth.as_ref().map(|found| found.scale).filter(|_| arguments.scale) {
                calibration.rescale(scale);
                unit = unit.map(|unit| unit.stretched(scale));
            }
            // Anchors and --frame are a frame that somebody wants.
            if arguments.anchors.is_none() && self.frame.is_none() {
                calibration.move_to_frame_of(receivers);
            }
        }
        if let Some(frame) = &self.frame {
            frame.apply(&mut calibration)?;
        }
        if let Some(path) = &arguments.svg {
            output::text(path, &picture(&calibration))?;
        }
        if let Some(path) = &arguments.html {
            let mut provenance = self.provenance(started.elapsed());
            if let (Some(recordings), Some(seconds)) = (&self.recordings, unit) {
                provenance.sections = sections(recordings, &expected(recordings, &calibration, seconds))?;
            }
            output::text(path, &html_with(&calibration, &provenance))?;
        }
        if let Some(path) = &arguments.nodes {
            output::text(path, &node_table(&calibration))?;
        }
        if let Some(path) = &arguments.json {
            output::json(path, &Report::new(&calibration, unit))?;
        }
        let context = Context { time: started.elapsed(), unit };
        let outputs = arguments.outputs().into_iter().filter_map(|(_, path)| path);
        output::summary(outputs, || summary::text(&calibration, &context))?;
        match calibration.distrust() {
            None => Ok(()),
            Some(why) => Err(Failure::Undetermined(format!(
                "{}: {why} (see the warnings); the network is not to be trusted",
                name(arguments.file())
            ))),
        }
    }
}

/// When the network has each event arrive at each channel of recordings.
fn expected<const D: usize>(
    recordings: &Recordings,
    calibration: &Calibration<D>,
    seconds: Unit,
) -> Vec<Vec<Option<Expected>>> {
    let places = |names: &[String]| -> HashMap<String, usize> {
        names.iter().enumerate().map(|(place, name)| (name.clone(), place)).collect()
    };
    let (receivers, transmitters) = (places(&calibration.receiver_names), places(&calibration.transmitter_names));
    let arrival = |event: usize, name: &String, arrival: &Option<Arrival>| {
        let (i, j) = (*receivers.get(name)?, *transmitters.get(&(event + 1).to_string())?);
        let residual = calibration.residuals.get(i, j)?;
        Some(Expected { seconds: arrival.as_ref()?.seconds - seconds.of(residual.length), is_used: residual.inlier })
    };
    let names = recordings.heard.names();
    let of_event = |(event, arrivals): (usize, &Vec<Option<Arrival>>)| {
        names.iter().zip(arrivals).map(|(name, found)| arrival(event, name, found)).collect()
    };
    recordings.heard.arrivals.iter().enumerate().map(of_event).collect()
}

/// Writes notes to the error output.
fn tell(notes: &[String]) {
    for note in notes {
        eprintln!("note: {note}");
    }
}
