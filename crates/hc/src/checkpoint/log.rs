//! A log of records, which only grows; a length and a checksum precede each record.
//!
//! The file begins with eight bytes that identify it, the version of the format, and the checksum
//! of the header to which it belongs (little-endian, 4 bytes each). A record consists of its
//! length, a CRC-32, and its bytes. The CRC-32 covers the record's number in the log (8 bytes), its
//! length and its bytes. Because of the number, a record cannot take the place of another.

use super::error::CheckpointError;
use super::note::Note;
use crate::store::{read_at, write_at};
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

/// The first bytes of a log. They contain CR and LF, so that files which were converted as text are
/// detected.
const MAGIC: [u8; 8] = *b"hclog\r\n\x1a";
/// Bytes before the first record.
const PREAMBLE: u64 = 16;
/// Bytes before the content of a record.
const BEFORE: u64 = 8;

/// Where the content of a record is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RecordSpan {
    number: u64,
    at: u64,
    length: u32,
}

/// A log that is open.
#[derive(Debug)]
pub(super) struct Log {
    path: PathBuf,
    file: File,
    /// Bytes of the complete records, including the preamble, and the number of these records.
    end: u64,
    records: u64,
}

impl Log {
    /// A new log for the header with this checksum. It replaces a log that belongs to no header.
    ///
    /// # Errors
    /// If the file cannot be written, or is something else.
    pub(super) fn create(path: &Path, version: u32, header: u32) -> Result<Log, CheckpointError> {
        let failed = |error: io::Error| CheckpointError::io(path, &error);
        let mut file =
            File::options().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        let mut first = [0; MAGIC.len()];
        let read = read_at(&mut file, 0, &mut first).map_err(failed)?;
        if first[..read] != MAGIC[..read] {
            return Err(foreign(path));
        }
        file.set_len(0).map_err(failed)?;
        write_at(&mut file, 0, &preamble(version, header)).map_err(failed)?;
        file.sync_all().map_err(failed)?;
        Ok(Log { path: path.to_owned(), file, end: PREAMBLE, records: 0 })
    }

    /// Opens a log to continue it. Shows its records to `seen`, which says whether it can read
    /// them, and cuts off everything after the complete records.
    ///
    /// # Errors
    /// If the file cannot be read or written, or is not the log for this header.
    pub(super) fn resume(
        path: &Path,
        version: u32,
        header: u32,
        seen: impl FnMut(RecordSpan, &[u8]) -> bool,
    ) -> Result<(Log, Option<Note>), CheckpointError> {
        let failed = |error: io::Error| CheckpointError::io(path, &error);
        let mut file = File::options().read(true).write(true).open(path).map_err(failed)?;
        let scan = scan(path, &mut file, version, header, seen)?;
        if scan.note.is_some() {
            file.set_len(scan.end).and_then(|()| file.sync_all()).map_err(failed)?;
        }
        Ok((Log { path: path.to_owned(), file, end: scan.end, records: scan.records }, scan.note))
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }

    /// Adds a record. After an error the log is as before.
    pub(super) fn append(&mut self, content: &[u8]) -> io::Result<RecordSpan> {
        let length = u32::try_from(content.len()).map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge))?;
        let place = RecordSpan { number: self.records, at: self.end + BEFORE, length };
        let mut record = Vec::with_capacity(content.len() + BEFORE as usize);
        record.extend(length.to_le_bytes());
        record.extend(place.checksum(content).to_le_bytes());
        record.extend(content);
        if let Err(error) = write_at(&mut self.file, self.end, &record) {
            // What is left of it would be cut off when the log is read.
            let _ = self.file.set_len(self.end);
            return Err(error);
        }
        self.end += record.len() as u64;
        self.records += 1;
        Ok(place)
    }

    /// Waits until the records are on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }

    /// The content of a record; `None` if it no longer reads as it was written.
    pub(super) fn read(&mut self, place: RecordSpan) -> Option<Vec<u8>> {
        let mut before = [0; BEFORE as usize];
        let mut content = vec![0; place.length as usize];
        let whole = read_at(&mut self.file, place.at - BEFORE, &mut before).ok()? == before.len()
            && read_at(&mut self.file, place.at, &mut content).ok()? == content.len();
        (whole && before[4..] == place.checksum(&content).to_le_bytes()).then_some(content)
    }
}

impl RecordSpan {
    fn checksum(self, content: &[u8]) -> u32 {
        let mut sum = crc32fast::Hasher::new();
        sum.update(&self.number.to_le_bytes());
        sum.update(&self.length.to_le_bytes());
        sum.update(content);
        sum.finalize()
    }
}

/// The contents of a log.
pub(super) struct Scan {
    /// Bytes up to the end of the last complete record.
    pub(super) end: u64,
    pub(super) records: u64,
    /// What is wrong with the bytes after it.
    pub(super) note: Option<Note>,
}

/// Shows the records of a log to `seen`, up to the first record that is incomplete or that `seen`
/// cannot read. In a log that is being written, these are all records before the last.
///
/// # Errors
/// If the file cannot be read, or is not the log for the header with this checksum.
pub(super) fn scan(
    path: &Path,
    file: &mut File,
    version: u32,
    header: u32,
    mut seen: impl FnMut(RecordSpan, &[u8]) -> bool,
) -> Result<Scan, CheckpointError> {
    let failed = |error: io::Error| CheckpointError::io(path, &error);
    let size = file.metadata().map_err(failed)?.len();
    let mut first = [0; PREAMBLE as usize];
    let read = read_at(file, 0, &mut first).map_err(failed)?;
    let magic = MAGIC.len();
    if read < first.len() || first[..magic] != MAGIC {
        return Err(foreign(path));
    }
    if first != preamble(version, header) {
        let reason = "its header is another one".to_owned();
        return Err(CheckpointError::Foreign { path: path.to_owned(), reason });
    }
    let mut scan = Scan { end: PREAMBLE, records: 0, note: None };
    let mut content = Vec::new();
    while scan.end < size {
        let left = size - scan.end;
        let mut before = [0; BEFORE as usize];
        let begun = left >= BEFORE && read_at(file, scan.end, &mut before).map_err(failed)? == before.len();
        let [a, b, c, d, ..] = before;
        let length = u32::from_le_bytes([a, b, c, d]);
        if !begun || u64::from(length) > left - BEFORE {
            scan.note = Some(Note::Torn { dropped: left });
            break;
        }
        let place = RecordSpan { number: scan.records, at: scan.end + BEFORE, length };
        content.resize(length as usize, 0);
        let whole = read_at(file, place.at, &mut content).map_err(failed)? == content.len();
        if !whole || before[4..] != place.checksum(&content).to_le_bytes() || !seen(place, &content) {
            scan.note = Some(Note::Damaged { at: scan.end, dropped: left });
            break;
        }
        scan.end = place.at + u64::from(length);
        scan.records += 1;
    }
    Ok(scan)
}

fn preamble(version: u32, header: u32) -> [u8; PREAMBLE as usize] {
    let mut bytes = [0; PREAMBLE as usize];
    let (magic, rest) = bytes.split_at_mut(MAGIC.len());
    magic.copy_from_slice(&MAGIC);
    rest[..4].copy_from_slice(&version.to_le_bytes());
    rest[4..].copy_from_slice(&header.to_le_bytes());
    bytes
}

fn foreign(path: &Path) -> CheckpointError {
    CheckpointError::Foreign { path: path.to_owned(), reason: "it does not begin as a log does".to_owned() }
}

#[cfg(test)]
#[path = "log_tests.rs"]
mod tests;
