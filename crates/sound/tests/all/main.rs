//! Tests of the crate from outside.

mod bytes;
mod events;
mod flac;
mod hostile;
mod recorders;
mod room;
mod survey;
mod watched;
mod wav;
mod write;
