//! `tdoa calibrate`.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::Serialize;
use tdoa::calibrate::{Calibrated, CalibratedError, Calibrates, Dimension, calibrate_either};
use tdoa::html::{Provenance, html_with};
use tdoa::node_table::node_table;
use tdoa::picture::picture;
use tdoa::read::{Nodes, Units, read, read_distances, read_nodes};
use tdoa::summary::doubt_of_units;
use tdoa::{
    CalibrateError, CalibrateOptions, Calibration, Errors, Monitor, Pseudoranges, ReceiverDelays, Unfinished,
    calibrate_with,
};

use crate::frame::{self, Frame};
use crate::known::{self, Truth};
use crate::partial;
use crate::provenance::{self, named, said};
use crate::summary::{self, Context};
use crate::units::Unit;
use crate::{Failure, interrupt, output};

/// Finds positions and offsets of a whole network from its pseudoranges.
///
/// FILE is a CSV matrix (receivers in rows, transmitters in columns, empty or nan where nothing was
/// measured, optionally with names in the first line and the first column), a CSV list with one
/// measurement a line below a header that names the columns receiver (or mic, anchor, sensor),
/// transmitter (or event, source, tag), value (or time, toa, range) and, if wanted, sigma, in any
/// order, a .npy array, or a .mat file with the matrix z (or --variable) and, as truth, the
/// positions rgt. Cells stand between commas, semicolons, tabs or blanks; with any but commas,
/// numbers may have decimal commas.
///
/// Interrupted, it writes the best network so far as JSON marked "unfinished", with exit status 130.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The measurements.
    file: PathBuf,
    #[command(flatten)]
    input: crate::units::InputArguments,
    /// Standard deviation of the measurements in metres; estimated if not given.
    #[arg(long, allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// Whether the network is sought in the plane or in space. `auto`: in space where anchors have
    /// different heights or --frame names four nodes; without these, where the measurements support a
    /// third coordinate (likelihood ratio), and says so.
    #[arg(long, value_enum, default_value = "auto")]
    dimensions: Dimensions,
    /// Fits a common scale when comparing with --truth and presents the network with it (the
    /// propagation speed is then wrong by that factor).
    #[arg(long)]
    scale: bool,
    /// Known positions of some receivers (columns name, x, y and, in space, z in any order, metres):
    /// they fix the frame, and two or more (three) are held there, which sharpens the rest. With a
    /// column sigma (or std_x and std_y, std_z) they are measurements with that standard deviation,
    /// exact where it is 0; coordinates may be empty.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["frame", "scale"])]
    anchors: Option<PathBuf>,
    /// What is done about receivers whose measurements are all too long or too short, as by a
    /// cable: told (none), estimated for those that show it (auto; drifting and jumping clocks and
    /// moved receivers too), or estimated for all, as where clocks were started apart (all).
    #[arg(long, value_enum, default_value = "none")]
    receiver_delays: Delays,
    /// How measurements are wrong that are wrong by more than noise: too long or too short alike
    /// (symmetric), or nearly all too long, as where sound or radio comes by a detour (one-sided).
    #[arg(long, value_enum, default_value = "symmetric")]
    errors: Side,
    /// Known distances between some receivers (receiver,receiver,distance, metres), for
    /// --estimate-speed.
    #[arg(long, value_name = "FILE.csv", requires = "estimate_speed")]
    distances: Option<PathBuf>,
    /// Estimates the propagation speed from the known distances and those between anchors: with
    /// --units s, ms, us, ns or samples in metres a second (only --sigma depends on --speed then),
    /// otherwise as a factor on the one that made the measurements metres.
    #[arg(long)]
    estimate_speed: bool,
    /// Puts the node ORIGIN at (0, 0), XAXIS on the positive x axis and UP above it; in space
    /// ORIGIN,XAXIS,YSIDE,UP, with YSIDE in the plane of x and y.
    #[arg(long, value_name = "ORIGIN,XAXIS,UP")]
    frame: Option<String>,
    /// True positions of receivers (columns name, x, y and, in space, z, or rgt in a .mat file) to compare with:
    /// by name, or in the order of the receivers where one side has no names.
    #[arg(long, value_name = "RECEIVERS.csv")]
    truth: Option<PathBuf>,
    /// Seed of the search.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; all cores if not given. The result does not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Most starts of the search.
    #[arg(long, default_value_t = CalibrateOptions::default().search.max_starts)]
    max_starts: usize,
    /// Starts that must have found the best network before the search ends: more for more
    /// certainty.
    #[arg(long, default_value_t = CalibrateOptions::default().search.agreeing)]
    agreeing: usize,
    /// Writes the result as JSON; - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Writes a picture of the network.
    #[arg(long)]
    svg: Option<PathBuf>,
    /// Writes a report for a browser and for paper: the picture, tables of nodes and measurements that
    /// sort by a click, and where they come from. One file, without references to others. Where
    /// SOURCE_DATE_EPOCH is set, its date is that one and no time is told: the same bytes each time.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Writes the nodes as a CSV table: kind, name, position, standard deviations, offset, numbers
    /// of measurements.
    #[arg(long, value_name = "FILE.csv")]
    nodes: Option<PathBuf>,
}

/// Where the network is sought.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Dimensions {
    #[value(name = "2")]
    Plane,
    #[value(name = "3")]
    Space,
    Auto,
}

/// What is done about errors of whole receivers.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Delays {
    None,
    Auto,
    All,
}

/// The side to which measurements are wrong.
#[derive(Clone, Copy, clap::ValueEnum)]
enum Side {
    Symmetric,
    OneSided,
}

impl Arguments {
    /// Names and values of the options that shape the result: those that have a value, by default too.
    fn settings(&self) -> Vec<(String, String)> {
        let path = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        let switch = |given: bool| given.then_some("yes");
        let own = [
            named("dimensions", Some(said(self.dimensions))),
            named("sigma", self.sigma),
            named("anchors", path(&self.anchors)),
            named("receiver-delays", Some(said(self.receiver_delays))),
            named("errors", Some(said(self.errors))),
            named("distances", path(&self.distances)),
            named("estimate-speed", switch(self.estimate_speed)),
            named("frame", self.frame.as_ref()),
            named("truth", path(&self.truth)),
            named("scale", switch(self.scale)),
            named("seed", Some(self.seed)),
            named("max-starts", Some(self.max_starts)),
            named("agreeing", Some(self.agreeing)),
        ];
        self.input.settings().into_iter().chain(own.into_iter().flatten()).collect()
    }
}

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
    output::check(&[
        ("--json", arguments.json.as_deref()),
        ("--svg", arguments.svg.as_deref()),
        ("--html", arguments.html.as_deref()),
        ("--nodes", arguments.nodes.as_deref()),
    ])?;
    let date = arguments.html.as_ref().map(|_| provenance::Date::read()).transpose()?;
    let input = arguments.input.options(arguments.estimate_speed)?;
    let (units, said) = (input.units.unwrap_or_default(), input.units.is_some());
    let measured = read(&arguments.file, input).map_err(Failure::unusable)?;
    let anchors = match &arguments.anchors {
        Some(path) => Some((path.as_path(), read_nodes(path).map_err(Failure::unusable)?)),
        None => None,
    };
    let given = match (arguments.dimensions, &anchors, &arguments.frame) {
        (Dimensions::Plane, ..) => Some((2, "as --dimensions says")),
        (Dimensions::Space, ..) => Some((3, "as --dimensions says")),
        (Dimensions::Auto, Some((_, nodes)), _) => Some((nodes.dimensions(), "as the anchors have it")),
        (Dimensions::Auto, None, Some(names)) => Some((frame::dimensions(names), "as --frame has it")),
        (Dimensions::Auto, None, None) => None,
    };
    let chosen = given.map(|(_, by)| by);
    let task = Task { arguments, measured: &measured, units, said, date, chosen };
    match given.map(|(dimensions, _)| dimensions) {
        Some(3) => task.given::<3>(anchors),
        Some(_) => task.given::<2>(anchors),
        None => task.chosen(),
    }
}

/// What is to be calibrated, and how.
struct Task<'a> {
    arguments: &'a Arguments,
    measured: &'a Pseudoranges,
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
        let frame = self.frame::<D>()?;
        let mut options = self.options::<D>()?;
        if let Some((path, nodes)) = anchors {
            let known = known::anchors(path, &nodes, self.measured)?;
            (options.anchors, options.positions) = (known.exact, known.measured);
            truth.notes.extend(known.note);
        }
        tell(&truth.notes);
        let started = Instant::now();
        let solved = self.watched(|monitor| calibrate_with(self.measured, &options, &[], monitor))?;
        let calibration = solved.map_err(|error| self.failure(error))?;
        self.finish(calibration, truth, frame, started)
    }

    /// Calibrates in the plane or in space, as the measurements have it.
    fn chosen(&self) -> Result<(), Failure> {
        let truth = self.truth::<2>()?;
        let options = self.options::<3>()?;
        let started = Instant::now();
        let solved = self.watched(|monitor| calibrate_either(self.measured, &options, monitor))?;
        match solved {
            Ok(Calibrated::Plane(calibration)) => {
                tell(&truth.notes);
                self.finish(calibration, truth, None, started)
            }
            Ok(Calibrated::Space(calibration)) => {
                let truth = self.truth::<3>().unwrap_or_else(|failure| Truth {
                    warnings: vec![format!("nothing is compared with the truth: {failure}")],
                    ..Truth::default()
                });
                tell(&truth.notes);
                self.finish(calibration, truth, None, started)
            }
            Err(CalibratedError::Plane(error)) => Err(self.failure(error)),
            Err(CalibratedError::Space(error)) => Err(self.failure(error)),
        }
    }

    fn truth<const D: usize>(&self) -> Result<Truth<D>, Failure> {
        let truth = Truth::read(self.arguments.truth.as_deref(), &self.arguments.file, self.measured)?;
        if self.arguments.scale && truth.receivers.is_none() {
            return Err(Failure::Unusable("--scale needs --truth with the true positions".to_string()));
        }
        Ok(truth)
    }

    fn frame<const D: usize>(&self) -> Result<Option<Frame<D>>, Failure> {
        self.arguments.frame.as_deref().map(|text| Frame::parse(text, self.measured)).transpose()
    }

    /// The options but for known positions.
    fn options<const D: usize>(&self) -> Result<CalibrateOptions<D>, Failure> {
        let arguments = self.arguments;
        let mut options = CalibrateOptions::new();
        if let Some(path) = &arguments.distances {
            options.distances = read_distances(path, self.measured.receiver_names()).map_err(Failure::unusable)?;
        }
        options.receiver_delays = match arguments.receiver_delays {
            Delays::None => ReceiverDelays::None,
            Delays::Auto => ReceiverDelays::Auto,
            Delays::All => ReceiverDelays::All,
        };
        options.errors = match arguments.errors {
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
            CalibrateError::Degenerate(_) | CalibrateError::NotFound(_) | CalibrateError::Delays { .. } => {
                Failure::Undetermined(format!("{}: {error}", self.arguments.file.display()))
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
        provenance.file = Some(self.arguments.file.display().to_string());
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
        frame: Option<Frame<D>>,
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
        }
        if let Some(frame) = frame {
            frame.apply(&mut calibration)?;
        }
        if let Some(path) = &arguments.svg {
            output::file(path, picture(&calibration).as_bytes())?;
        }
        if let Some(path) = &arguments.html {
            output::file(path, html_with(&calibration, &self.provenance(started.elapsed())).as_bytes())?;
        }
        if let Some(path) = &arguments.nodes {
            output::file(path, node_table(&calibration).as_bytes())?;
        }
        if let Some(path) = &arguments.json {
            output::json(path, &Report::new(&calibration, unit))?;
        }
        let context = Context { time: started.elapsed(), unit };
        output::summary(arguments.json.as_deref(), || summary::text(&calibration, &context))?;
        match calibration.distrust() {
            None => Ok(()),
            Some(why) => Err(Failure::Undetermined(format!(
                "{}: {why} (see the warnings); the network is not to be trusted",
                arguments.file.display()
            ))),
        }
    }
}

/// Writes notes to the error output.
fn tell(notes: &[String]) {
    for note in notes {
        eprintln!("note: {note}");
    }
}
