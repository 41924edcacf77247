//! WAV: samples in a RIFF file, or in RF64 and BW64, its kin for more than 4 GB.

mod chunks;
mod encoding;
mod samples;

use crate::error::ReadError;
use crate::format::Format;
use crate::input::Input;
use chunks::Chunks;
use samples::Decoder;

/// Bytes that are read at a time, about. What is allocated follows what is there, not what a header says.
const PIECE: usize = 1 << 16;

/// The samples of a WAV file.
pub(crate) struct Wav {
    input: Input,
    pub(crate) format: Format,
    decoder: Decoder,
    /// Bytes of a sample of all channels; never 0.
    frame_bytes: usize,
    /// Bytes of samples that are still to come; `None` for all that the file has.
    left: Option<u64>,
    /// Whether the file has ended before its samples.
    pub(crate) is_truncated: bool,
    bytes: Vec<u8>,
}

impl Wav {
    /// Reads the header.
    ///
    /// # Errors
    /// If there is none, it contradicts itself, or the samples are of an unknown kind.
    pub(crate) fn new(mut input: Input) -> Result<Wav, ReadError> {
        let Chunks { encoding, data } = chunks::read(&mut input)?;
        let frame_bytes = encoding.frame_bytes;
        let there = input.remaining();
        // Whole samples only: the rest of a size that has none cannot be used.
        let said = data.map(|bytes| bytes / frame_bytes as u64);
        let present = there.map(|bytes| bytes / frame_bytes as u64);
        let is_truncated = said.zip(present).is_some_and(|(said, present)| present < said);
        let frames = match (said, present) {
            (Some(said), Some(present)) => Some(said.min(present)),
            (said, present) => said.or(present),
        };
        let format = Format {
            sample_rate: encoding.sample_rate,
            channels: encoding.channels,
            full_scale: encoding.full_scale,
            frames,
        };
        let left = said.map(|frames| frames.saturating_mul(frame_bytes as u64));
        Ok(Wav { input, format, decoder: encoding.decoder, frame_bytes, left, is_truncated, bytes: Vec::new() })
    }

    /// Appends the next samples to the channels, at most this many, and says how many: 0 at the end.
    pub(crate) fn read(&mut self, frames: usize, channels: &mut [Vec<f32>]) -> Result<usize, ReadError> {
        let piece = (PIECE / self.frame_bytes).max(1);
        let mut done = 0;
        while done < frames {
            let left = self.left.map_or(usize::MAX, |left| usize::try_from(left).unwrap_or(usize::MAX));
            let wanted = piece.min(frames - done).min(left / self.frame_bytes);
            // A piece has at most PIECE bytes, or one sample of all channels.
            self.bytes.resize(wanted * self.frame_bytes, 0);
            let filled = self.input.fill(&mut self.bytes)?;
            let whole = filled / self.frame_bytes;
            let bytes = &self.bytes[..whole * self.frame_bytes];
            self.decoder.decode(bytes, channels);
            done += whole;
            if let Some(left) = &mut self.left {
                *left = left.saturating_sub(bytes.len() as u64);
            }
            if whole < wanted {
                // A part of a sample is missing, or samples that the header says.
                self.is_truncated |= self.left.is_some() || filled % self.frame_bytes != 0;
                self.left = Some(0);
            }
            if whole < wanted || wanted == 0 {
                break;
            }
        }
        Ok(done)
    }

    /// The recording's name in messages.
    pub(crate) fn file(&self) -> &str {
        &self.input.file
    }
}
