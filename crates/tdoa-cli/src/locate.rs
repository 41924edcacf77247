//! `tdoa locate`.

mod arguments;
mod heard;

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use cli::files::Files;
use cli::input::{is_standard, name, source, text};
use serde::{Deserialize, Serialize};
use tdoa::read::{self, ReadOptions};
use tdoa::{Calibration, LocateError, LocatedEvent, Locator, Pseudoranges};

use crate::{Failure, input, output};

pub(crate) use arguments::Arguments;

/// What tells the networks that were written apart.
#[derive(Deserialize)]
struct Header {
    #[serde(default)]
    unfinished: bool,
    #[serde(default = "plane")]
    dimensions: usize,
    /// Unit of its measurements, where that was not the metre.
    units: Option<heard::Unit>,
}

fn plane() -> usize {
    2
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let further = arguments.recording.further_files();
    let files = arguments.files.iter().chain(&further).fold(Files::new(), |files, file| files.reads(Some(file)));
    files.reads(Some(&arguments.network)).check()?;
    let network = text(&arguments.network)?;
    let header: Header = parse(&network, &arguments.network)?;
    if header.unfinished {
        let problem = "the calibration was interrupted, and its network is unfinished; calibrate to the end";
        return Err(Failure::in_file(&arguments.network, problem));
    }
    crate::on_threads(arguments.threads, || match header.dimensions {
        3 => locate::<3>(arguments, &parse(&network, &arguments.network)?, header.units.as_ref()),
        _ => locate::<2>(arguments, &parse(&network, &arguments.network)?, header.units.as_ref()),
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
fn locate<const D: usize>(
    arguments: &Arguments,
    network: &Calibration<D>,
    units: Option<&heard::Unit>,
) -> Result<(), Failure>
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
    let file = arguments.files.first().map_or(Path::new("-"), PathBuf::as_path);
    if arguments.recording.are_of(&arguments.files)? {
        return heard::locate(arguments, network, units, &locator);
    }
    let options = arguments.input.options(network.speed.is_some())?;
    let mut tell = |measured: &Pseudoranges| -> Result<(), Failure> {
        locator.locate(measured).map_err(Failure::unusable)?.iter().try_for_each(output::json_line)
    };
    if is_standard(file) { as_it_comes(file, &options, &mut tell) } else { tell(&input::measurements(file, options)?) }
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
