//! Work that is recorded in pieces, each complete in itself.

use super::keeper::{Checkpoint, Key, Part};
use crate::monitor::Monitor;
use crate::ranks::Lead;
use crate::runner::Round;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A part of some work whose pieces are read from a checkpoint, or recorded in it. Without a
/// checkpoint the work is unchanged.
///
/// A piece is a function of its number and of the pieces before it.
#[derive(Clone, Copy)]
pub(crate) struct Pieces<'a> {
    pub(crate) monitor: &'a Monitor,
    /// Who hands out paths to other ranks.
    pub(crate) lead: Option<&'a Lead<'a>>,
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
    pub(crate) fn new(checkpoint: Option<&'a Checkpoint>, monitor: &'a Monitor, lead: Option<&'a Lead<'a>>) -> Self {
        Pieces { monitor, lead, checkpoint, part: 0 }
    }

    /// Pieces that nobody records, computed by this rank alone.
    pub(crate) fn alone(monitor: &'a Monitor) -> Self {
        Pieces::new(None, monitor, None)
    }

    /// The part that comes this many parts later.
    pub(crate) fn part(self, after: u32) -> Self {
        Pieces { part: self.part + after, ..self }
    }

    /// Whether the work must stop: it was cancelled, a required record cannot be written, or
    /// another rank fails.
    pub(crate) fn are_stopped(self) -> bool {
        self.is_broken() || self.checkpoint.is_some_and(|checkpoint| checkpoint.failure().is_some())
    }

    /// Whether tracked results are no longer complete.
    fn is_broken(self) -> bool {
        self.monitor.is_cancelled() || self.lead.is_some_and(|lead| lead.failure().is_some())
    }

    /// The recorded content of a piece; `None` if nothing is recorded, or nothing that `fits`.
    pub(crate) fn take<T: DeserializeOwned>(self, piece: Piece, fits: impl FnOnce(&T) -> bool) -> Option<T> {
        let (part, key) = self.place(piece)?;
        part.take(key, fits)
    }

    /// Records a piece with the number of solutions so far. A piece that ended half-way is not
    /// recorded.
    pub(crate) fn record<T: Serialize>(self, piece: Piece, solutions: usize, content: &T) {
        if let Some((part, key)) = self.place(piece)
            && !self.is_broken()
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
