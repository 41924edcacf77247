//! `hc codegen`.

use crate::{family, input, track, watch};
use cli::files::Files;
use cli::{Failure, output};
use hc::codegen::{self, CodegenError};
use hc::family::{ChoiceOptions, StartFile, easiest_fibre, real_sample, unpack_fibre};
use hc::poly::counted;
use hc::{Family, Fibre, Monitor};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes a Rust module that solves a family: its equations as straight-line code, and its stored
/// solutions.
///
/// The module depends on the crate hc alone. The same inputs give the same bytes. Where there are thousands
/// of solutions, a packed fibre takes a tenth of the bytes and no time to compile; the family is then
/// interpreted (hc::family::unpack_fibre).
#[derive(clap::Args)]
pub(crate) struct Arguments {
    /// The family: plain text with a line `parameters: a b`, or TOML; - for standard input.
    family: PathBuf,
    /// Its stored solutions: what `hc monodromy` writes.
    start: PathBuf,
    /// The Rust file, or if its name ends in `.fibre` a packed fibre; - for standard output, or standard input
    /// with --check.
    #[arg(long, short)]
    output: PathBuf,
    /// Tries so many random members of the family, and stores the one from which the paths to random real
    /// parameters take least work, in place of the given one if that is another.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1000))]
    fibres: Option<u16>,
    /// With --fibres: the parameters to which paths should take little work, in place of random ones. JSON
    /// {"parameters": [number or [re, im], ...]}, or a list of such.
    #[arg(long, requires = "fibres")]
    targets: Option<PathBuf>,
    /// Write nothing; exit status 1 if the file is stale.
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { family: family_file, start: start_file, output, check, .. } = arguments;
    let files = Files::new().reads(Some(family_file)).reads(Some(start_file)).reads(arguments.targets.as_deref());
    let files = if *check { files.reads(Some(output)) } else { files.writes("--output", Some(output)) };
    files.check()?;
    let family = family::read(family_file)?;
    let mut start = StartFile::from_json(&input::text(start_file)?).map_err(|e| Failure::in_file(start_file, e))?;
    if let Some(members) = arguments.fibres {
        start = easiest(&family, &start, members, arguments)?;
    }
    if output.extension().is_some_and(|extension| extension == "fibre") {
        return packed(&family, &start, arguments);
    }
    let source = if input::is_standard(family_file) {
        "standard input".into()
    } else {
        family_file.file_name().unwrap_or_default().to_string_lossy()
    };
    let module = codegen::generate(&family, &start, &source).map_err(|error| Failure::in_file(start_file, error))?;
    if !check {
        return output::text(output, &module);
    }
    if input::text(output)? == module {
        eprintln!("{} is up to date", input::name(output));
        return Ok(());
    }
    Err(Failure::Undetermined(format!("{} is stale; run the command without --check", input::name(output))))
}

/// The easiest fibre of so many random members and the given one.
fn easiest(family: &Family, start: &StartFile, members: u16, arguments: &Arguments) -> Result<StartFile, Failure> {
    let refused = |error: CodegenError| Failure::in_file(&arguments.start, error);
    let fibre = family.stored(start).map_err(|e| Failure::in_file(&arguments.start, e))?;
    codegen::verify(family, &fibre).map_err(refused)?;
    let parameters = fibre.parameters.len();
    let mut options = ChoiceOptions::default();
    options.members = members.into();
    let targets = match &arguments.targets {
        Some(file) => match track::targets(file, parameters)?.0 {
            targets if targets.is_empty() => return Err(Failure::in_file(file, "at least one target is needed")),
            targets => targets,
        },
        None => (0..options.samples as u64).map(|k| real_sample(parameters, k)).collect(),
    };
    options.samples = targets.len();
    let tracked = AtomicU64::new(0);
    let total = u64::from(members) + 1;
    let describe = |_| (tracked.load(Ordering::Relaxed) * total / options.work(), total, "members".to_owned());
    let sample = |_: &Fibre, k: u64| {
        tracked.fetch_add(1, Ordering::Relaxed);
        targets[k as usize].clone()
    };
    let (easiest, jacobians) = watch::watched(None, &Monitor::default(), describe, || {
        easiest_fibre(family.program(), &fibre, sample, &options)
    })?;
    let other = if easiest == fibre { "the given fibre" } else { "another fibre" };
    eprintln!("{other}: {jacobians:.1} Jacobians a path to {}", counted(targets.len(), "sample"));
    let trace = if easiest == fibre { start.trace_test } else { None };
    Ok(StartFile::new(&easiest, trace, &start.stopped))
}

/// Writes the solutions as a packed fibre, or checks that the one on disk is that.
fn packed(family: &Family, start: &StartFile, arguments: &Arguments) -> Result<(), Failure> {
    let path = &arguments.output;
    let bytes = codegen::pack(family, start).map_err(|error| Failure::in_file(&arguments.start, error))?;
    if !arguments.check {
        return output::file(path, &bytes);
    }
    let found = std::fs::read(path).map_err(|error| Failure::Unusable(format!("{}: {error}", path.display())))?;
    unpack_fibre(family.program(), &found).map_err(|error| Failure::in_file(path, error))?;
    if found == bytes {
        eprintln!("{} is up to date", path.display());
        return Ok(());
    }
    Err(Failure::Undetermined(format!("{} is stale; run the command without --check", path.display())))
}
