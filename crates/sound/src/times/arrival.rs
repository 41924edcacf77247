//! What is said of a channel.

use serde::Serialize;

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
    /// the sound. Where it is in doubt which of several times is that of the direct sound, it is how far these are apart.
    pub sigma: f64,
    /// Other times at which the channel may hear the sound, as those of echoes, the strongest first, seconds.
    pub alternatives: Vec<f64>,
}
