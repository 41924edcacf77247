//! Files written whole or not at all, and JSON.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use crate::Failure;

/// Writes a file by way of a temporary one in the same directory, so that an interrupted run leaves no half of it.
///
/// # Errors
/// If the file cannot be written: the message says what to check.
pub fn write(path: &Path, content: &[u8]) -> Result<(), Failure> {
    let directory = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let failed = |error: std::io::Error| {
        Failure::Unusable(format!(
            "{}: cannot be written ({error}); check that the directory exists, is writable and has space",
            path.display()
        ))
    };
    if path.is_dir() {
        return Err(Failure::Unusable(format!("{}: is a directory; give a file name in it", path.display())));
    }
    // Devices such as /dev/null are written to, not replaced.
    if path.exists() && !path.is_file() {
        return std::fs::write(path, content).map_err(failed);
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".part-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As for any new file; the umask takes away what the user does not want.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(directory).map_err(failed)?;
    file.write_all(content).and_then(|()| file.as_file().sync_all()).map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    Ok(())
}

/// Whether a path stands for standard output: `-`.
fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Writes text to a file, or to standard output for `-`.
///
/// # Errors
/// As [`write()`] and [`print()`].
pub fn text(path: &Path, text: &str) -> Result<(), Failure> {
    if is_standard_output(path) { print(text) } else { write(path, text.as_bytes()) }
}

/// Writes JSON to a file, or to standard output for `-`.
///
/// # Errors
/// As [`write()`] and [`print()`].
pub fn json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let mut json = serde_json::to_string_pretty(value).map_err(Failure::unusable)?;
    json.push('\n');
    text(path, &json)
}

/// Prints a summary, unless the JSON is asked for on standard output instead.
///
/// # Errors
/// As [`print()`].
pub fn summary(json: Option<&Path>, text: impl FnOnce() -> String) -> Result<(), Failure> {
    if json.is_some_and(is_standard_output) { Ok(()) } else { print(&text()) }
}

/// Prints to standard output. A reader that has gone away, such as `head`, is no error.
///
/// # Errors
/// If standard output cannot be written for another reason.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Unusable(format!("standard output cannot be written ({error})")))
        }
        _ => Ok(()),
    }
}
