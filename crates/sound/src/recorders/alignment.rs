//! What is known of the clocks of recorders.

use std::fmt;

use serde::Serialize;

/// How the clocks of recorders go beside that of one of them, the reference.
///
/// Where sounds were made is not known. Start and rate take the sound to be at all recorders at the same time on average:
/// starts may be wrong by as much as it takes from one to another, which the calibration of a network finds out.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Alignment {
    /// The largest group of recorders that heard the same sounds, in their order. The first is the reference.
    pub recorders: Vec<RecorderAlignment>,
    /// All others, in their order.
    pub unaligned: Vec<Unaligned>,
}

impl Alignment {
    /// The clock of a recorder, from 0, if that is aligned.
    pub(crate) fn of(&self, recorder: usize) -> Option<&RecorderAlignment> {
        self.recorders.iter().find(|aligned| aligned.recorder == recorder)
    }
}

/// The clock of a recorder: it reads (1 + rate / 10^6) (t - start) at time t of the reference, in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RecorderAlignment {
    /// Number of the recorder among those that were given, from 0.
    pub recorder: usize,
    /// When its recording begins, seconds of the reference. 0 for the reference.
    pub start: f64,
    /// How much its clock is fast beside the reference, parts per million. 0 for the reference.
    pub rate: f64,
    /// Standard deviation of the rate, parts per million, if the ways of the sounds have nothing to do with their times.
    pub rate_sigma: f64,
    /// How many of its sounds match those of other recorders.
    pub matched: usize,
    /// Standard deviation of the times of these beside those of other recorders, seconds: mostly by the ways of the sound.
    pub scatter: f64,
}

impl RecorderAlignment {
    /// A recorder whose clock is the reference.
    pub(super) fn reference(recorder: usize) -> RecorderAlignment {
        RecorderAlignment { recorder, start: 0.0, rate: 0.0, rate_sigma: 0.0, matched: 0, scatter: 0.0 }
    }

    fn pace(&self) -> f64 {
        1.0 + self.rate * 1e-6
    }

    /// The time of the reference when this recorder's clock reads `seconds` from its first sample, seconds.
    pub fn common(&self, seconds: f64) -> f64 {
        self.start + seconds / self.pace()
    }

    /// What this recorder's clock reads at a time of the reference, seconds from its first sample.
    pub fn own(&self, common: f64) -> f64 {
        (common - self.start) * self.pace()
    }

    /// How many samples it takes in a second of the reference, Hz, if its clock says that it is `sample_rate`.
    pub(crate) fn sample_rate(&self, sample_rate: f64) -> f64 {
        sample_rate * self.pace()
    }
}

/// A recorder that cannot be aligned.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Unaligned {
    /// Number of the recorder among those that were given, from 0.
    pub recorder: usize,
    /// Why it cannot.
    pub reason: UnalignedReason,
}

impl fmt::Display for Unaligned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "recorder {} is left out: {}", self.recorder + 1, self.reason)
    }
}

/// Why a recorder cannot be aligned with the others.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub enum UnalignedReason {
    /// It heard too few sounds.
    TooFewSounds {
        /// How many it heard.
        heard: usize,
        /// How many it must hear.
        least: usize,
    },
    /// At no offset more of its sounds coincide with those of the others than by chance: too few are the same.
    OtherSounds {
        /// How many sounds it heard.
        heard: usize,
    },
    /// Two offsets explain about as many sounds, as where sounds come at regular times.
    Ambiguous {
        /// Number of the recorder that it was compared with, from 0.
        other: usize,
        /// When its recording begins by the clock of that one, if the likelier offset is right, seconds.
        start: f64,
        /// How many sounds coincide then.
        matched: usize,
        /// When it begins if the other offset is right, seconds.
        other_start: f64,
        /// How many sounds coincide then.
        other_matched: usize,
    },
    /// Its offset from one recorder contradicts those of both from a third one.
    Contradiction {
        /// Numbers of these recorders, from 0.
        others: [usize; 2],
        /// By how much they disagree, seconds.
        seconds: f64,
    },
}

impl fmt::Display for UnalignedReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            UnalignedReason::TooFewSounds { heard, least } => write!(
                f,
                "it heard {heard} sound{}, and at least {least} are needed; make more or louder sounds, or lower the threshold",
                if *heard == 1 { "" } else { "s" }
            ),
            UnalignedReason::OtherSounds { heard } => write!(
                f,
                "the {heard} sounds that it heard match those of the others no better than by chance; make more sounds that \
                 all recorders hear, at uneven times"
            ),
            UnalignedReason::Ambiguous { other, start, matched, other_start, other_matched } => write!(
                f,
                "beside recorder {} it was started at {start:.3} s, where {matched} sounds match, or at {other_start:.3} s, \
                 where {other_matched} do; make sounds at uneven times",
                other + 1
            ),
            UnalignedReason::Contradiction { others: [a, b], seconds } => write!(
                f,
                "its offsets from recorders {} and {} contradict each other by {seconds:.3} s; make more sounds that all \
                 recorders hear, at uneven times",
                a + 1,
                b + 1
            ),
        }
    }
}
