//! `hc codegen`.

use crate::{family, input};
use cli::{Failure, output};
use hc::Family;
use hc::codegen;
use hc::family::{StartFile, unpack_fibre};
use std::path::PathBuf;

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
    /// Write nothing; exit status 1 if the file is stale.
    #[arg(long)]
    check: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { family: family_file, start: start_file, output, check } = arguments;
    input::check(&[Some(family_file), Some(start_file), check.then_some(output)], false)?;
    let family = family::read(family_file)?;
    let start = StartFile::from_json(&input::text(start_file)?).map_err(|e| Failure::in_file(start_file, e))?;
    if output.extension().is_some_and(|extension| extension == "fibre") {
        return packed(&family, &start, arguments);
    }
    let source = if input::is_standard(family_file) {
        "standard input".into()
    } else {
        family_file.file_name().unwrap_or_default().to_string_lossy()
    };
    let module = codegen::generate(&family, &start, &source).map_err(|e| Failure::in_file(start_file, e))?;
    if !check {
        return output::text(output, &module);
    }
    if input::text(output)? == module {
        eprintln!("{} is up to date", input::name(output));
        return Ok(());
    }
    Err(Failure::Undetermined(format!("{} is stale; run the command without --check", input::name(output))))
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
