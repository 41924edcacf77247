//! How samples are stored, from the chunk `fmt `: WAVEFORMAT and WAVEFORMATEXTENSIBLE of Microsoft's
//! mmreg.h.

use super::samples::Decoder;
use crate::error::ReadError;
use crate::format;

/// Bytes of WAVEFORMATEXTENSIBLE, the longest format that says something of integers and floats.
pub(super) const LONGEST: usize = 40;

/// How samples are stored.
#[derive(Debug, PartialEq)]
pub(super) struct Encoding {
    pub(super) channels: usize,
    /// Hz.
    pub(super) sample_rate: u32,
    pub(super) decoder: Decoder,
    /// Bytes of a sample of all channels.
    pub(super) frame_bytes: usize,
    /// The least amount of a sample that may stand for a greater one.
    pub(super) full_scale: f32,
}

const INTEGER: u16 = 1;
const FLOAT: u16 = 3;
const EXTENSIBLE: u16 = 0xfffe;

/// All but the first two bytes of the long names of encodings that have a number.
const NUMBERED: [u8; 14] = [0, 0, 0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71];

/// Reads the chunk.
///
/// # Errors
/// If it is too short, says what cannot be, or names an encoding that is not read.
pub(super) fn parse(chunk: &[u8], file: &str) -> Result<Encoding, ReadError> {
    let bad = |problem: String| ReadError::Header { file: file.to_owned(), problem };
    let (short, _) = chunk.as_chunks::<2>();
    let word = |k: usize| short.get(k).map(|&pair| u16::from_le_bytes(pair));
    let (Some(tag), Some(channels), Some(low), Some(high), Some(align), Some(bits)) =
        (word(0), word(1), word(2), word(3), word(6), word(7))
    else {
        return Err(bad("the format of its samples is too short".into()));
    };
    let sample_rate = u32::from(high) << 16 | u32::from(low);
    let channels = usize::from(channels);
    let (tag, valid) = if tag == EXTENSIBLE {
        let (Some(valid), Some(tag)) = (word(9), word(12)) else {
            return Err(bad("the format of its samples is too short".into()));
        };
        if chunk.get(26..40) != Some(&NUMBERED) {
            let encoding = "an encoding that has no number (WAVE_FORMAT_EXTENSIBLE)".into();
            return Err(ReadError::Encoding { file: file.to_owned(), encoding });
        }
        // Zero bits, and more than there are, stand for all.
        (tag, if valid == 0 || valid > bits { bits } else { valid })
    } else {
        (tag, bits)
    };
    let decoder = match (tag, bits) {
        (INTEGER, 1..=8) => Decoder::Integer8,
        (INTEGER, 9..=16) => Decoder::Integer16,
        (INTEGER, 17..=24) => Decoder::Integer24,
        (INTEGER, 25..=32) => Decoder::Integer32,
        (FLOAT, 32) => Decoder::Float32,
        (FLOAT, 64) => Decoder::Float64,
        (INTEGER | FLOAT, 0) => return Err(bad("its header says that samples have 0 bits".into())),
        _ => return Err(ReadError::Encoding { file: file.to_owned(), encoding: name(tag, bits) }),
    };
    if let Some(problem) = format::problem(channels, sample_rate) {
        return Err(bad(problem));
    }
    // At most 1024 channels of 8 bytes.
    let frame_bytes = channels * decoder.bytes();
    if usize::from(align) != frame_bytes {
        return Err(bad(format!(
            "its header says that {channels} channels of {bits} bits take {align} bytes, not {frame_bytes}"
        )));
    }
    let full_scale = if tag == FLOAT { 1.0 } else { format::full_scale(u32::from(valid)) };
    Ok(Encoding { channels, sample_rate, decoder, frame_bytes, full_scale })
}

/// Name of an encoding that is not read.
fn name(tag: u16, bits: u16) -> String {
    let name = match tag {
        INTEGER => return format!("integers of {bits} bits"),
        FLOAT => return format!("floats of {bits} bits"),
        0x0002 => "Microsoft ADPCM",
        0x0006 => "A-law",
        0x0007 => "mu-law",
        0x0011 => "IMA ADPCM",
        0x0031 => "GSM 6.10",
        0x0040 => "G.721 ADPCM",
        0x0050 => "MPEG audio",
        0x0055 => "MP3",
        0x0092 | 0x2000 => "AC-3",
        0x00ff | 0x1600..=0x1602 => "AAC",
        0x0160..=0x0163 => "Windows Media Audio",
        _ => return format!("the unknown encoding {tag:#06x}"),
    };
    name.to_owned()
}
