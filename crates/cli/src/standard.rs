//! Standard input and standard output in the place of files.

use std::path::Path;

/// Whether a path stands for standard input, or for standard output where it is written: `-`.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// What a path of something that is read is called in messages.
pub fn name(path: &Path) -> String {
    if is_standard(path) { "standard input".to_owned() } else { path.display().to_string() }
}
