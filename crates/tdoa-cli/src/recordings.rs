//! Recordings: what is read, heard, and made of it.

mod arguments;
mod heard;
mod page;
mod speed;

pub(crate) use arguments::RecordingArguments;
pub(crate) use heard::Recordings;
pub(crate) use page::{Expected, sections};
