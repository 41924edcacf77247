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
    all(source(path)?, path)
}

fn all(source: impl Read, path: &Path) -> Result<String, Failure> {
    let mut text = String::new();
    source.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(|e| Failure::in_file(path, e))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(Failure::in_file(path, "larger than 64 MB; is it the right file?"));
    }
    Ok(text)
}

/// What is read from a path: the file, or standard input for `-`.
///
/// # Errors
/// If the file cannot be opened.
pub fn source(path: &Path) -> Result<Box<dyn Read>, Failure> {
    if is_standard(path) {
        return Ok(Box::new(std::io::stdin().lock()));
    }
    match std::fs::File::open(path) {
        Ok(file) => Ok(Box::new(file)),
        Err(error) => Err(Failure::in_file(path, error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_utf_8() {
        let standard = Path::new("-");
        assert_eq!(name(standard), "standard input");
        assert_eq!(all(&b"x = 1"[..], standard).unwrap(), "x = 1");
        assert!(all(&b"\xff"[..], standard).unwrap_err().to_string().starts_with("standard input: "));
    }
}
