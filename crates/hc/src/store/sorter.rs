//! Records in ascending order.

use super::place::{read_at, write_at};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::fs::File;
use std::io;

/// Bytes in memory before they are written to the file, in order.
const BUFFER: usize = 1 << 18;
/// Bytes of each run that are read at a time, about.
const READ: usize = 1 << 12;

/// Collects records of `width` bytes, which are compared byte by byte.
pub(crate) struct Sorter {
    width: usize,
    buffer: Vec<u8>,
    file: Option<File>,
    /// Where the runs in the file end.
    ends: Vec<u64>,
    /// Whether the file could not be written: everything else stays in memory.
    full: bool,
}

impl Sorter {
    pub(crate) fn new(width: usize) -> Self {
        Sorter { width: width.max(1), buffer: Vec::new(), file: None, ends: Vec::new(), full: false }
    }

    pub(crate) fn push(&mut self, record: &[u8]) {
        if self.buffer.len() + record.len() > BUFFER && !self.full {
            self.full = self.write().is_err();
        }
        self.buffer.extend_from_slice(record);
    }

    /// Writes the buffer as a run.
    fn write(&mut self) -> io::Result<()> {
        let run = ordered(&self.buffer, self.width);
        let mut file = match self.file.take() {
            Some(file) => file,
            None => tempfile::tempfile()?,
        };
        let start = self.ends.last().copied().unwrap_or(0);
        let written = write_at(&mut file, start, &run);
        self.file = Some(file);
        written?;
        self.ends.push(start + run.len() as u64);
        self.buffer.clear();
        Ok(())
    }

    /// The records of some sorters of one width in their order.
    pub(crate) fn merged(sorters: Vec<Sorter>) -> io::Result<Sorted> {
        let width = sorters.first().map_or(1, |sorter| sorter.width);
        let mut sorted = Sorted { width, files: Vec::new(), runs: Vec::new(), heap: BinaryHeap::new() };
        for sorter in sorters {
            let file = sorted.files.len();
            let mut from = 0;
            for &end in &sorter.ends {
                sorted.runs.push(SortedRun { file, from, end, bytes: Vec::new(), at: 0 });
                from = end;
            }
            let bytes = ordered(&sorter.buffer, sorter.width);
            sorted.runs.push(SortedRun { file, from: 0, end: 0, bytes, at: 0 });
            sorted.files.push(sorter.file);
        }
        for run in 0..sorted.runs.len() {
            sorted.advance(run)?;
        }
        Ok(sorted)
    }
}

fn ordered(records: &[u8], width: usize) -> Vec<u8> {
    let mut order: Vec<&[u8]> = records.chunks_exact(width).collect();
    order.sort_unstable();
    order.concat()
}

/// Records in ascending order, read as they are asked for.
pub(crate) struct Sorted {
    width: usize,
    /// One a sorter.
    files: Vec<Option<File>>,
    runs: Vec<SortedRun>,
    /// The next record of each run that has one.
    heap: BinaryHeap<Reverse<(Vec<u8>, usize)>>,
}

/// Records in order: `bytes` from `at` on, then what lies in a file.
struct SortedRun {
    file: usize,
    from: u64,
    end: u64,
    bytes: Vec<u8>,
    at: usize,
}

impl Sorted {
    /// The next record.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub(crate) fn next(&mut self) -> io::Result<Option<Vec<u8>>> {
        let Some(Reverse((record, run))) = self.heap.pop() else { return Ok(None) };
        self.advance(run)?;
        Ok(Some(record))
    }

    /// Brings the next record of a run into the heap.
    fn advance(&mut self, number: usize) -> io::Result<()> {
        let run = &mut self.runs[number];
        if run.at == run.bytes.len() {
            run.fill(self.files[run.file].as_mut(), self.width)?;
        }
        if run.at < run.bytes.len() {
            let record = run.bytes[run.at..run.at + self.width].to_vec();
            run.at += self.width;
            self.heap.push(Reverse((record, number)));
        }
        Ok(())
    }
}

impl SortedRun {
    fn fill(&mut self, file: Option<&mut File>, width: usize) -> io::Result<()> {
        let length = (self.end - self.from).min((READ / width).max(1) as u64 * width as u64) as usize;
        self.bytes.resize(length, 0);
        self.at = 0;
        let read = file.map_or(Ok(0), |file| read_at(file, self.from, &mut self.bytes))?;
        self.from += length as u64;
        if read < length { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::{BUFFER, Sorter};
    use crate::random::{Random, Stream};

    /// Against the sort in memory, for records of several sorters that need several runs each, and
    /// for none.
    #[test]
    fn all_records_come_back_in_order() {
        for (width, count) in [(20, 0), (20, 3), (20, 3 * BUFFER / 20), (96, 2 * BUFFER / 96 + 1)] {
            let mut random = Random::of(count as u64, Stream::Member(0));
            let mut sorters = vec![Sorter::new(width), Sorter::new(width)];
            let mut expected = Vec::new();
            for k in 0..count {
                let bits = random.unit().re.to_bits();
                let record: Vec<u8> = bits.to_be_bytes().into_iter().cycle().skip(6).take(width).collect();
                sorters[usize::from(k % 3 == 0)].push(&record);
                expected.push(record);
            }
            expected.sort();
            let mut sorted = Sorter::merged(sorters).unwrap();
            let found: Vec<Vec<u8>> = std::iter::from_fn(|| sorted.next().unwrap()).collect();
            assert_eq!(found, expected);
        }
    }

    /// A file that cannot be written.
    #[test]
    fn without_a_file_all_records_stay_in_memory() {
        let mut sorter = Sorter::new(8);
        let path = tempfile::NamedTempFile::new().unwrap();
        sorter.file = Some(std::fs::File::open(path.path()).unwrap());
        let count = 3 * BUFFER as u64 / 8;
        for k in (0..count).rev() {
            sorter.push(&k.to_be_bytes());
        }
        assert!(sorter.full && sorter.ends.is_empty());
        let mut sorted = Sorter::merged(vec![sorter]).unwrap();
        assert!(
            (0..count).all(|k| sorted.next().unwrap().unwrap() == k.to_be_bytes()) && sorted.next().unwrap().is_none()
        );
    }
}
