//! Text of reasonable size, from files or from standard input.

pub use crate::standard::{is_standard, name};

use crate::Failure;
use std::io::Read;
use std::path::Path;

/// Largest text that is read.
const MAX_BYTES: u64 = 64 << 20;

/// Reads a text of at most 64 MB: a file, or standard input for `-`.
///
/// # Errors
/// If it cannot be read, is no text, or is larger.
pub fn text(path: &Path) -> Result<String, Failure> {
    if is_standard(path) {
        return all(std::io::stdin().lock(), path);
    }
    all(std::fs::File::open(path).map_err(|e| Failure::in_file(path, e))?, path)
}

fn all(source: impl Read, path: &Path) -> Result<String, Failure> {
    let mut text = String::new();
    source.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(|e| Failure::in_file(path, e))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(Failure::in_file(path, "larger than 64 MB; is it the right file?"));
    }
    Ok(text)
}

/// Checks, before the work begins, that standard input is read once at most, and not by one of
/// several processes, which do not all have it.
///
/// # Errors
/// If it is read twice, or `shared` says that there are several processes and it is read at all.
pub fn check(paths: &[Option<&Path>], shared: bool) -> Result<(), Failure> {
    match paths.iter().flatten().filter(|path| is_standard(path)).count() {
        0 => Ok(()),
        1 if shared => Err(Failure::unusable(
            "standard input reaches one of several ranks alone; give a file, which all of them can read",
        )),
        1 => Ok(()),
        _ => Err(Failure::unusable("standard input can be read once; give files in place of all `-` but one")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_input_is_read_once_and_by_one_process() {
        let (file, standard) = (Path::new("a"), Path::new("-"));
        assert!(check(&[Some(standard), None, Some(file)], false).is_ok());
        assert!(check(&[Some(file), Some(file)], true).is_ok());
        let message = |paths: &[Option<&Path>], shared| check(paths, shared).unwrap_err().to_string();
        assert!(message(&[Some(standard), Some(standard)], false).contains("can be read once"));
        assert!(message(&[Some(standard)], true).contains("give a file"));
        assert_eq!(name(standard), "standard input");
        assert_eq!(all(&b"x = 1"[..], standard).unwrap(), "x = 1");
        assert!(all(&b"\xff"[..], standard).unwrap_err().to_string().starts_with("standard input: "));
    }
}
