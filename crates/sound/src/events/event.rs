//! What is found.

use std::fmt;
use std::ops::Range;

use serde::Serialize;

/// The events of recordings, and what became of all that was heard.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Events {
    /// The events in their order. Their windows do not overlap.
    pub events: Vec<Event>,
    /// The channels of all files, in the order of the files.
    pub channels: Vec<EventChannel>,
    /// What was heard and is no event, in the order of time.
    pub dropped: Vec<DroppedEvent>,
}

/// A sound that was heard by several channels.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Event {
    /// The earliest of its onsets, seconds from the first sample.
    pub seconds: f64,
    /// Of each channel the onset of the direct sound; `None` if the channel did not hear it.
    pub onsets: Vec<Option<Onset>>,
    /// Where its direct sounds are, seconds from the first sample: from 50 ms before the earliest onset to 50 ms after the
    /// sound, or the end of the signal, has passed the whole extent, the same for all channels. It may end after the
    /// recording does.
    pub window: Range<f64>,
}

/// The beginning of a sound in a channel.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Onset {
    /// When it begins, to about 1 ms, seconds from the first sample.
    pub seconds: f64,
    /// Amplitude of the strongest millisecond in the first 5 ms over that of the noise, dB.
    pub strength_db: f64,
}

/// What was heard in a channel: `heard` is the sum of `used`, `echoes` and `dropped`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct EventChannel {
    /// Path of the file.
    pub file: String,
    /// Number of the channel in this file, from 1.
    pub channel: usize,
    /// Samples per second, Hz.
    pub sample_rate: u32,
    /// Onsets that were heard: 0 in a channel that is dead, or in which noise hides all sounds.
    pub heard: usize,
    /// Onsets that are direct sounds of events.
    pub used: usize,
    /// Onsets that belong to an event, but are not its direct sound: echoes, and triggers that are too weak beside it.
    pub echoes: usize,
    /// Onsets of what was dropped.
    pub dropped: usize,
}

/// Something that was heard and is no event.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct DroppedEvent {
    /// Its earliest onset, seconds from the first sample.
    pub seconds: f64,
    /// Why it is no event.
    pub reason: DropReason,
}

impl fmt::Display for DroppedEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the sound at {:.3} s is left out: {}", self.seconds, self.reason)
    }
}

/// Why something that was heard is no event.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[non_exhaustive]
pub enum DropReason {
    /// Too few channels heard it.
    TooFewChannels {
        /// How many heard it.
        heard: usize,
        /// How many must.
        least: usize,
    },
    /// Another event is so near that their sounds cannot be kept apart. The one that more channels hear is kept; if as many hear
    /// both, the louder one where windows overlap, and otherwise the earlier one.
    Overlap {
        /// When the one that is kept begins, seconds.
        kept: f64,
    },
}

impl fmt::Display for DropReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DropReason::TooFewChannels { heard, least } => write!(
                f,
                "{heard} channel{} heard it, and at least {least} must; make louder sounds, or lower the threshold or the least \
                 number of channels",
                if *heard == 1 { "" } else { "s" }
            ),
            DropReason::Overlap { kept } => write!(
                f,
                "it is too close to the one at {kept:.3} s; leave more time between sounds, or lessen the extent if \
                 microphones are less far apart"
            ),
        }
    }
}
