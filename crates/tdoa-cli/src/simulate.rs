//! `tdoa simulate`.

mod arguments;
mod layout;
mod recordings;
mod sound_arguments;
mod tables;

use cli::files::check_directory;
use tdoa::{ReceiverFault, SimulateOptions, simulate};

pub(crate) use arguments::Arguments;
use layout::{layout, sides};
use tables::{list, matrix, positions};

use crate::Failure;
use crate::output;
use crate::units::{Unit, UnitArguments};

/// What is written; the last one where receivers have clocks of their own.
const FILES: [&str; 5] = ["pseudoranges.csv", "receivers.csv", "transmitters.csv", "offsets.csv", "clocks.csv"];

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.sound.sound {
        return recordings::run(arguments);
    }
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

/// The unit of the measurements, if not the metre.
fn unit_of(arguments: &UnitArguments) -> Result<Option<Unit>, Failure> {
    let units = arguments.units(false)?.unwrap_or_default();
    let unit = Unit::new(units);
    match unit.filter(|_| !(units.metres() > 0.0 && units.metres().is_finite())) {
        Some(_) => Err(Failure::Unusable("--speed and --rate must be positive".to_string())),
        None => Ok(unit),
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
