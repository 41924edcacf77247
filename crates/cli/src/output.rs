//! Files written whole or not at all, and JSON.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use crate::Failure;
use crate::standard::is_standard;
use crate::writing::Writing;

/// Writes a file by way of a temporary one in the same directory, so that an interrupted run leaves
/// no half of it.
///
/// # Errors
/// If the file cannot be written: the message says what to check.
pub fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    write_by(path, |file| file.write_all(content))
}

/// Writes a file piece by piece, as [`write()`] does.
fn write_by(path: &Path, content: impl FnOnce(&mut std::fs::File) -> std::io::Result<()>) -> Result<(), Failure> {
    let _writing = Writing::begin();
    let failed = |error: std::io::Error| unwritable(path, &error);
    // Devices such as /dev/null are written to, not replaced.
    if is_special(path) {
        return std::fs::File::create(path).and_then(|mut file| content(&mut file)).map_err(failed);
    }
    let mut file = temporary(path)?;
    content(file.as_file_mut()).and_then(|()| file.as_file().sync_all()).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Writes a file that the user asked for, and says so on standard error.
///
/// # Errors
/// Those of [`write()`].
pub fn file(path: &Path, content: &[u8]) -> Result<(), Failure> {
    write(path, content)?;
    eprintln!("wrote {}", path.display());
    Ok(())
}

/// Checks that a file can be written. Nothing is left there.
pub(crate) fn probe(path: &Path) -> Result<(), Failure> {
    if !is_standard(path) && !is_special(path) {
        temporary(path)?;
    }
    Ok(())
}

/// Checks that files can be written in a directory, which is made later if it is not there. Nothing
/// is left there.
pub(crate) fn probe_directory(directory: &Path) -> Result<(), Failure> {
    let refused = |what: &str| Failure::Unusable(format!("{}: {what}", directory.display()));
    if is_standard(directory) {
        return Err(refused("files go to a directory, not to standard output; give its name"));
    }
    // The directory, or the one in which it is made.
    let there = directory.ancestors().find(|place| place.as_os_str().is_empty() || place.exists());
    match there {
        Some(place) if !place.as_os_str().is_empty() && !place.is_dir() => {
            Err(refused("is a file, or lies in one; give a directory"))
        }
        place => {
            let place = place.filter(|place| !place.as_os_str().is_empty()).unwrap_or(Path::new("."));
            temporary_in(place).map(|_| ()).map_err(|error| {
                refused(&format!(
                    "cannot be written to ({error}); check that it, or the directory it is made in, is writable and has space"
                ))
            })
        }
    }
}

/// Whether a path is neither a file nor a directory but a device or a pipe.
fn is_special(path: &Path) -> bool {
    path.exists() && !path.is_file() && !path.is_dir()
}

/// A new file beside the one that is to be written.
fn temporary(path: &Path) -> Result<tempfile::NamedTempFile, Failure> {
    if path.is_dir() {
        return Err(Failure::Unusable(format!("{}: is a directory; give a file name in it", path.display())));
    }
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    temporary_in(directory).map_err(|error| unwritable(path, &error))
}

fn temporary_in(directory: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".part-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for any new file; the umask takes away what the user does not want.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(directory)
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Unusable(format!(
        "{}: cannot be written ({error}); check that the directory exists, is writable and has space",
        path.display()
    ))
}

/// Writes text to a file and says so on standard error, or to standard output for `-`.
///
/// # Errors
/// Those of [`write()`] and [`print()`].
pub fn text(path: &Path, text: &str) -> Result<(), Failure> {
    if is_standard(path) { print(text) } else { file(path, text.as_bytes()) }
}

/// Number of the form of the programs' results, their field `format`. A field that goes, gets another name or
/// another meaning raises it; a further field does not.
pub const FORMAT: u32 = 1;

/// A result with the number of its form.
#[derive(Serialize)]
struct Numbered<'a, T> {
    format: u32,
    #[serde(flatten)]
    value: &'a T,
}

/// Writes a result, which has fields, as JSON to a file and says so on standard error, or to standard output
/// for `-`. The field `format` comes first.
///
/// # Errors
/// Those of [`write()`] and [`print()`].
pub fn json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    json_of(path, &Numbered { format: FORMAT, value })
}

/// Writes a list of results, each as [`json()`] has it.
///
/// # Errors
/// Those of [`json()`].
pub fn json_list<T: Serialize>(path: &Path, values: &[T]) -> Result<(), Failure> {
    let all: Vec<Numbered<'_, T>> = values.iter().map(|value| Numbered { format: FORMAT, value }).collect();
    json_of(path, &all)
}

/// Prints a result as JSON in a line of its own, at once.
///
/// # Errors
/// Those of [`print()`].
pub fn json_line(value: &impl Serialize) -> Result<(), Failure> {
    print_by(|out| {
        serde_json::to_writer(&mut *out, &Numbered { format: FORMAT, value })?;
        out.write_all(b"\n")
    })
}

fn json_of(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    if is_standard(path) {
        return print_by(|out| write_json(out, value));
    }
    write_by(path, |file| write_json(file, value))?;
    eprintln!("wrote {}", path.display());
    Ok(())
}

/// Piece by piece: the matrices of a large network would fill the memory as text.
fn write_json(to: impl Write, value: &impl Serialize) -> std::io::Result<()> {
    let mut to = std::io::BufWriter::new(to);
    serde_json::to_writer_pretty(&mut to, value)?;
    to.write_all(b"\n")?;
    to.flush()
}

/// Prints a summary, unless one of the outputs is asked for on standard output instead.
///
/// # Errors
/// Those of [`print()`].
pub fn summary<'a>(outputs: impl IntoIterator<Item = &'a Path>, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if outputs.into_iter().any(is_standard) { Ok(()) } else { print(&text()) }
}

/// Prints to standard output. A reader that has gone away, such as `head`, is no error.
///
/// # Errors
/// If standard output cannot be written for another reason.
pub fn print(text: &str) -> Result<(), Failure> {
    print_by(|out| out.write_all(text.as_bytes()))
}

/// Prints piece by piece.
fn print_by(content: impl FnOnce(&mut std::io::StdoutLock<'_>) -> std::io::Result<()>) -> Result<(), Failure> {
    let _writing = Writing::begin();
    let mut out = std::io::stdout().lock();
    match content(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Unusable(format!("standard output cannot be written ({error})")))
        }
        _ => Ok(()),
    }
}
