//! Records by their numbers.

use super::place::{read_at, write_at};
use std::collections::BTreeMap;
use std::fs::File;

/// Bytes of a block, about, and blocks in memory at a time. Records are mostly used in their order.
const BLOCK: usize = 1 << 14;
const SLOTS: usize = 4;

/// Records of `width` bytes, all zero at first. What cannot be read from the file again is zero
/// too.
#[derive(Default)]
pub(crate) struct Records {
    width: usize,
    /// Records of a block.
    per_block: usize,
    /// Block `b` has its place in slot `b % SLOTS`.
    slots: [Slot; SLOTS],
    file: Option<File>,
    /// Blocks that could not be written.
    unwritten: BTreeMap<usize, Vec<u8>>,
    broken: bool,
}

/// A block in memory; none as long as there are no bytes.
#[derive(Default)]
struct Slot {
    block: usize,
    bytes: Vec<u8>,
    changed: bool,
}

impl Records {
    pub(crate) fn new(width: usize) -> Self {
        let per_block = (BLOCK / width.max(1)).max(1);
        Records { width, per_block, slots: Default::default(), file: None, unwritten: BTreeMap::new(), broken: false }
    }

    /// Records that lie beside each other.
    pub(crate) fn per_block(&self) -> usize {
        self.per_block
    }

    /// Whether some records could not be read from the file again.
    pub(crate) fn is_broken(&self) -> bool {
        self.broken
    }

    pub(crate) fn get(&mut self, number: usize) -> &[u8] {
        let at = (number % self.per_block) * self.width;
        let width = self.width;
        &self.slot(number / self.per_block).bytes[at..at + width]
    }

    pub(crate) fn set(&mut self, number: usize, record: &[u8]) {
        let at = (number % self.per_block) * self.width;
        let slot = self.slot(number / self.per_block);
        slot.bytes[at..at + record.len()].copy_from_slice(record);
        slot.changed = true;
    }

    /// The slot with a block in it.
    fn slot(&mut self, block: usize) -> &mut Slot {
        let place = block % SLOTS;
        if self.slots[place].bytes.is_empty() || self.slots[place].block != block {
            self.put_away(place);
            self.slots[place] = match self.unwritten.remove(&block) {
                // Still to be written.
                Some(bytes) => Slot { block, bytes, changed: true },
                None => Slot { block, bytes: self.fetch(block), changed: false },
            };
        }
        &mut self.slots[place]
    }

    fn length(&self) -> usize {
        self.per_block * self.width
    }

    fn put_away(&mut self, place: usize) {
        let length = self.length();
        let slot = &mut self.slots[place];
        if !slot.changed {
            return;
        }
        if self.file.is_none() {
            self.file = tempfile::tempfile().ok();
        }
        let at = slot.block as u64 * length as u64;
        let written = self.file.as_mut().is_some_and(|file| write_at(file, at, &slot.bytes).is_ok());
        if !written {
            self.unwritten.insert(slot.block, std::mem::take(&mut slot.bytes));
        }
    }

    fn fetch(&mut self, block: usize) -> Vec<u8> {
        let mut bytes = vec![0; self.length()];
        let at = block as u64 * bytes.len() as u64;
        let read = self.file.as_mut().map_or(Ok(0), |file| read_at(file, at, &mut bytes));
        if read.is_err() {
            self.broken = true;
            bytes.fill(0);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::{BLOCK, Records, SLOTS};
    use crate::random::{Random, Stream};
    use std::collections::BTreeMap;

    /// Against a map, for records that need four times the memory there is.
    #[test]
    fn records_are_what_was_written_last() {
        for width in [4, 12, 100] {
            let (mut records, mut expected) = (Records::new(width), BTreeMap::new());
            let count = 4 * SLOTS * (BLOCK / width);
            let mut random = Random::of(width as u64, Stream::Member(0));
            for step in 0..20_000usize {
                let number = ((random.unit().arg().abs() / 3.2 * count as f64) as usize).min(count - 1);
                let record: Vec<u8> = (0..width).map(|k| (number ^ (step * 31 + k)) as u8).collect();
                records.set(number, &record);
                expected.insert(number, record);
            }
            assert!(records.file.is_some() && records.unwritten.is_empty());
            let none = vec![0; width];
            for number in 0..count {
                assert_eq!(records.get(number), expected.get(&number).unwrap_or(&none), "{number}");
            }
        }
    }

    /// A changed block whose file cannot be written comes back from memory, also when it is changed
    /// again.
    #[test]
    fn without_a_file_records_stay_in_memory() {
        let mut records = Records::new(8);
        // Open for reading only.
        let path = tempfile::NamedTempFile::new().unwrap();
        records.file = Some(std::fs::File::open(path.path()).unwrap());
        let count = 8 * SLOTS * (BLOCK / 8);
        for round in 1..3u64 {
            for number in 0..count {
                records.set(number, &(round * number as u64).to_le_bytes());
            }
            for number in 0..count {
                assert_eq!(records.get(number), (round * number as u64).to_le_bytes());
            }
        }
        assert!(!records.unwritten.is_empty());
    }
}
