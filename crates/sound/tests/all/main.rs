//! Tests of the crate from outside.

mod bytes;
mod events;
mod flac;
mod hostile;
mod room;
mod survey;
mod wav;
mod write;
