//! What an error of a receiver is: a delay, a clock that drifts or jumps, a receiver that was moved.

use serde::{Deserialize, Serialize};

/// Kinds of errors that a receiver may have.
const KINDS: f64 = 4.0;

/// What so many errors of receivers cost in the logarithm of the likelihood of so many measurements: each the choice of
/// receiver and kind, and its size as in Schwarz's criterion (1978). Delays of all receivers are no choice, and one of
/// them follows from the others.
pub(crate) fn price(errors: usize, are_delays_of_all: bool, receivers: usize, measurements: usize) -> f64 {
    let of_size = 0.5 * (measurements.max(1) as f64).ln();
    if are_delays_of_all {
        of_size * receivers.saturating_sub(1) as f64
    } else {
        ((KINDS * receivers.max(1) as f64).ln() + of_size) * errors as f64
    }
}

/// The kind of error that a receiver has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum ReceiverErrorKind {
    /// All its measurements are too long, or too short, by the same length.
    Delay,
    /// The error of its measurements grows evenly from the first transmitter to the last one.
    Drift,
    /// Its clock jumps: from one transmitter on, its measurements are too long, or too short, by
    /// the same length.
    Jump,
    /// It stands elsewhere from one transmitter on.
    Move,
}

/// One of the two places of a receiver that was moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum MovedPlace {
    /// The place before the move.
    Before,
    /// The place after the move.
    After,
}

/// An error of one receiver that its measurements show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReceiverError {
    /// Name of the receiver.
    pub receiver: String,
    /// The kind of error.
    pub kind: ReceiverErrorKind,
    /// Name of the first transmitter after a jump or a move, in the order of the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<String>,
    /// The place that the result has for a receiver that was moved: the one with more measurements.
    /// `None` for other errors, and for a move that was not taken out. In the latter case the
    /// result has a place between both, with a covariance that includes both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub place: Option<MovedPlace>,
    /// Size of the error in metres: the delay, the drift from the first transmitter to the last
    /// one, the jump, or the distance of the move.
    pub size: f64,
    /// How much more likely the measurements are with the error (natural logarithm).
    pub gain: f64,
    /// Whether the error was taken out of the network.
    pub taken_out: bool,
}

/// An error of one receiver, by indices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Fault<const D: usize> {
    pub(crate) receiver: usize,
    pub(crate) kind: ReceiverErrorKind,
    /// First transmitter that has it; 0 for delay and drift.
    pub(crate) from: usize,
    /// Metres; of a move in each coordinate, otherwise the first alone.
    pub(crate) size: [f64; D],
    pub(crate) gain: f64,
}

impl<const D: usize> Fault<D> {
    /// One of no size yet.
    pub(crate) fn new(receiver: usize, kind: ReceiverErrorKind, from: usize) -> Fault<D> {
        Fault { receiver, kind, from, size: [0.0; D], gain: 0.0 }
    }

    pub(crate) fn length(&self) -> f64 {
        if self.kind == ReceiverErrorKind::Move {
            self.size.iter().copied().fold(0.0, f64::hypot)
        } else {
            self.size[0]
        }
    }

    /// What the error adds to a measurement of transmitter `j` of `n`, for a size of 1; a move is
    /// none of these.
    pub(crate) fn shape(&self, j: usize, n: usize) -> f64 {
        match self.kind {
            ReceiverErrorKind::Delay => 1.0,
            ReceiverErrorKind::Drift => j as f64 / (n.max(2) - 1) as f64,
            ReceiverErrorKind::Jump | ReceiverErrorKind::Move => f64::from(u8::from(j >= self.from)),
        }
    }
}
