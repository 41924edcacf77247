//! What is said of a channel.

use serde::Serialize;

/// How strong the direct sound is at least beside the strongest echo: 10 dB weaker.
pub(super) const STRONG: f64 = 0.316;

/// Times of a channel, beside another one or its signal, that are kept.
pub(super) const PEAKS: usize = 4;

/// When an event begins in a channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Arrival {
    /// Time by the recorder's clock, seconds: of the beginning of a signal that is known; of other sounds, what all channels
    /// have in common is not determined better than the leading edge.
    pub seconds: f64,
    /// Standard deviation, seconds, but for what all channels have in common: from the noise and echoes that are mixed with
    /// the sound, and from how far the pairs of channels disagree.
    pub sigma: f64,
    /// Times that fit the other channels less well, as of echoes, likeliest first, seconds.
    pub alternatives: Vec<f64>,
}
