//! Why no events can be looked for.

use thiserror::Error;

use crate::error::ReadError;
use crate::signal::SignalError;

/// Why events cannot be looked for, or read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum EventError {
    /// A recording cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The signal cannot be looked for.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// No recordings were given.
    #[error("there are no recordings; give at least one file")]
    NoRecordings,
    /// A number is outside its range.
    #[error("{name} must be {range}, not {value}")]
    Range {
        /// Name of the option.
        name: &'static str,
        /// The allowed range.
        range: &'static str,
        /// The given value.
        value: f64,
    },
    /// Sounds would take too long from one microphone to another.
    #[error(
        "sound takes {seconds} s over {extent} m, more than {most} s; lessen the extent to the greatest distance of two \
         microphones, or check the speed"
    )]
    Spread {
        /// The extent, metres.
        extent: f64,
        /// How long sound takes over it, seconds.
        seconds: f64,
        /// How long it may take, seconds.
        most: f64,
    },
    /// A dead time in which not all channels have heard an event.
    #[error(
        "the dead time is {dead_time} s, less than the {spread} s that sound takes over the extent; lengthen it, or lessen the \
         extent to the greatest distance of two microphones"
    )]
    DeadTime {
        /// The dead time, seconds.
        dead_time: f64,
        /// How long sound takes over the extent, seconds.
        spread: f64,
    },
    /// A sample rate that is too low for the band.
    #[error(
        "{file}: at {sample_rate} Hz there are no frequencies above {upper} Hz, and the band begins at {lower} Hz; lower its \
         beginning to less than {limit} Hz, or leave this file out"
    )]
    Band {
        /// The file.
        file: String,
        /// Samples per second, Hz.
        sample_rate: u32,
        /// Up to where frequencies can be used, Hz.
        upper: f64,
        /// Where the band begins, Hz.
        lower: f64,
        /// Below what it must begin, Hz.
        limit: f64,
    },
    /// Fewer channels than an event must be heard by.
    #[error(
        "the recordings have {found} channels, and events must be heard by {least}; give all files of the recorder, or lessen \
         the least number of channels"
    )]
    Channels {
        /// Channels of all files.
        found: usize,
        /// Channels that must hear an event.
        least: usize,
    },
    /// Other files than those in which the events were found.
    #[error(
        "{file}: channel {channel} at {sample_rate} Hz is not where the events were found; give the same files in the same \
         order, or find the events again"
    )]
    OtherFiles {
        /// The file, or `the end of the list` if files are missing.
        file: String,
        /// Number of the channel among those of all files, from 1.
        channel: usize,
        /// Samples per second, Hz.
        sample_rate: u32,
    },
    /// Events whose windows are not one after the other.
    #[error(
        "the window of event {event}, {begin} to {end} s, does not come after those before it; leave events in the order in \
         which they were found"
    )]
    Order {
        /// Number of the event, from 1.
        event: usize,
        /// Where its window begins, seconds.
        begin: f64,
        /// Where its window ends, seconds.
        end: f64,
    },
}
