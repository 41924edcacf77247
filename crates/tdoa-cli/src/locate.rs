//! `tdoa locate`.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use cli::files::Files;
use cli::input::{is_standard, name, source, text};
use serde::{Deserialize, Serialize};
use tdoa::read::{self, ReadOptions};
use tdoa::{Calibration, LocateError, LocatedEvent, Locator, Pseudoranges};

use crate::{Failure, input, output};

/// Locates new transmitters in a network that is calibrated: a line of JSON each, as they come.
///
/// Receivers are known by their names. Each transmitter is located by itself, with its covariance, the receivers that do not
/// agree, and other places that explain the measurements about as well (`others`); `unique` says that there is none.
/// Values are those that the network would have been calibrated with: by the same clocks, and at the same speed.
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The network: what `tdoa calibrate --json` has written.
    network: PathBuf,
    /// The measurements, in any form that `tdoa calibrate` reads; - for standard input. A list from there is read as it
    /// comes: a transmitter is located when the next one begins.
    file: PathBuf,
    #[command(flatten)]
    input: crate::units::InputArguments,
    /// Standard deviation of the measurements in metres; that of the calibration if not given.
    #[arg(long, allow_negative_numbers = true)]
    sigma: Option<f64>,
    /// Threads; accepted everywhere, locating needs only one.
    #[arg(long)]
    threads: Option<usize>,
}

/// What tells the networks that were written apart.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    unfinished: bool,
    #[serde(default = "plane")]
    dimensions: usize,
}

fn plane() -> usize {
    2
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    Files::new().reads(Some(&arguments.network)).reads(Some(&arguments.file)).check()?;
    let network = text(&arguments.network)?;
    let header: Header = parse(&network, &arguments.network)?;
    if header.unfinished {
        let problem = "the calibration was interrupted, and its network is unfinished; calibrate to the end";
        return Err(Failure::in_file(&arguments.network, problem));
    }
    crate::on_threads(arguments.threads, || match header.dimensions {
        3 => locate::<3>(arguments, &parse(&network, &arguments.network)?),
        _ => locate::<2>(arguments, &parse(&network, &arguments.network)?),
    })?
}

fn parse<'a, T: Deserialize<'a>>(text: &'a str, path: &Path) -> Result<T, Failure> {
    let failed = |error| {
        let problem =
            format!("is no network that `tdoa calibrate --json` has written ({error}); give such a file first");
        Failure::in_file(path, problem)
    };
    serde_json::from_str(text).map_err(failed)
}

/// Locates all transmitters of the measurements.
fn locate<const D: usize>(arguments: &Arguments, network: &Calibration<D>) -> Result<(), Failure>
where
    LocatedEvent<D>: Serialize,
{
    let locator = Locator::new(network, arguments.sigma).map_err(|error| match error {
        LocateError::Distrust { .. } => Failure::Undetermined(format!("{}: {error}", name(&arguments.network))),
        other => Failure::unusable(other),
    })?;
    for note in locator.notes() {
        eprintln!("note: {note}");
    }
    let options = arguments.input.options(network.speed.is_some())?;
    let mut tell = |measured: &Pseudoranges| -> Result<(), Failure> {
        locator.locate(measured).map_err(Failure::unusable)?.iter().try_for_each(output::json_line)
    };
    if is_standard(&arguments.file) {
        as_it_comes(&arguments.file, &options, &mut tell)
    } else {
        tell(&input::measurements(&arguments.file, options)?)
    }
}

/// Most of a line of a list, bytes.
const LINE: u64 = 1 << 16;

/// The next line, with its end; none where there is no more.
fn line(source: &mut impl BufRead, path: &Path) -> Result<Vec<u8>, Failure> {
    let mut line = Vec::new();
    let read = source.take(LINE).read_until(b'\n', &mut line).map_err(|error| Failure::in_file(path, error))?;
    // Only the last line of all has no end.
    if read as u64 == LINE {
        return Err(Failure::in_file(path, "has a line of more than 64 kB; is it the right file?"));
    }
    Ok(line)
}

/// Reads a list one transmitter after the other; anything else as a whole.
fn as_it_comes(
    path: &Path,
    options: &ReadOptions,
    tell: &mut impl FnMut(&Pseudoranges) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut source = BufReader::new(source(path)?);
    let header = line(&mut source, path)?;
    let first = line(&mut source, path)?;
    let parse =
        |lines: &[u8]| read::read_from(&[&header, lines].concat()[..], Path::new("standard input"), options.clone());
    // A line of a list is a measurement by itself; a line of a matrix is a receiver, with a heading for each transmitter.
    let is_list = read::heads_list(&String::from_utf8_lossy(&header).split([',', ';', '\t']).collect::<Vec<_>>());
    if !is_list {
        let rest = std::io::Cursor::new([header, first].concat()).chain(source);
        return tell(&read::read_from(rest, Path::new("standard input"), options.clone()).map_err(Failure::unusable)?);
    }
    // The lines of the transmitter that is being read, and its name.
    let (mut pending, mut next): (Vec<u8>, Vec<u8>) = (Vec::new(), first);
    let mut current: Option<String> = None;
    while !next.is_empty() {
        if !next.trim_ascii().is_empty() {
            // A measurement that is missing has no transmitter.
            let one = parse(&next).map_err(Failure::unusable)?;
            let transmitter = one.transmitter_names().first().cloned();
            if current.is_some() && transmitter != current {
                tell(&parse(&pending).map_err(Failure::unusable)?)?;
                pending.clear();
            }
            current = transmitter.or(current);
            pending.extend_from_slice(&next);
        }
        next = line(&mut source, path)?;
    }
    if pending.is_empty() { Ok(()) } else { tell(&parse(&pending).map_err(Failure::unusable)?) }
}
