//! Recordings: what is read, heard, and made of it.

mod arguments;
mod heard;
mod page;
mod speed;

use std::path::Path;

pub(crate) use arguments::RecordingArguments;
pub(crate) use heard::Recordings;
pub(crate) use page::{Expected, sections};
pub(crate) use speed::SpeedArguments;

/// Whether a file is a recording, by its name or by how it begins.
pub(crate) fn is_recording(path: &Path) -> bool {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let named = ending.is_some_and(|ending| ["wav", "wave", "bwf", "rf64", "flac"].contains(&ending.as_str()));
    named || (path.is_file() && sound::Recording::open(path).is_ok())
}
