//! WAV files are written.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use thiserror::Error;

use crate::format::{self, MAX_CHANNELS, MAX_SAMPLE_RATE};

/// How samples are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum SampleFormat {
    /// Integers of 16 bits. Samples outside [-1, 1) become the greatest or least one.
    Int16,
    /// Integers of 24 bits. Samples outside [-1, 1) become the greatest or least one.
    Int24,
    /// Floats of 32 bits, as they are.
    Float32,
}

impl SampleFormat {
    fn bytes(self) -> usize {
        match self {
            SampleFormat::Int16 => 2,
            SampleFormat::Int24 => 3,
            SampleFormat::Float32 => 4,
        }
    }

    fn write(self, writer: &mut impl Write, sample: f32) -> io::Result<()> {
        // Numbers that are none become zero.
        let integer = |scale: f64| (f64::from(sample) * scale).round().clamp(-scale, scale - 1.0) as i32;
        match self {
            SampleFormat::Int16 => writer.write_all(&integer(32768.0).to_le_bytes()[..2]),
            SampleFormat::Int24 => writer.write_all(&integer(8_388_608.0).to_le_bytes()[..3]),
            SampleFormat::Float32 => writer.write_all(&sample.to_le_bytes()),
        }
    }
}

/// Why a recording cannot be written.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The file cannot be written.
    #[error("{file}: {source}; check the path, its permissions, and whether the disk is full")]
    Io {
        /// The file.
        file: String,
        /// The system's reason.
        source: io::Error,
    },
    /// No channels, too many, or a sample rate that cannot be read again.
    #[error(
        "{file}: cannot have {channels} channels at {sample_rate} Hz; give 1 to {MAX_CHANNELS} channels at 1 to \
         {MAX_SAMPLE_RATE} Hz"
    )]
    Format {
        /// The file.
        file: String,
        /// Number of channels.
        channels: usize,
        /// Samples per second, Hz.
        sample_rate: u32,
    },
    /// Channels of different lengths.
    #[error("{file}: channel {channel} has {found} samples and the first one {expected}; make them equally long")]
    Lengths {
        /// The file.
        file: String,
        /// Number of the channel, from 1.
        channel: usize,
        /// Its samples.
        found: usize,
        /// Samples of the first channel.
        expected: usize,
    },
    /// More than a WAV file can have.
    #[error("{file}: would have more than 4 GB; write fewer channels to a file, or shorter ones")]
    TooLarge {
        /// The file.
        file: String,
    },
}

/// Bytes before the samples, without those of the first chunk's name and size.
const HEADER: u32 = 72;

/// Writes a WAV file: one slice of samples a channel, all equally long, 1 being full scale; the sample rate in Hz. A file
/// that is there already is replaced.
///
/// # Errors
/// If the channels do not fit together, are too many or too long for a WAV file, or the file cannot be written; a part
/// of it may be there then.
pub fn write_wav<C: AsRef<[f32]>>(
    path: impl AsRef<Path>,
    sample_rate: u32,
    channels: &[C],
    samples: SampleFormat,
) -> Result<(), WriteError> {
    let path = path.as_ref();
    let file = || path.display().to_string();
    if format::problem(channels.len(), sample_rate).is_some() {
        return Err(WriteError::Format { file: file(), channels: channels.len(), sample_rate });
    }
    let channels: Vec<&[f32]> = channels.iter().map(AsRef::as_ref).collect();
    let frames = channels.first().map_or(0, |channel| channel.len());
    if let Some(k) = channels.iter().position(|channel| channel.len() != frames) {
        let found = channels[k].len();
        return Err(WriteError::Lengths { file: file(), channel: k + 1, found, expected: frames });
    }
    let size = frames.checked_mul(channels.len() * samples.bytes()).and_then(|size| u32::try_from(size).ok());
    let Some(size) = size.filter(|size| *size < u32::MAX - HEADER - 1) else {
        return Err(WriteError::TooLarge { file: file() });
    };
    let write = || -> io::Result<()> {
        let mut writer = BufWriter::with_capacity(1 << 16, File::create(path)?);
        header(&mut writer, sample_rate, channels.len() as u16, size, frames as u32, samples)?;
        for k in 0..frames {
            for channel in &channels {
                samples.write(&mut writer, channel[k])?;
            }
        }
        if size % 2 == 1 {
            writer.write_all(&[0])?;
        }
        writer.flush()
    };
    write().map_err(|source| WriteError::Io { file: file(), source })
}

/// The chunks before the samples. WAVE_FORMAT_EXTENSIBLE is for any number of channels and bits.
fn header(
    writer: &mut impl Write,
    sample_rate: u32,
    channels: u16,
    size: u32,
    frames: u32,
    samples: SampleFormat,
) -> io::Result<()> {
    let bytes = samples.bytes() as u16;
    let frame = channels * bytes;
    writer.write_all(b"RIFF")?;
    writer.write_all(&(HEADER + size + size % 2).to_le_bytes())?;
    writer.write_all(b"WAVEfmt \x28\0\0\0\xfe\xff")?;
    writer.write_all(&channels.to_le_bytes())?;
    writer.write_all(&sample_rate.to_le_bytes())?;
    // Only told, not needed: it may be too large for its four bytes.
    writer.write_all(&sample_rate.saturating_mul(frame.into()).to_le_bytes())?;
    writer.write_all(&frame.to_le_bytes())?;
    writer.write_all(&(8 * bytes).to_le_bytes())?;
    // 22 more bytes; the bits that count; channels at no particular places.
    writer.write_all(&22_u16.to_le_bytes())?;
    writer.write_all(&(8 * bytes).to_le_bytes())?;
    writer.write_all(&0_u32.to_le_bytes())?;
    writer.write_all(&[if samples == SampleFormat::Float32 { 3 } else { 1 }, 0])?;
    writer.write_all(b"\0\0\0\0\x10\0\x80\0\0\xaa\0\x38\x9b\x71")?;
    writer.write_all(b"fact\x04\0\0\0")?;
    writer.write_all(&frames.to_le_bytes())?;
    writer.write_all(b"data")?;
    writer.write_all(&size.to_le_bytes())
}
