//! Bytes of a recording, in order, with a look ahead: pipes can be read as well as files.

use std::collections::VecDeque;
use std::io::{self, BufReader, ErrorKind, Read};

use crate::error::ReadError;

/// The bytes of a recording.
pub(crate) struct Input {
    /// What the recording is called in messages.
    pub(crate) file: String,
    reader: BufReader<Box<dyn Read + Send>>,
    /// What has been looked at and not yet read.
    ahead: VecDeque<u8>,
    /// Number of bytes that have been read.
    position: u64,
    /// Number of bytes, where it is known.
    length: Option<u64>,
}

impl Input {
    pub(crate) fn new(file: String, reader: Box<dyn Read + Send>, length: Option<u64>) -> Input {
        Input { file, reader: BufReader::with_capacity(1 << 16, reader), ahead: VecDeque::new(), position: 0, length }
    }

    /// Number of bytes that have been read.
    pub(crate) fn position(&self) -> u64 {
        self.position
    }

    /// Number of bytes that are left, where it is known.
    pub(crate) fn remaining(&self) -> Option<u64> {
        self.length.map(|length| length.saturating_sub(self.position))
    }

    /// The next bytes, fewer only at the end, which remain to be read.
    pub(crate) fn look_ahead(&mut self, count: usize) -> Result<&[u8], ReadError> {
        while self.ahead.len() < count {
            let mut byte = [0];
            match self.reader.read(&mut byte) {
                Ok(0) => break,
                Ok(_) => self.ahead.push_back(byte[0]),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(ReadError::Io { file: self.file.clone(), source }),
            }
        }
        let there = count.min(self.ahead.len());
        Ok(&self.ahead.make_contiguous()[..there])
    }

    /// Fills a buffer as far as there are bytes, and says how far.
    pub(crate) fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, ReadError> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.read(&mut buffer[filled..]) {
                Ok(0) => break,
                Ok(count) => filled += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(ReadError::Io { file: self.file.clone(), source }),
            }
        }
        Ok(filled)
    }

    /// This many bytes, or `None` if there are fewer.
    pub(crate) fn array<const N: usize>(&mut self) -> Result<Option<[u8; N]>, ReadError> {
        let mut bytes = [0; N];
        Ok((self.fill(&mut bytes)? == N).then_some(bytes))
    }

    /// Leaves out this many bytes, or what is there of them.
    pub(crate) fn skip(&mut self, count: u64) -> Result<(), ReadError> {
        let copied = io::copy(&mut self.by_ref().take(count), &mut io::sink());
        copied.map(|_| ()).map_err(|source| ReadError::Io { file: self.file.clone(), source })
    }

    /// The error for a header that is cut off, or contradicts itself.
    pub(crate) fn bad_header(&self, problem: impl Into<String>) -> ReadError {
        ReadError::Header { file: self.file.clone(), problem: problem.into() }
    }
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = if self.ahead.is_empty() { self.reader.read(buffer)? } else { self.ahead.read(buffer)? };
        self.position = self.position.saturating_add(count as u64);
        Ok(count)
    }
}
