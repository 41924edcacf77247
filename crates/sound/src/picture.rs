//! Pictures of recordings, as SVG to be put into a page.

mod bitmap;
mod escape;
mod spectrogram;
mod waveforms;

pub use spectrogram::spectrogram;
pub use waveforms::{Trace, waveforms};
