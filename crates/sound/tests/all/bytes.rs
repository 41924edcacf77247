//! WAV files made by hand, byte by byte.

use std::io::Cursor;

use sound::{ReadError, Recording};

/// A header of 16 bytes for samples of this kind.
pub(crate) fn format(tag: u16, channels: u16, rate: u32, bits: u16) -> Vec<u8> {
    let align = channels.wrapping_mul(bits.div_ceil(8));
    let mut bytes = Vec::new();
    bytes.extend(tag.to_le_bytes());
    bytes.extend(channels.to_le_bytes());
    bytes.extend(rate.to_le_bytes());
    bytes.extend(rate.wrapping_mul(align.into()).to_le_bytes());
    bytes.extend(align.to_le_bytes());
    bytes.extend(bits.to_le_bytes());
    bytes
}

/// WAVE_FORMAT_EXTENSIBLE: its own tag is in the name of the encoding, 16 bytes.
pub(crate) fn extensible(tag: u16, channels: u16, rate: u32, bits: u16, valid: u16) -> Vec<u8> {
    let mut bytes = format(0xfffe, channels, rate, bits);
    bytes.extend(22_u16.to_le_bytes());
    bytes.extend(valid.to_le_bytes());
    bytes.extend(0_u32.to_le_bytes());
    bytes.extend(tag.to_le_bytes());
    bytes.extend(*b"\x00\x00\x00\x00\x10\x00\x80\x00\x00\xaa\x00\x38\x9b\x71");
    bytes
}

/// A chunk with its size, made even.
pub(crate) fn chunk(name: &[u8; 4], content: &[u8]) -> Vec<u8> {
    let mut bytes = name.to_vec();
    bytes.extend((content.len() as u32).to_le_bytes());
    bytes.extend(content);
    bytes.resize(bytes.len().next_multiple_of(2), 0);
    bytes
}

/// A file of chunks.
pub(crate) fn riff(chunks: &[Vec<u8>]) -> Vec<u8> {
    let content = [b"WAVE".to_vec(), chunks.concat()].concat();
    chunk(b"RIFF", &content)
}

/// A whole file with these samples.
pub(crate) fn wav(format: &[u8], samples: &[u8]) -> Vec<u8> {
    riff(&[chunk(b"fmt ", format), chunk(b"data", samples)])
}

/// Opens bytes as a file: its length is known.
pub(crate) fn open(bytes: &[u8]) -> Result<Recording, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    std::fs::write(&path, bytes).unwrap();
    Recording::open(path)
}

/// Opens bytes that come from somewhere.
pub(crate) fn stream(bytes: &[u8]) -> Result<Recording, ReadError> {
    Recording::from_reader("stream", Cursor::new(bytes.to_vec()))
}

/// The samples of bytes, which are the same as a file and as a stream.
pub(crate) fn samples(bytes: &[u8]) -> Vec<Vec<f32>> {
    let all = open(bytes).unwrap().read_to_end().unwrap();
    assert_eq!(stream(bytes).unwrap().read_to_end().unwrap(), all);
    all
}

/// What is said of bytes that cannot be read.
pub(crate) fn refusal(bytes: &[u8]) -> String {
    let said = open(bytes).map(|_| ()).unwrap_err().to_string();
    assert!(said.contains("a.wav: "), "{said}");
    assert!(stream(bytes).is_err());
    said
}
