//! Pictures of recordings, as SVG to be put into a page.

mod spectrogram;
mod waveforms;

pub use spectrogram::spectrogram;
pub use waveforms::{Trace, waveforms};

/// Text as it may stand in SVG.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
