//! Text files of reasonable size.

use crate::Failure;
use std::io::Read;
use std::path::Path;

/// Largest file that is read.
const MAX_BYTES: u64 = 64 << 20;

/// Reads a text file of at most 64 MB.
///
/// # Errors
/// If it cannot be read, is no text, or is larger.
pub fn text(path: &Path) -> Result<String, Failure> {
    let file = std::fs::File::open(path).map_err(|e| Failure::in_file(path, e))?;
    let mut text = String::new();
    file.take(MAX_BYTES + 1).read_to_string(&mut text).map_err(|e| Failure::in_file(path, e))?;
    if text.len() as u64 > MAX_BYTES {
        return Err(Failure::in_file(path, "larger than 64 MB; is it the right file?"));
    }
    Ok(text)
}
