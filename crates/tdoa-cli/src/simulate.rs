//! `tdoa simulate`.

use std::path::PathBuf;

use cli::files::check_directory;
use tdoa::{Layout, Pseudoranges, ReceiverFault, SimulateOptions, simulate};

use crate::Failure;
use crate::clocks::EmissionArguments;
use crate::output;
use crate::units::{Unit, UnitArguments};

/// Makes a random network and its measurements: pseudoranges.csv, receivers.csv, transmitters.csv, offsets.csv and,
/// where receivers have clocks of their own, clocks.csv.
///
/// Lengths are metres; --units gives pseudoranges.csv in another unit, and offsets.csv a column in
/// it.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// Number of receivers.
    #[arg(long, default_value_t = 8)]
    receivers: usize,
    /// Number of transmitters.
    #[arg(long, default_value_t = 12)]
    transmitters: usize,
    /// Standard deviation of the noise, metres.
    #[arg(long, default_value_t = 0.0)]
    noise: f64,
    /// Share of outliers among the measurements, 0 to 1; their number is rounded.
    #[arg(long, default_value_t = 0.0)]
    outliers: f64,
    /// Largest error of an outlier, metres.
    #[arg(long, default_value_t = 10.0)]
    outlier_size: f64,
    /// Share of missing measurements, 0 to 1; their number is rounded.
    #[arg(long, default_value_t = 0.0)]
    missing: f64,
    /// Whether the network is in the plane or in space; by default what --layout says, else the
    /// plane.
    #[arg(long, value_name = "2|3", value_parser = clap::value_parser!(u8).range(2..=3))]
    dimensions: Option<u8>,
    /// Positions uniform in a room of WIDTHxHEIGHT metres, in space of LENGTHxWIDTHxHEIGHT, or
    /// `normal` for standard normal positions and offsets. 10x10 by default, in space 10x10x3.
    #[arg(long)]
    layout: Option<String>,
    /// How receivers stand in the room: anywhere, one after the other along its first side, or at
    /// the points of a grid over its first two.
    #[arg(long, value_enum, default_value = "anywhere")]
    shape: Shape,
    /// Each transmitter is heard by this many receivers, the nearest ones; by all if not given.
    #[arg(long, value_name = "RECEIVERS")]
    hearing: Option<usize>,
    /// Share of measurements that come by a detour, 0 to 1; their number is rounded.
    #[arg(long, default_value_t = 0.0)]
    detours: f64,
    /// Mean length of a detour, metres; lengths are exponentially distributed.
    #[arg(long, default_value_t = 1.0)]
    detour_size: f64,
    /// Candidates of each measurement, as of a detector that finds several peaks: further ones are late by --detour-size
    /// in the mean, but the second of outliers and detours is the right one. With 2 or more, pseudoranges.csv is a list
    /// with the columns value, value2, ...
    #[arg(long, default_value_t = 1)]
    candidates: usize,
    /// An error of the first receiver in all its measurements: `delay=METRES`, `drift=METRES` from
    /// the first transmitter to the last one, or `move=METRES` after half of the transmitters.
    #[arg(long, value_name = "KIND=METRES")]
    fault: Option<String>,
    /// Standard deviation of a constant delay of each recorder, metres: of its clock's offset.
    #[arg(long, default_value_t = 0.0)]
    delays: f64,
    /// Standard deviation of the rates of the recorders' clocks, millionths.
    #[arg(long, value_name = "PPM", default_value_t = 0.0)]
    rate_sigma: f64,
    /// Receivers that share a recorder, and so a clock.
    #[arg(long, default_value_t = 1)]
    channels: usize,
    /// Has transmitters send at times that are uniform over this, metres: seconds times the speed.
    #[arg(long, value_name = "METRES")]
    duration: Option<f64>,
    #[command(flatten)]
    sending: EmissionArguments,
    /// Seed of the random numbers.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Threads; accepted everywhere, simulation needs only one.
    #[arg(long)]
    threads: Option<usize>,
    #[command(flatten)]
    units: UnitArguments,
    /// Directory for the files; made if it is not there.
    #[arg(long)]
    output: PathBuf,
    /// Replaces the files if they are in the directory already.
    #[arg(long)]
    force: bool,
}

/// How receivers stand in the room.
#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Shape {
    Anywhere,
    Chain,
    Grid,
}

/// What is written; the last one where receivers have clocks of their own.
const FILES: [&str; 5] = ["pseudoranges.csv", "receivers.csv", "transmitters.csv", "offsets.csv", "clocks.csv"];

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    check_directory(&arguments.output, &FILES, arguments.force)?;
    let sides = arguments.layout.as_deref().and_then(sides);
    match (sides.map(|sides| sides.len()), arguments.dimensions) {
        (None | Some(3), Some(3)) | (Some(3), None) => make::<3>(arguments),
        (Some(3), Some(_)) => Err(contradiction("three sides", "3")),
        (Some(2), Some(3)) => Err(contradiction("two sides", "2")),
        _ => make::<2>(arguments),
    }
}

fn contradiction(has: &str, dimensions: &str) -> Failure {
    Failure::Unusable(format!(
        "--layout has {has}, which is --dimensions {dimensions}; change one of them, or leave out --dimensions"
    ))
}

/// Makes a network of `D` dimensions and its files.
fn make<const D: usize>(arguments: &Arguments) -> Result<(), Failure> {
    let mut options = SimulateOptions::<D>::new();
    options.receivers = arguments.receivers;
    options.transmitters = arguments.transmitters;
    options.noise = arguments.noise;
    options.outliers = arguments.outliers;
    options.outlier_size = arguments.outlier_size;
    options.missing = arguments.missing;
    options.layout = layout(arguments.layout.as_deref(), arguments.shape)?;
    options.hearing = arguments.hearing;
    options.detours = arguments.detours;
    options.detour_size = arguments.detour_size;
    options.candidates = arguments.candidates;
    options.fault = arguments.fault.as_deref().map(fault).transpose()?;
    options.delays = arguments.delays;
    options.rates = 1e-6 * arguments.rate_sigma;
    options.channels = arguments.channels;
    options.duration = arguments.duration;
    options.emissions = arguments.sending.emissions();
    options.seed = arguments.seed;
    let unit = unit_of(&arguments.units)?;
    let simulation = crate::on_threads(arguments.threads, || simulate(&options))?.map_err(Failure::unusable)?;
    let measured = &simulation.pseudoranges;

    let directory = &arguments.output;
    std::fs::create_dir_all(directory).map_err(|error| {
        Failure::Unusable(format!("{}: cannot be made ({error}); choose another --output", directory.display()))
    })?;
    // A micrometre is finer than any measurement, but tests of exact data want all digits.
    let digits = unit.map_or(6, |unit| unit.decimals(6));
    let cell = |value: Option<f64>| match value.map(|value| unit.map_or(value, |unit| unit.of(value))) {
        Some(value) if arguments.noise > 0.0 => format!(",{value:.digits$}"),
        Some(value) => format!(",{value}"),
        None => ",".to_string(),
    };
    let table = if arguments.candidates > 1 { list(measured, cell) } else { matrix(measured, cell) };
    let network = &simulation.network;
    let receivers = positions(measured.receiver_names(), &network.receivers);
    let transmitters = positions(measured.transmitter_names(), &network.transmitters);
    let rows = measured.transmitter_names().iter().zip(&network.offsets);
    let in_unit = |offset: f64| unit.map_or_else(String::new, |unit| format!(",{}", unit.of(offset)));
    let offsets: String = rows.map(|(name, offset)| format!("{name},{offset}{}\n", in_unit(*offset))).collect();
    let heading = unit.map_or_else(String::new, |unit| format!(",offset_{}", unit.name));
    let offsets = format!("id,offset{heading}\n{offsets}");
    let clocks = measured.receiver_names().iter().zip(&simulation.clocks);
    let clocks: String = clocks.map(|(name, [offset, rate])| format!("{name},{offset},{rate}\n")).collect();
    let clocks = format!("receiver,offset,rate\n{clocks}");
    let with_clocks = simulation.clocks.iter().flatten().any(|x| *x != 0.0);
    let all = [table, receivers, transmitters, offsets].into_iter().chain(with_clocks.then_some(clocks));
    for (name, text) in FILES.iter().zip(all) {
        output::file(&directory.join(name), text.as_bytes())?;
    }

    let outliers: Vec<String> = (0..simulation.outliers.len())
        .filter(|&k| simulation.outliers[k])
        .map(|k| {
            let (i, j) = (k / measured.transmitters(), k % measured.transmitters());
            format!("{}-{}", measured.receiver_names()[i], measured.transmitter_names()[j])
        })
        .collect();
    let mut text = format!(
        "{} with {} of {} cells measured, written to {}\n",
        measured.configuration(),
        measured.observed(),
        measured.receivers() * measured.transmitters(),
        directory.display()
    );
    if !outliers.is_empty() {
        text += &format!("outliers: {}\n", outliers.join(" "));
    }
    output::print(&text)
}

/// A matrix, with receivers in rows.
fn matrix(measured: &Pseudoranges, cell: impl Fn(Option<f64>) -> String) -> String {
    let mut table = format!("receiver,{}\n", measured.transmitter_names().join(","));
    for (i, name) in measured.receiver_names().iter().enumerate() {
        table += name;
        (0..measured.transmitters()).for_each(|j| table += &cell(measured.get(i, j)));
        table += "\n";
    }
    table
}

/// A list of one measurement a line, with further candidates.
fn list(measured: &Pseudoranges, cell: impl Fn(Option<f64>) -> String) -> String {
    let most = measured.cells().iter().map(|(i, j, _)| measured.candidates(i, j).len()).max().unwrap_or(1);
    let further: String = (2..=most).map(|k| format!(",value{k}")).collect();
    let mut table = format!("receiver,transmitter,value{further}\n");
    for (i, j, _) in measured.cells().iter() {
        table += &format!("{},{}", measured.receiver_names()[i], measured.transmitter_names()[j]);
        (0..most).for_each(|k| table += &cell(measured.candidates(i, j).get(k).copied()));
        table += "\n";
    }
    table
}

/// The unit of the measurements, if not the metre.
fn unit_of(arguments: &UnitArguments) -> Result<Option<Unit>, Failure> {
    let units = arguments.units(false)?.unwrap_or_default();
    let unit = Unit::new(units);
    match unit.filter(|_| !(units.metres() > 0.0 && units.metres().is_finite())) {
        Some(_) => Err(Failure::Unusable("--speed and --rate must be positive".to_string())),
        None => Ok(unit),
    }
}

/// The sides of a room, metres.
fn sides(text: &str) -> Option<Vec<f64>> {
    text.split('x').map(|side| side.parse().ok()).collect()
}

fn layout<const D: usize>(text: Option<&str>, shape: Shape) -> Result<Layout<D>, Failure> {
    if text == Some("normal") && shape == Shape::Anywhere {
        return Ok(Layout::Normal);
    }
    let extent = match text {
        None => Some(SimulateOptions::<D>::new().layout.extent()),
        Some(text) => sides(text).and_then(|sides| sides.try_into().ok()),
    };
    let text = text.unwrap_or_default();
    match (extent, shape) {
        (Some(extent), Shape::Anywhere) => Ok(Layout::Room { extent }),
        (Some(extent), Shape::Chain) => Ok(Layout::Chain { extent }),
        (Some(extent), Shape::Grid) => Ok(Layout::Grid { extent }),
        (None, Shape::Anywhere) => Err(Failure::Unusable(format!(
            "--layout must be normal, WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT in metres, not {text:?}"
        ))),
        (None, _) => Err(Failure::Unusable(format!(
            "--shape needs --layout WIDTHxHEIGHT or LENGTHxWIDTHxHEIGHT in metres, not {text:?}"
        ))),
    }
}

fn fault(text: &str) -> Result<ReceiverFault, Failure> {
    let parts = text.split_once('=').and_then(|(kind, size)| Some((kind, size.parse().ok()?)));
    match parts {
        Some(("delay", size)) => Ok(ReceiverFault::Delay(size)),
        Some(("drift", size)) => Ok(ReceiverFault::Drift(size)),
        Some(("move", size)) => Ok(ReceiverFault::Move(size)),
        _ => Err(Failure::Unusable(format!("--fault must be delay=METRES, drift=METRES or move=METRES, not {text:?}"))),
    }
}

/// A table of nodes: `id,x,y`, in space `id,x,y,z`.
fn positions<const D: usize>(names: &[String], positions: &[[f64; D]]) -> String {
    let row = |(name, p): (&String, &[f64; D])| format!("{name},{}\n", p.map(|x| x.to_string()).join(","));
    let rows: String = names.iter().zip(positions).map(row).collect();
    format!("id,{}\n{rows}", ["x", "y", "z"].into_iter().take(D).collect::<Vec<_>>().join(","))
}
