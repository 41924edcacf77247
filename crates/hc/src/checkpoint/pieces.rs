//! Work that is recorded in pieces, each whole.

use super::keeper::{Checkpoint, Key, Part};
use crate::monitor::Monitor;
use crate::runner::Round;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A part of some work whose pieces are taken from a checkpoint, or recorded there; as it is without
/// one.
///
/// A piece is a function of its number and of the pieces before it.
#[derive(Clone, Copy)]
pub(crate) struct Pieces<'a> {
    pub(crate) monitor: &'a Monitor,
    checkpoint: Option<&'a Checkpoint>,
    part: u32,
}

/// Which piece of a part.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Piece {
    /// One that counts, by its number.
    Whole(usize),
    /// A step of one, by its number among those of all.
    Step(usize),
}

impl<'a> Pieces<'a> {
    pub(crate) fn new(checkpoint: Option<&'a Checkpoint>, monitor: &'a Monitor) -> Self {
        Pieces { monitor, checkpoint, part: 0 }
    }

    /// The part that is so many after this.
    pub(crate) fn part(self, after: u32) -> Self {
        Pieces { part: self.part + after, ..self }
    }

    /// Whether the work is to stop: it was cancelled, or a record is required that cannot be written.
    pub(crate) fn are_stopped(self) -> bool {
        self.monitor.is_cancelled() || self.checkpoint.is_some_and(|checkpoint| checkpoint.failure().is_some())
    }

    /// What is recorded of a piece; `None` if nothing is, or nothing that `fits`.
    pub(crate) fn take<T: DeserializeOwned>(self, piece: Piece, fits: impl FnOnce(&T) -> bool) -> Option<T> {
        let (part, key) = self.place(piece)?;
        part.take(key, fits)
    }

    /// Records a piece with the number of solutions so far. What was cancelled half way is none.
    pub(crate) fn record<T: Serialize>(self, piece: Piece, solutions: usize, content: &T) {
        if let Some((part, key)) = self.place(piece)
            && !self.monitor.is_cancelled()
        {
            part.record(key, 0, solutions as u64, content);
        }
    }

    fn place(self, piece: Piece) -> Option<(Part<'a>, Key)> {
        let part = Part { checkpoint: self.checkpoint?, number: self.part };
        let (first, count) = match piece {
            Piece::Whole(number) => (number, 1),
            Piece::Step(number) => (number, 0),
        };
        Some((part, part.key(Round::FIRST, first, count)))
    }
}
