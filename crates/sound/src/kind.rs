//! What a file is, by its first bytes: names of files are often wrong.

use crate::error::ReadError;
use crate::input::Input;

/// A kind of file that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Wav,
    Flac,
}

/// Length of an ID3 tag's header.
const ID3_HEADER: usize = 10;

/// Tells what a file is. A tag before FLAC, which some programs write, is left out.
///
/// # Errors
/// If it is neither WAV nor FLAC, with what it seems to be, or cannot be read.
pub(crate) fn kind(input: &mut Input) -> Result<Kind, ReadError> {
    let head = input.look_ahead(64)?.to_vec();
    if head.is_empty() {
        return Err(ReadError::Empty { file: input.file.clone() });
    }
    let tag = id3_length(&head);
    let head = match tag {
        None => head,
        Some(length) => {
            input.skip(length)?;
            input.look_ahead(4)?.to_vec()
        }
    };
    match head.get(..4) {
        Some(b"RIFF" | b"RF64" | b"BW64") => Ok(Kind::Wav),
        Some(b"fLaC") => Ok(Kind::Flac),
        _ => {
            let (found, remedy) = if tag.is_some() { MP3 } else { other(&head) };
            Err(ReadError::NotARecording { file: input.file.clone(), found, remedy })
        }
    }
}

const CONVERT: &str = "convert it, for instance with `ffmpeg -i IN OUT.wav`";
const MP3: (&str, &str) = ("an MP3 file", CONVERT);

/// Length of an ID3 tag with its header, if there is one.
fn id3_length(head: &[u8]) -> Option<u64> {
    let header = head.get(..ID3_HEADER).filter(|header| header.starts_with(b"ID3"))?;
    let size = header[6..].iter().fold(0, |size, byte| size << 7 | u64::from(byte & 0x7f));
    // A footer repeats the header.
    let footer = if header[5] & 0x10 == 0 { 0 } else { ID3_HEADER as u64 };
    Some(ID3_HEADER as u64 + size + footer)
}

/// What a file is that cannot be read, and what to do.
fn other(head: &[u8]) -> (&'static str, &'static str) {
    let inner = head.get(4..8).unwrap_or_default();
    if head.starts_with(b"RIFX") || head.starts_with(b"FFIR") {
        ("WAV with the bytes of numbers in the other order (RIFX)", CONVERT)
    } else if head.starts_with(b"riff") {
        ("Sony Wave64 (.w64)", CONVERT)
    } else if head.starts_with(b"FORM") {
        ("AIFF", CONVERT)
    } else if head.starts_with(b"OggS") {
        ("an Ogg file", CONVERT)
    } else if head.starts_with(b"caff") {
        ("a CAF file", CONVERT)
    } else if head.starts_with(b"wvpk") {
        ("a WavPack file", CONVERT)
    } else if head.starts_with(b".snd") {
        ("an AU file", CONVERT)
    } else if inner == b"ftyp" {
        ("an MP4, M4A or MOV file", CONVERT)
    } else if head.starts_with(&[0x1a, 0x45, 0xdf, 0xa3]) {
        ("a Matroska or WebM file", CONVERT)
    } else if head.len() > 2 && head[0] == 0xff && head[1] & 0xe0 == 0xe0 {
        MP3
    } else if head.starts_with(b"PK\x03\x04") {
        ("a ZIP archive", "unpack it and give the recordings in it")
    } else if head.iter().all(|&byte| byte == b'\t' || byte == b'\n' || byte == b'\r' || (32..127).contains(&byte)) {
        ("text", "give the recording that it should be")
    } else if head.iter().all(|&byte| byte == 0) {
        ("zeros where its header should be", "copy it from the recorder again")
    } else {
        ("of an unknown kind", CONVERT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(bytes: &[u8]) -> Result<Kind, String> {
        let mut input = Input::new("f".into(), Box::new(std::io::Cursor::new(bytes.to_vec())), None);
        kind(&mut input).map_err(|error| error.to_string())
    }

    #[test]
    fn kinds_are_told_by_content() {
        assert_eq!(of(b"RIFF____WAVE"), Ok(Kind::Wav));
        assert_eq!(of(b"RF64____WAVE"), Ok(Kind::Wav));
        assert_eq!(of(b"fLaC____"), Ok(Kind::Flac));
        for (bytes, found) in [
            (&b"time;mic\n1;2\n"[..], "is text"),
            (b"RIFX____WAVE", "RIFX"),
            (b"FORM____AIFF", "AIFF"),
            (b"OggS\0\0", "Ogg"),
            (b"\0\0\0\x20ftypM4A ", "M4A"),
            (b"\xff\xfb\x90\x64", "MP3"),
            (&[0; 64], "zeros"),
            (&[200, 1, 2], "unknown"),
            (b"", "empty"),
        ] {
            let said = of(bytes).unwrap_err();
            assert!(said.starts_with("f: ") && said.contains(found), "{said}");
        }
    }

    #[test]
    fn a_tag_before_the_recording_is_left_out() {
        // The size has seven bits a byte: 1 * 128 + 2.
        let mut bytes = b"ID3\x04\0\0\0\0\x01\x02".to_vec();
        bytes.extend([0; 130]);
        bytes.extend(b"fLaC");
        assert_eq!(of(&bytes), Ok(Kind::Flac));
        bytes.pop();
        assert!(of(&bytes).unwrap_err().contains("MP3"));
    }
}
