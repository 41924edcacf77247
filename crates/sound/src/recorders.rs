//! Recorders that were started apart: when each was started by the clock of one of them, from the sounds that they heard.
//!
//! Where to look: align.rs has the steps. The onsets of a recorder become sounds (`sounds`); between each two recorders
//! one offset makes more sounds coincide than chance does (`coincidence`), and those that match say it more exactly, with a
//! rate (`pair`, `line`). Three recorders must agree (`cycles`), and all that do get their place by all matches together
//! (`adjust`). The result is an `alignment`, by
//! which `gathered` finds the events of all recorders. Files of one recorder must have begun `together`.

mod adjust;
mod align;
mod alignment;
mod coincidence;
mod cycles;
mod gathered;
mod line;
mod options;
mod pair;
mod sounds;
#[cfg(test)]
mod tests;
mod together;

pub use alignment::{Alignment, RecorderAlignment, Unaligned, UnalignedReason};
pub(crate) use gathered::{Gathered, OwnEvents};
pub use options::AlignmentOptions;
pub(crate) use together::FilesApart;
