//! Recordings of sound: read block by block, and surveyed.
//!
//! [`Recording`] reads WAV and FLAC of any length in little memory, and says clearly what is wrong with files that
//! cannot be read. [`survey`] looks at every channel of several files: is it silent, clipped, cut off, the same as
//! another one?
//!
//! ```
//! # let folder = std::env::temp_dir().join(format!("sound-front-page-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! # let path = folder.join("a.wav");
//! # let mut bytes = b"RIFF\x2c\0\0\0WAVEfmt \x10\0\0\0\x01\0\x02\0\x40\x1f\0\0\0\x7d\0\0\x04\0\x10\0data\x08\0\0\0".to_vec();
//! # bytes.extend(b"\0\x40\0\0\0\xc0\0\0");
//! # std::fs::write(&path, bytes)?;
//! let mut recording = sound::Recording::open(&path)?;
//! println!("{} channels at {} Hz", recording.channels(), recording.sample_rate());
//! let mut block = Vec::new();
//! while recording.read_block(4096, &mut block)? > 0 {
//!     let first: &[f32] = &block[0];
//!     assert_eq!(first, [0.5, -0.5]);
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
//! them its bytes.

mod error;
mod flac;
mod format;
mod input;
mod kind;
mod recording;
mod survey;
mod wav;

pub use error::ReadError;
pub use format::{MAX_CHANNELS, MAX_SAMPLE_RATE};
pub use recording::Recording;
pub use survey::{ChannelName, ChannelSurvey, survey};
