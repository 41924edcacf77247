//! Simulated recordings in a room with flat walls at right angles, a shoebox, by the image source method: J. B. Allen
//! and D. A. Berkley, Image method for efficiently simulating small-room acoustics, J. Acoust. Soc. Am. 65, 1979.

mod check;
mod error;
mod images;
mod options;
mod placement;
mod response;
mod simulation;
mod walls;
mod waveform;

pub use error::RoomError;
pub use options::{Decay, Obstacle, Placement, Recorder, RoomOptions, Sound};
pub use simulation::{RoomRecording, RoomTruth, simulate_room};
