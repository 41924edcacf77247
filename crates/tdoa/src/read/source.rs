//! Files opened, and text of a bounded size read from them.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use super::error::{MAX_BYTES, ReadError};
use super::latin;

/// Whether a file is read as a .mat file, by its name.
pub fn is_mat(path: &Path) -> bool {
    has_extension(path, "mat")
}

pub(super) fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

pub(super) fn open(path: &Path, file: &str) -> Result<BufReader<File>, ReadError> {
    let io = |source| ReadError::Io { file: file.to_string(), source };
    let meta = std::fs::metadata(path).map_err(io)?;
    if meta.is_dir() {
        return Err(ReadError::Directory { file: file.to_string() });
    }
    // Said before a byte is read.
    if meta.len() > MAX_BYTES {
        return Err(ReadError::TooLarge { file: file.to_string() });
    }
    Ok(BufReader::new(File::open(path).map_err(io)?))
}

/// The whole text, of UTF-8, of UTF-16 with a byte order mark, or of Latin-1 as Windows has it. A file
/// that is no text is refused at its first bad block, so that garbage is not read to its end.
pub(super) fn text(mut source: impl Read, file: &str) -> Result<String, ReadError> {
    let mut bytes = Vec::new();
    let mut checked = 0;
    let mut block = vec![0u8; 1 << 16];
    let mut wide = None;
    let mut is_latin = false;
    loop {
        let count = match source.read(&mut block) {
            Ok(count) => count,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(source) => return Err(ReadError::Io { file: file.to_string(), source }),
        };
        if bytes.len() as u64 + count as u64 > MAX_BYTES {
            return Err(ReadError::TooLarge { file: file.to_string() });
        }
        let first = bytes.is_empty();
        bytes.extend_from_slice(&block[..count]);
        if first {
            wide = Wide::of(&bytes);
            if [&b"PK\x03\x04"[..], b"\xd0\xcf\x11\xe0"].iter().any(|magic| bytes.starts_with(magic)) {
                return Err(ReadError::Packed { file: file.to_string() });
            }
        }
        let not_text = |upto: usize, bytes: &[u8]| ReadError::NotText {
            file: file.to_string(),
            line: 1 + bytes[..upto].iter().filter(|&&b| b == b'\n').count() as u64,
        };
        if is_latin {
            checked = latin::check(&bytes, checked).map_err(|at| not_text(at, &bytes))?;
        } else if wide.is_none() {
            match std::str::from_utf8(&bytes[checked..]) {
                Ok(part) => {
                    if let Some(at) = part.find('\0') {
                        return Err(not_text(checked + at, &bytes));
                    }
                    checked = bytes.len();
                }
                Err(error) => {
                    checked += error.valid_up_to();
                    // A character cut off at the end of a block is completed by the next.
                    if error.error_len().is_some() || count == 0 {
                        // What comes before is UTF-8 to the end of the file, or Latin-1 from its beginning.
                        let bad = checked;
                        checked = latin::check(&bytes, 0).map_err(|_| not_text(bad, &bytes))?;
                        is_latin = true;
                    }
                }
            }
        }
        if count == 0 {
            break;
        }
    }
    if let Some(wide) = wide {
        return wide.decode(&bytes[2..]).map_err(|line| ReadError::NotText { file: file.to_string(), line });
    }
    if is_latin {
        return Ok(latin::decode(&bytes));
    }
    let text = String::from_utf8(bytes).map_err(|_| ReadError::NotText { file: file.to_string(), line: 1 })?;
    // Spreadsheets write a byte order mark.
    Ok(text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text))
}

/// What a source without an extension holds, by how it begins.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Form {
    Npy,
    Mat,
    Text,
}

/// The form of a source of this name, and the source from its beginning on.
///
/// # Errors
/// If it cannot be read.
pub(super) fn form<R: Read>(mut source: R, path: &Path, file: &str) -> Result<(Form, impl Read + use<R>), ReadError> {
    let mut start = Vec::new();
    let by_name = if has_extension(path, "npy") {
        Some(Form::Npy)
    } else if is_mat(path) {
        Some(Form::Mat)
    } else {
        let read = source.by_ref().take(10).read_to_end(&mut start);
        read.map_err(|source| ReadError::Io { file: file.to_string(), source })?;
        None
    };
    let by_start = || match start.as_slice() {
        [0x93, b'N', b'U', b'M', b'P', b'Y', ..] => Form::Npy,
        _ if start.starts_with(b"MATLAB 5.0") => Form::Mat,
        _ => Form::Text,
    };
    let form = by_name.unwrap_or_else(by_start);
    Ok((form, std::io::Cursor::new(start).chain(source)))
}

/// The order of the bytes of UTF-16.
#[derive(Clone, Copy)]
enum Wide {
    Little,
    Big,
}

impl Wide {
    /// What a byte order mark says.
    fn of(bytes: &[u8]) -> Option<Wide> {
        match bytes {
            [0xff, 0xfe, ..] => Some(Wide::Little),
            [0xfe, 0xff, ..] => Some(Wide::Big),
            _ => None,
        }
    }

    /// The text, or the line of what is none.
    fn decode(self, bytes: &[u8]) -> Result<String, u64> {
        let units = bytes.chunks_exact(2).map(|pair| match self {
            Wide::Little => u16::from_le_bytes([pair[0], pair[1]]),
            Wide::Big => u16::from_be_bytes([pair[0], pair[1]]),
        });
        let mut text = String::with_capacity(bytes.len() / 2);
        let line = |text: &str| 1 + text.matches('\n').count() as u64;
        for unit in char::decode_utf16(units) {
            match unit {
                Ok(character) if character != '\0' => text.push(character),
                _ => return Err(line(&text)),
            }
        }
        if bytes.len().is_multiple_of(2) { Ok(text) } else { Err(line(&text)) }
    }
}
