//! What there is in recordings: a look at every channel, before anything is made of them.

use std::path::Path;

use serde::Serialize;

use crate::error::ReadError;
use crate::recording::{BLOCK, Recording};

/// A channel of a recording.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub struct ChannelName {
    /// Path of the file.
    pub file: String,
    /// Number of the channel in this file, from 1.
    pub channel: usize,
}

/// What there is in one channel of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct ChannelSurvey {
    /// Path of the file.
    pub file: String,
    /// Number of the channel in this file, from 1.
    pub channel: usize,
    /// Samples per second, Hz.
    pub sample_rate: u32,
    /// Length of what can be read, seconds.
    pub seconds: f64,
    /// Greatest amount of a sample; 1 is full scale.
    pub peak: f64,
    /// Root mean square of the samples; 1 is full scale.
    pub rms: f64,
    /// Share of the samples, 0 to 1, that are in runs of two or more of one sign at full scale. Floats can be greater: if
    /// `peak` is, these need not be clipped.
    pub clipped: f64,
    /// Number of samples that were infinite or no numbers; they count as 0.
    pub non_finite: u64,
    /// Whether all samples are the same, as of an input with nothing connected; also if there are none.
    pub is_constant: bool,
    /// The first channel before this one with the same samples at the same rate, bit by bit. `None` if there is none,
    /// and for constant channels.
    pub same_as: Option<ChannelName>,
    /// Whether the file ends before its samples do: it was cut off, or copied in part.
    pub is_truncated: bool,
}

/// Share of clipped samples beyond which a channel is said to be clipped.
const CLIPPED: f64 = 1e-3;

impl ChannelSurvey {
    /// What is wrong with the channel, in words that follow its name.
    pub fn problems(&self) -> Vec<String> {
        let mut all = Vec::new();
        if self.is_constant {
            all.push("is silent: nothing was connected, or it was muted".to_string());
        }
        if let Some(other) = &self.same_as {
            all.push(format!("is the same as channel {} of {}; leave one of them out", other.channel, other.file));
        }
        if self.clipped > CLIPPED {
            all.push(format!("is clipped in {:.1} % of its samples; record with less gain", 100.0 * self.clipped));
        }
        if self.non_finite > 0 {
            all.push(format!("has {} samples that are no numbers; they count as 0", self.non_finite));
        }
        if self.is_truncated {
            all.push("ends before its file says that it does: the file was cut off".to_string());
        }
        all
    }
}

/// Reads recordings to the end, block by block, and says what is in each channel: of the first file, of the second,
/// and so on. Sample rates and lengths may differ.
///
/// # Errors
/// For the first file that cannot be read, or is damaged.
pub fn survey<P: AsRef<Path>>(paths: impl IntoIterator<Item = P>) -> Result<Vec<ChannelSurvey>, ReadError> {
    let mut surveys = Surveys::default();
    for path in paths {
        let mut recording = Recording::open(path)?;
        let (mut of_file, mut block) = (FileSurvey::new(&recording), Vec::new());
        while recording.read_block(BLOCK, &mut block)? > 0 {
            of_file.add(&block);
        }
        surveys.push(&recording, &of_file);
    }
    Ok(surveys.channels)
}

/// What there is in the files so far.
#[derive(Default)]
pub(crate) struct Surveys {
    pub(crate) channels: Vec<ChannelSurvey>,
    /// One a channel.
    prints: Vec<Print>,
}

impl Surveys {
    /// The next file, which has been read.
    pub(crate) fn push(&mut self, recording: &Recording, of_file: &FileSurvey) {
        let rate = recording.sample_rate();
        for ((tally, &non_finite), channel) in of_file.tallies.iter().zip(recording.non_finite()).zip(1..) {
            let print = Print(rate, tally.count, tally.hash);
            let same = self.prints.iter().position(|other| *other == print).filter(|_| !tally.is_constant);
            let name = |other: &ChannelSurvey| ChannelName { file: other.file.clone(), channel: other.channel };
            self.channels.push(ChannelSurvey {
                file: recording.file().to_owned(),
                channel,
                sample_rate: rate,
                seconds: tally.count as f64 / f64::from(rate),
                peak: tally.peak.into(),
                rms: (tally.squares / tally.count.max(1) as f64).sqrt(),
                clipped: tally.clipped as f64 / tally.count.max(1) as f64,
                non_finite,
                is_constant: tally.is_constant,
                same_as: same.and_then(|k| self.channels.get(k)).map(name),
                is_truncated: recording.is_truncated(),
            });
            self.prints.push(print);
        }
    }
}

/// By what channels are told to be the same: sample rate, number of samples, and a hash of 128 bits.
#[derive(PartialEq)]
struct Print(u32, u64, u128);

/// What is known of a file that is being read.
pub(crate) struct FileSurvey {
    /// One a channel.
    tallies: Vec<Tally>,
}

impl FileSurvey {
    /// Of a recording of which nothing has been read.
    pub(crate) fn new(recording: &Recording) -> FileSurvey {
        FileSurvey { tallies: vec![Tally::new(recording.full_scale()); recording.channels()] }
    }

    /// The next samples of each channel.
    pub(crate) fn add(&mut self, block: &[Vec<f32>]) {
        for (tally, samples) in self.tallies.iter_mut().zip(block) {
            samples.iter().for_each(|&sample| tally.add(sample));
        }
    }
}

/// What is known of the samples so far.
#[derive(Clone)]
struct Tally {
    full_scale: f32,
    count: u64,
    peak: f32,
    squares: f64,
    first: Option<f32>,
    is_constant: bool,
    clipped: u64,
    /// Sign and length of the run at full scale that is not yet over.
    run: (bool, u64),
    hash: u128,
}

impl Tally {
    fn new(full_scale: f32) -> Tally {
        Tally {
            full_scale,
            count: 0,
            peak: 0.0,
            squares: 0.0,
            first: None,
            is_constant: true,
            clipped: 0,
            run: (false, 0),
            hash: FNV_BASIS,
        }
    }

    fn add(&mut self, sample: f32) {
        self.count += 1;
        self.peak = self.peak.max(sample.abs());
        self.squares += f64::from(sample) * f64::from(sample);
        self.is_constant &= *self.first.get_or_insert(sample) == sample;
        if sample.abs() < self.full_scale {
            self.run.1 = 0;
        } else {
            let is_negative = sample < 0.0;
            self.run = (is_negative, if self.run.0 == is_negative { self.run.1 + 1 } else { 1 });
            // The second sample makes the first one a clipped one too.
            self.clipped += match self.run.1 {
                1 => 0,
                2 => 2,
                _ => 1,
            };
        }
        self.hash = (self.hash ^ u128::from(sample.to_bits())).wrapping_mul(FNV_PRIME);
    }
}

// FNV-1a with 128 bits, of Fowler, Noll and Vo (RFC 9923), over samples in the place of bytes.
const FNV_BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
const FNV_PRIME: u128 = (1 << 88) + (1 << 8) + 0x3b;

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(samples: &[f32]) -> Tally {
        let mut tally = Tally::new(0.75);
        samples.iter().for_each(|&sample| tally.add(sample));
        tally
    }

    #[test]
    fn runs_of_one_sign_at_full_scale_are_clipped() {
        for (samples, clipped) in [
            (&[][..], 0),
            (&[1.0, 0.0, 1.0], 0),
            (&[1.0, -1.0, 1.0], 0),
            (&[0.75, 0.75, 0.0], 2),
            (&[1.0, 1.0, 1.0, -1.0, -1.0, 0.7, 0.7], 5),
        ] {
            assert_eq!(tally(samples).clipped, clipped, "{samples:?}");
        }
    }

    #[test]
    fn one_other_sample_makes_another_channel() {
        let samples = [0.5, 0.25, -0.5, 0.0];
        let same = tally(&samples).hash;
        assert_eq!(tally(&samples).hash, same);
        assert_ne!(tally(&[0.5, 0.25, -0.5, f32::MIN_POSITIVE]).hash, same);
        assert_ne!(tally(&[0.25, 0.5, -0.5, 0.0]).hash, same);
    }
}
