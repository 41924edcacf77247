//! Recordings of sound: read block by block, and surveyed; and simulated ones, in rooms with echoes.
//!
//! [`Recording`] reads WAV and FLAC of any length in little memory, and says clearly what is wrong with files that
//! cannot be read. [`survey`] looks at every channel of several files: is it silent, clipped, cut off, the same as
//! another one? [`find_events`] finds the claps in them, and which channel hears them when. [`simulate_room`] makes recordings of which everything is known, and [`write_wav`] writes them.
//!
//! ```
//! let mut options = sound::RoomOptions::default();
//! options.microphones = sound::Placement::Random(2);
//! options.sources = sound::Placement::Random(3);
//! let simulated = sound::simulate_room(&options)?;
//! # let folder = std::env::temp_dir().join(format!("sound-front-page-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! # let path = folder.join("claps.wav");
//! sound::write_wav(&path, 48000, &simulated.channels, sound::SampleFormat::Int24)?;
//!
//! let mut recording = sound::Recording::open(&path)?;
//! assert_eq!((recording.channels(), recording.sample_rate()), (2, 48000));
//! let mut block = Vec::new();
//! while recording.read_block(4096, &mut block)? > 0 {
//!     let first: &[f32] = &block[0];
//!     assert!(first.iter().all(|sample| sample.abs() < 0.6));
//! }
//! for channel in sound::survey([&path])? {
//!     if channel.is_constant {
//!         println!("channel {} of {} is silent", channel.channel, channel.file);
//!     }
//! }
//! # std::fs::remove_dir_all(folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Where to look: `recording` is the entry; `kind` tells what a file is, `wav` and `flac` read it, and `input` gives
//! them its bytes. Rooms begin with room/simulation.rs: options are checked (`check`), points and times drawn
//! (`placement`), sounds made (`waveform`), and laid on the way to each microphone (`response`) with its echoes
//! (`images`), each at its fraction of a sample (`kernel`). Arrival times begin with times/arrivals.rs: a leading edge
//! in each channel (`edge`), delays between each two (`spectrum`, `correlation`), those that agree (`consistent`), the
//! direct sound in each channel (`direct`), which is the first of its ways (`paths`), and how well its time is known
//! (`deviation`). A known `signal` is made a pulse (signal/compression.rs), whose time each channel tells
//! alone (times/known.rs). Events begin with events/find.rs, those of recorders that were started apart with
//! recorders/gathered.rs, and `listen` puts all together, watched by a `monitor`; `picture` draws them. Several of
//! these use `fourier`, `biquad`, `fade` and `quantile`.

mod air;
mod biquad;
mod error;
mod events;
mod fade;
mod flac;
mod format;
mod fourier;
mod input;
mod kernel;
mod kind;
mod listen;
mod monitor;
mod picture;
mod quantile;
mod recorders;
mod recording;
mod room;
mod signal;
mod survey;
mod times;
mod wav;
mod write;

pub use air::speed_of_sound;
pub use error::ReadError;
pub use events::{
    ChannelSamples, DropReason, DroppedEvent, Event, EventChannel, EventError, EventOptions, EventSamples,
    EventWindows, Events, Onset, event_windows, find_events,
};
pub use format::{MAX_CHANNELS, MAX_SAMPLE_RATE};
pub use listen::{Heard, ListenError, ListenOptions, listen, listen_watched};
pub use monitor::{ListenMonitor, ListenProgress};
pub use picture::{Trace, spectrogram, waveforms};
pub use recorders::{Alignment, AlignmentOptions, RecorderAlignment, Unaligned, UnalignedReason};
pub use recording::Recording;
pub use room::{
    Decay, Obstacle, Placement, Recorder, RoomError, RoomOptions, RoomRecording, RoomTruth, Sound, simulate_room,
};
pub use signal::{Signal, SignalError, TemplateError};
pub use survey::{ChannelName, ChannelSurvey, survey};
pub use times::{Arrival, TimeError, TimeOptions, Window, arrival_times};
pub use write::{SampleFormat, WriteError, write_wav};
