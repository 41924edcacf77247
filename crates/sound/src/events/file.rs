//! The onsets in one file.

use crate::recording::Recording;

use super::detector::Detector;
use super::envelope::Envelope;
use super::error::EventError;
use super::event::Onset;
use super::options::EventOptions;

/// Up to this share of the sample rate frequencies are used: recorders filter what is above.
const HIGHEST: f64 = 0.45;

/// What was heard in a file.
#[derive(Debug, PartialEq)]
pub(super) struct FileOnsets {
    /// Path of the file.
    pub(super) file: String,
    /// Hz.
    pub(super) sample_rate: u32,
    /// Of each channel, seconds from the first sample.
    pub(super) channels: Vec<Vec<Onset>>,
}

/// Reads a recording to its end, this many samples of each channel at a time, and finds the onsets of each channel.
///
/// # Errors
/// If the sample rate is too low for the band, or the file cannot be read.
pub(super) fn file_onsets(
    mut recording: Recording,
    options: &EventOptions,
    block_length: usize,
) -> Result<FileOnsets, EventError> {
    let (file, sample_rate) = (recording.file().to_owned(), recording.sample_rate());
    let (lower, highest) = (options.band[0], HIGHEST * f64::from(sample_rate));
    let upper = options.band[1].min(highest);
    if upper - lower < EventOptions::LEAST_WIDTH {
        let limit = highest - EventOptions::LEAST_WIDTH;
        return Err(EventError::Band { file, sample_rate, upper, lower, limit });
    }
    let channel = |_| {
        let envelope = Envelope::new(lower, upper, sample_rate);
        let bin = envelope.bin_seconds(sample_rate);
        (envelope, Detector::new(bin, options.floor_seconds, options.threshold))
    };
    let mut channels: Vec<(Envelope, Detector)> = (0..recording.channels()).map(channel).collect();
    let mut block = Vec::new();
    while recording.read_block(block_length, &mut block)? > 0 {
        for ((envelope, detector), samples) in channels.iter_mut().zip(&block) {
            samples.iter().filter_map(|&sample| envelope.next(sample)).for_each(|level| detector.push(level));
        }
    }
    let channels = channels.into_iter().map(|(_, detector)| detector.finish()).collect();
    Ok(FileOnsets { file, sample_rate, channels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::room::{Placement, RoomOptions, simulate_room};
    use crate::write::{SampleFormat, write_wav};

    #[test]
    fn blocks_of_any_size_give_the_same_onsets() {
        let (microphones, sources) = (Placement::Random(3), Placement::Random(4));
        let room = RoomOptions { microphones, sources, ..RoomOptions::default() };
        let recording = simulate_room(&room).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("claps.wav");
        write_wav(&path, recording.sample_rate, &recording.channels, SampleFormat::Float32).unwrap();
        let onsets =
            |block: usize| file_onsets(Recording::open(&path).unwrap(), &EventOptions::default(), block).unwrap();
        let expected = onsets(1 << 14);
        assert!(expected.channels.iter().all(|channel| channel.len() >= 4));
        for block in [1, 47, 1000, 1 << 20] {
            assert_eq!(onsets(block), expected);
        }
    }
}
