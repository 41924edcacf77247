//! `tdoa calibrate`.

use std::path::PathBuf;
use std::time::Instant;

use serde::Serialize;
use tdoa::html::html;
use tdoa::node_table::node_table;
use tdoa::picture::picture;
use tdoa::read::{read, read_distances};
use tdoa::summary::doubt_of_units;
use tdoa::{CalibrateError, CalibrateOptions, Calibration, Errors, Monitor, ReceiverDelays, calibrate_with};

use crate::frame::Frame;
use crate::known::{Truth, anchors};
use crate::partial;
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
    /// Fits a common scale when comparing with --truth and presents the network with it (the
    /// propagation speed is then wrong by that factor).
    #[arg(long)]
    scale: bool,
    /// Known positions of some receivers (columns name, x and y in any order, metres): they fix the
    /// frame, and two or more are held there, which sharpens the rest. With a column sigma (or std_x
    /// and std_y) they are measurements with that standard deviation, exact where it is 0; x or y
    /// may be empty.
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
    /// Puts the node ORIGIN at (0, 0), XAXIS on the positive x axis and UP above it.
    #[arg(long, value_name = "ORIGIN,XAXIS,UP")]
    frame: Option<String>,
    /// True positions of receivers (columns name, x and y, or rgt in a .mat file) to compare with:
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
    #[arg(long, default_value_t = CalibrateOptions::default().max_starts)]
    max_starts: usize,
    /// Starts that must have found the best network before the search ends: more for more
    /// certainty.
    #[arg(long, default_value_t = CalibrateOptions::default().agreeing)]
    agreeing: usize,
    /// Writes the result as JSON; - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Writes a picture of the network.
    #[arg(long)]
    svg: Option<PathBuf>,
    /// Writes a report for a browser and for paper: the picture, and tables of nodes and
    /// measurements that sort by a click. One file, without references to others.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Writes the nodes as a CSV table: kind, name, position, standard deviations, offset, numbers
    /// of measurements.
    #[arg(long, value_name = "FILE.csv")]
    nodes: Option<PathBuf>,
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

/// The JSON form: offsets in the unit of the input too, where that is not the metre.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    calibration: &'a Calibration,
    #[serde(skip_serializing_if = "Option::is_none")]
    units: Option<Unit>,
    #[serde(skip_serializing_if = "Option::is_none")]
    offsets_in_units: Option<Vec<Option<f64>>>,
}

impl Report<'_> {
    fn new(calibration: &Calibration, units: Option<Unit>) -> Report<'_> {
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
    let input = arguments.input.options(arguments.estimate_speed)?;
    let (units, said) = (input.units.unwrap_or_default(), input.units.is_some());
    let measured = read(&arguments.file, input).map_err(Failure::unusable)?;
    let truth = Truth::read(arguments.truth.as_deref(), &arguments.file, &measured)?;
    if arguments.scale && truth.receivers.is_none() {
        return Err(Failure::Unusable("--scale needs --truth with the true positions".to_string()));
    }
    let frame = arguments.frame.as_deref().map(|text| Frame::parse(text, &measured)).transpose()?;
    let mut notes = truth.notes;
    let mut options = CalibrateOptions::default();
    if let Some(path) = &arguments.anchors {
        let known = anchors(path, &measured)?;
        (options.anchors, options.positions) = (known.exact, known.measured);
        notes.extend(known.note);
    }
    if let Some(path) = &arguments.distances {
        options.distances = read_distances(path, measured.receiver_names()).map_err(Failure::unusable)?;
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
    options.max_starts = arguments.max_starts;
    options.agreeing = arguments.agreeing;
    options.min_starts = options.min_starts.min(arguments.max_starts);
    for note in notes {
        eprintln!("note: {note}");
    }

    let monitor = Monitor::heeding(interrupt::watch()?);
    let started = Instant::now();
    let describe = || {
        let progress = monitor.progress();
        (progress.done, progress.total, progress.to_string())
    };
    let solved =
        cli::bar::while_shown(arguments.threads, describe, || calibrate_with(&measured, &options, &[], &monitor))?;
    let mut calibration = solved.map_err(|error| match error {
        CalibrateError::Degenerate(_) | CalibrateError::NotFound(_) | CalibrateError::Delays { .. } => {
            Failure::Undetermined(format!("{}: {error}", arguments.file.display()))
        }
        CalibrateError::Cancelled(Some(best)) => partial::write(&best, &measured, arguments.json.as_deref()),
        CalibrateError::Cancelled(None) => Failure::Interrupted,
        other => Failure::unusable(other),
    })?;
    if let (Some(speed), Some(found)) = (units.speed(), &mut calibration.speed) {
        found.metres_per_second = Some(speed * found.factor);
    }
    let mut unit = Unit::new(units).map(|unit| unit.stretched(calibration.speed.map_or(1.0, |speed| speed.factor)));
    calibration.warnings.extend(truth.warnings);
    calibration.warnings.extend(doubt_of_units(&calibration).filter(|_| !said));
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
        output::file(path, html(&calibration).as_bytes())?;
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
