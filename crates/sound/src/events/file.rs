//! The onsets in one file.

use crate::format::HIGHEST;
use crate::recording::Recording;
use crate::signal::Stream;

use super::detector::Detector;
use super::envelope::Envelope;
use super::error::EventError;
use super::event::Onset;
use super::options::EventOptions;

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

/// Reads a recording to its end, this many samples of each channel at a time, which are passed to `look`, and finds the onsets
/// of each channel.
///
/// # Errors
/// If the sample rate is too low for the band, the signal has too little in it, or the file cannot be read.
pub(super) fn file_onsets(
    recording: &mut Recording,
    options: &EventOptions,
    block_length: usize,
    mut look: impl FnMut(&[Vec<f32>]),
) -> Result<FileOnsets, EventError> {
    let (file, sample_rate) = (recording.file().to_owned(), recording.sample_rate());
    let (lower, highest) = (options.band[0], HIGHEST * f64::from(sample_rate));
    let upper = options.band[1].min(highest);
    if upper - lower < EventOptions::LEAST_WIDTH {
        let limit = highest - EventOptions::LEAST_WIDTH;
        return Err(EventError::Band { file, sample_rate, upper, lower, limit });
    }
    let compression = Stream::compression(&options.signal, [lower, upper], f64::from(sample_rate))?;
    let width = compression.as_ref().map_or(upper - lower, |compression| compression.width);
    let channel = |_| {
        let envelope = Envelope::new([lower, upper], width, sample_rate);
        let bin = envelope.bin_seconds(sample_rate);
        let detector = Detector::new(bin, options.floor_seconds, options.threshold);
        (compression.clone().map(Stream::new), envelope, detector)
    };
    let mut channels: Vec<(Option<Stream>, Envelope, Detector)> = (0..recording.channels()).map(channel).collect();
    let (mut block, mut compressed) = (Vec::new(), Vec::new());
    while recording.read_block(block_length, &mut block)? > 0 {
        look(&block);
        for ((stream, envelope, detector), samples) in channels.iter_mut().zip(&block) {
            let Some(stream) = stream else {
                envelope.levels(samples).for_each(|level| detector.push(level));
                continue;
            };
            stream.push(samples, &mut compressed);
            envelope.levels(&compressed).for_each(|level| detector.push(level));
            compressed.clear();
        }
    }
    let finished = |(stream, mut envelope, mut detector): (Option<Stream>, Envelope, Detector)| {
        if let Some(stream) = stream {
            stream.finish(&mut compressed);
            envelope.levels(&compressed).for_each(|level| detector.push(level));
            compressed.clear();
        }
        detector.finish()
    };
    let channels = channels.into_iter().map(finished).collect();
    Ok(FileOnsets { file, sample_rate, channels })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::room::{Placement, RoomOptions, simulate_room};
    use crate::signal::Signal;
    use crate::write::{SampleFormat, write_wav};

    #[test]
    fn blocks_of_any_size_give_the_same_onsets() {
        let (microphones, sources) = (Placement::Random(3), Placement::Random(4));
        let room = RoomOptions { microphones, sources, ..RoomOptions::default() };
        let recording = simulate_room(&room).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("claps.wav");
        write_wav(&path, recording.sample_rate, &recording.channels, SampleFormat::Float32).unwrap();
        // What is heard of a signal that is not there does not matter.
        for signal in [Signal::Unknown, Signal::Chirp { from: 1000.0, to: 6000.0, seconds: 0.01 }] {
            let options = EventOptions { signal, ..EventOptions::default() };
            let onsets =
                |block: usize| file_onsets(&mut Recording::open(&path).unwrap(), &options, block, |_| ()).unwrap();
            let expected = onsets(1 << 14);
            assert!(expected.channels.iter().all(|channel| channel.len() >= 4));
            for block in [1, 47, 1000, 1 << 20] {
                assert_eq!(onsets(block), expected);
            }
        }
    }
}
