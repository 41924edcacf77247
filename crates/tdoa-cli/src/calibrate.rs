//! `tdoa calibrate`.

use std::path::PathBuf;
use std::time::Instant;

use tdoa::align::frame;
use tdoa::html::html;
use tdoa::node_table::node_table;
use tdoa::picture::picture;
use tdoa::read::{Units, is_mat, read, read_distances, read_mat_nodes, read_mat_transmitters, read_nodes};
use tdoa::{CalibrateError, CalibrateOptions, Calibration, Monitor, Pseudoranges, ReceiverDelays, calibrate_with};

use crate::{Failure, interrupt, output, summary};

/// Finds positions and offsets of a whole network from its pseudoranges.
///
/// FILE is a CSV matrix (receivers in rows, transmitters in columns, empty or nan where nothing was measured, optionally a
/// first line with the transmitters' names), a CSV list with the header `receiver,transmitter,value[,sigma]`, a .npy array, or a .mat
/// file with the matrix z and, as truth, the positions rgt.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The measurements.
    file: PathBuf,
    #[command(flatten)]
    units: crate::units::UnitArguments,
    /// Standard deviation of the measurements in metres; estimated if not given.
    #[arg(long, allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// Fits a common scale when comparing with --truth and presents the network with it (the propagation speed is then
    /// wrong by that factor).
    #[arg(long)]
    scale: bool,
    /// Known positions of some receivers (name,x,y, metres): they fix the frame, and two or more are held there, which
    /// sharpens the rest.
    #[arg(long, value_name = "FILE.csv", conflicts_with_all = ["frame", "scale"])]
    anchors: Option<PathBuf>,
    /// What is done about receivers whose measurements are all too long or too short, as by a cable: told (none), estimated for those that show
    /// it (auto; drifting and jumping clocks and moved receivers too), or estimated for all, as where clocks were started apart (all).
    #[arg(long, value_enum, default_value = "none")]
    receiver_delays: Delays,
    /// Known distances between some receivers (receiver,receiver,distance, metres), for --estimate-speed.
    #[arg(long, value_name = "FILE.csv", requires = "estimate_speed")]
    distances: Option<PathBuf>,
    /// Estimates the propagation speed from the known distances and those between anchors: with --units s in metres a second
    /// (only --sigma depends on --speed then), otherwise as a factor on the one that made the measurements metres.
    #[arg(long)]
    estimate_speed: bool,
    /// Puts the node ORIGIN at (0, 0), XAXIS on the positive x axis and UP above it.
    #[arg(long, value_name = "ORIGIN,XAXIS,UP")]
    frame: Option<String>,
    /// True positions of receivers (id,x,y, or rgt in a .mat file) to compare with.
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
    /// Starts that must have found the best network before the search ends: more for more certainty.
    #[arg(long, default_value_t = CalibrateOptions::default().agreeing)]
    agreeing: usize,
    /// Writes the result as JSON; - for standard output instead of the summary.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Writes a picture of the network.
    #[arg(long)]
    svg: Option<PathBuf>,
    /// Writes a report for a browser and for paper: the picture, and tables of nodes and measurements that sort by a click.
    /// One file, without references to others.
    #[arg(long)]
    html: Option<PathBuf>,
    /// Writes the nodes as a CSV table: kind, name, position, standard deviations, offset, numbers of measurements.
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

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let units = arguments.units.units(arguments.estimate_speed)?;
    let measured = read(&arguments.file, units).map_err(Failure::unusable)?;
    let mut remark = None;
    let truth = arguments.truth.as_deref().map(|path| true_positions(path, &measured, &mut remark)).transpose()?;
    let truth_file = arguments.truth.as_deref().unwrap_or(&arguments.file);
    let transmitters = if is_mat(truth_file) { true_transmitters(truth_file, &measured)? } else { Vec::new() };
    let truth = match truth {
        None if is_mat(&arguments.file) => truth_inside(&arguments.file, &measured)?,
        given => given,
    };
    if arguments.scale && truth.is_none() {
        return Err(Failure::Unusable("--scale needs --truth with the true positions".to_string()));
    }
    let frame = arguments.frame.as_deref().map(|text| frame_nodes(text, &measured)).transpose()?;
    let mut options = CalibrateOptions::default();
    if let Some(path) = &arguments.anchors {
        options.anchors = anchors(path, &measured)?;
    }
    if let Some(path) = &arguments.distances {
        options.distances = read_distances(path, measured.receiver_names()).map_err(Failure::unusable)?;
    }
    options.receiver_delays = match arguments.receiver_delays {
        Delays::None => ReceiverDelays::None,
        Delays::Auto => ReceiverDelays::Auto,
        Delays::All => ReceiverDelays::All,
    };
    options.estimate_speed = arguments.estimate_speed;
    options.sigma = arguments.sigma;
    options.seed = arguments.seed;
    options.max_starts = arguments.max_starts;
    options.agreeing = arguments.agreeing;
    options.min_starts = options.min_starts.min(arguments.max_starts);

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
        CalibrateError::Cancelled => Failure::Interrupted,
        other => Failure::unusable(other),
    })?;
    if let (Units::Seconds { speed }, Some(found)) = (units, &mut calibration.speed) {
        found.metres_per_second = Some(speed * found.factor);
    }
    calibration.warnings.extend(remark);
    if let Some(truth) = &truth {
        calibration.compare_all(truth, &transmitters);
        if let Some(found) = calibration.truth.as_ref().filter(|_| arguments.scale) {
            calibration.rescale(found.scale);
        }
    }
    if let Some(nodes) = frame {
        put_in_frame(&mut calibration, nodes)?;
    }
    interrupt::check()?;
    if let Some(path) = &arguments.svg {
        output::write(path, picture(&calibration).as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        output::write(path, html(&calibration).as_bytes())?;
    }
    if let Some(path) = &arguments.nodes {
        output::write(path, node_table(&calibration).as_bytes())?;
    }
    if let Some(path) = &arguments.json {
        output::json(path, &calibration)?;
    }
    output::summary(arguments.json.as_deref(), || summary::text(&calibration, started.elapsed()))?;
    match calibration.distrust() {
        None => Ok(()),
        Some(why) => Err(Failure::Undetermined(format!(
            "{}: {why} (see the warnings); the network is not to be trusted",
            arguments.file.display()
        ))),
    }
}

/// The truth that a .mat file holds beside the measurements, if it does.
fn truth_inside(path: &std::path::Path, measured: &Pseudoranges) -> Result<Option<Vec<Option<[f64; 2]>>>, Failure> {
    let nodes = read_mat_nodes(path).map_err(Failure::unusable)?;
    Ok(nodes.and_then(|nodes| nodes.in_order(measured.receiver_names())))
}

/// The true transmitters of a .mat file, where it has as many as there are transmitters; else none.
fn true_transmitters(path: &std::path::Path, measured: &Pseudoranges) -> Result<Vec<Option<[f64; 2]>>, Failure> {
    let all = read_mat_transmitters(path).map_err(Failure::unusable)?.unwrap_or_default();
    Ok(if all.len() == measured.transmitters() { all } else { Vec::new() })
}

/// The true receivers in the order of the receivers, with a remark if no name told which is which.
fn true_positions(
    path: &std::path::Path,
    measured: &Pseudoranges,
    remark: &mut Option<String>,
) -> Result<Vec<Option<[f64; 2]>>, Failure> {
    let nodes = read_nodes(path).map_err(Failure::unusable)?;
    if nodes.names.is_some() && !nodes.names_any(measured.receiver_names()) {
        *remark = Some(format!(
            "{}: no name in common with the receivers, so that its positions were taken in the order of the receivers",
            path.display()
        ));
    }
    let found = nodes.in_order(measured.receiver_names()).ok_or_else(|| {
        Failure::Unusable(format!(
            "{}: has {} positions for {} receivers, and no name in common; give one line id,x,y for each receiver, in order \
             or with its name",
            path.display(),
            nodes.positions.len(),
            measured.receivers()
        ))
    })?;
    if found.iter().flatten().count() < 2 {
        return Err(Failure::Unusable(format!("{}: fewer than two receivers are known by name", path.display())));
    }
    Ok(found)
}

/// Known positions in the order of the receivers. A name that no receiver has is more likely a mistake than meant.
fn anchors(path: &std::path::Path, measured: &Pseudoranges) -> Result<Vec<Option<[f64; 2]>>, Failure> {
    let nodes = read_nodes(path).map_err(Failure::unusable)?;
    let receivers = measured.receiver_names();
    let unusable = |problem: String| Failure::Unusable(format!("{}: {problem}", path.display()));
    let Some(names) = &nodes.names else {
        return Err(unusable("names no receivers; expected lines name,x,y".to_string()));
    };
    let mut positions = vec![None; receivers.len()];
    for (name, position) in names.iter().zip(&nodes.positions) {
        let place = receivers.iter().position(|receiver| receiver == name);
        let place = place.ok_or_else(|| {
            unusable(format!(
                "no receiver is named {name:?}; they are {}, ...",
                receivers[..receivers.len().min(3)].join(", ")
            ))
        })?;
        if positions[place].replace(*position).is_some() {
            return Err(unusable(format!("receiver {name} is there twice; keep one position")));
        }
    }
    Ok(positions)
}

/// A node by its place among the receivers or the transmitters.
#[derive(Clone, Copy)]
enum Node {
    Receiver(usize),
    Transmitter(usize),
}

fn frame_nodes(text: &str, measured: &Pseudoranges) -> Result<[Node; 3], Failure> {
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    let &[origin, x_axis, up] = names.as_slice() else {
        return Err(Failure::Unusable(format!("--frame needs three names of nodes, ORIGIN,XAXIS,UP, not {text:?}")));
    };
    let find = |name: &str| -> Result<Node, Failure> {
        let place = |names: &[String]| names.iter().position(|other| other == name);
        place(measured.receiver_names())
            .map(Node::Receiver)
            .or_else(|| place(measured.transmitter_names()).map(Node::Transmitter))
            .ok_or_else(|| {
                Failure::Unusable(format!(
                    "--frame: no node is named {name:?}; receivers are {}, ..., transmitters {}, ...",
                    measured.receiver_names()[0],
                    measured.transmitter_names()[0]
                ))
            })
    };
    Ok([find(origin)?, find(x_axis)?, find(up)?])
}

fn put_in_frame(calibration: &mut Calibration, nodes: [Node; 3]) -> Result<(), Failure> {
    let position = |node: Node| match node {
        Node::Receiver(i) => calibration.receivers[i],
        Node::Transmitter(j) => calibration.transmitters[j],
    };
    let [a, b, c] = nodes.map(position);
    let (Some(a), Some(b), Some(c)) = (a, b, c) else {
        return Err(Failure::Undetermined("--frame: a node of the frame could not be located".to_string()));
    };
    let map = frame(a, b, c).ok_or_else(|| {
        Failure::Undetermined("--frame: the three nodes lie in one line or in one place; choose others".to_string())
    })?;
    calibration.transform(&map);
    Ok(())
}
