//! Sounds in recordings, such as claps, knocks, shots and chirps: which there are, and when each channel begins to hear
//! them. It is the step before arrival times are measured.
//!
//! Where to look: find.rs has the steps. A file is read once (`file`): each channel passes a filter (`filter`) and becomes
//! an envelope of about 1000 numbers a second (`envelope`), in which onsets rise from a noise floor (`floor`, `detector`).
//! Onsets of all channels make events (`grouping`). A second reading hands out the samples of each event (`windows`).

mod detector;
mod envelope;
mod error;
mod event;
mod file;
mod filter;
mod find;
mod floor;
mod grouping;
mod options;
mod windows;

pub use error::EventError;
pub use event::{DropReason, DroppedEvent, Event, EventChannel, Events, Onset};
pub use find::find_events;
pub(crate) use find::{events_of, hear};
pub use options::EventOptions;
pub(crate) use windows::watched_windows;
pub use windows::{ChannelSamples, EventSamples, EventWindows, event_windows};
