//! What is the same throughout a recording, and the limits of what is believed of it.

/// Up to this share of the sample rate frequencies are used: recorders filter what is above.
pub(crate) const HIGHEST: f64 = 0.45;

/// Most channels of a recording. Headers with more are taken to be wrong.
pub const MAX_CHANNELS: usize = 1024;

/// Highest sample rate of a recording, Hz. Headers with a higher one are taken to be wrong.
pub const MAX_SAMPLE_RATE: u32 = 10_000_000;

/// What is the same throughout a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Format {
    /// Hz.
    pub(crate) sample_rate: u32,
    pub(crate) channels: usize,
    /// The least amount of a sample that may stand for a greater one.
    pub(crate) full_scale: f32,
    /// Number of samples a channel, where it is known.
    pub(crate) frames: Option<u64>,
}

/// The greatest sample of integers with this many bits, as a share of their range.
pub(crate) fn full_scale(bits: u32) -> f32 {
    (1.0 - (0.5_f64).powi(bits as i32 - 1)) as f32
}

/// What is wrong with a number of channels or a sample rate, if anything is.
pub(crate) fn problem(channels: usize, sample_rate: u32) -> Option<String> {
    if channels == 0 {
        Some("its header says that it has no channels".into())
    } else if channels > MAX_CHANNELS {
        Some(format!("its header says that it has {channels} channels, more than {MAX_CHANNELS}"))
    } else if sample_rate == 0 || sample_rate > MAX_SAMPLE_RATE {
        Some(format!("its header says that its sample rate is {sample_rate} Hz, not 1 to {MAX_SAMPLE_RATE} Hz"))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_scale_is_the_greatest_integer() {
        assert_eq!(full_scale(8), 127.0 / 128.0);
        assert_eq!(full_scale(16), 32767.0 / 32768.0);
        assert_eq!(full_scale(24), 8_388_607.0 / 8_388_608.0);
        // Single precision has no number between.
        assert_eq!(full_scale(32), 1.0);
    }
}
