//! Bytes at a position in a file.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Writes bytes at this place.
pub(crate) fn write_at(file: &mut File, place: u64, bytes: &[u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(place))?;
    file.write_all(bytes)
}

/// Reads from this place until `bytes` are full or the file ends; how many there were.
pub(crate) fn read_at(file: &mut File, place: u64, bytes: &mut [u8]) -> io::Result<usize> {
    file.seek(SeekFrom::Start(place))?;
    let mut read = 0;
    while read < bytes.len() {
        match file.read(&mut bytes[read..]) {
            Ok(0) => break,
            Ok(more) => read += more,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(read)
}
