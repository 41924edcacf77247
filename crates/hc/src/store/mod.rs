//! Rows of small records, one a path or a mixed cell, that may be far more than the solutions: what exceeds a fixed amount of memory
//! lies in a temporary file.
//!
//! A file that cannot be written is done without: the records then stay in memory.

mod records;
mod sorter;

pub(crate) use records::Records;
pub(crate) use sorter::Sorter;

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};

/// Writes bytes at this place.
fn write_at(file: &mut File, place: u64, bytes: &[u8]) -> io::Result<()> {
    file.seek(SeekFrom::Start(place))?;
    file.write_all(bytes)
}

/// Reads from this place until `bytes` are full or the file ends; how many there were.
fn read_at(file: &mut File, place: u64, bytes: &mut [u8]) -> io::Result<usize> {
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
