//! Tests of the crate from outside.

mod bytes;
mod flac;
mod hostile;
mod survey;
mod wav;
