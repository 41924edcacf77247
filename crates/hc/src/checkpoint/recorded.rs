//! Work of the runner, recorded batch by batch.

use super::keeper::{Key, Part};
use crate::monitor::Monitor;
use crate::runner::{Flow, Round, Work};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::Cell;

/// Work whose closed batches can be recorded, and absorbed from a record.
pub(crate) trait Recordable: Work<Batch: Serialize + DeserializeOwned> {
    /// Whether a batch has the paths with these numbers.
    fn is_of(batch: &Self::Batch, numbers: &[usize]) -> bool;

    /// Paths that have ended at solutions so far.
    fn solutions(&self) -> u64;

    /// Whether batches are no longer complete.
    fn is_broken(&self) -> bool {
        false
    }
}

/// Work whose batches are read from a checkpoint, or recorded in it. Without a checkpoint the work
/// is unchanged.
///
/// A batch is a function of the numbers of its paths, of its round, and of what was absorbed
/// before. The first two are its key in the log. The last is the same whenever all batches before
/// are the same. A recorded batch can therefore be absorbed in place of a computed one.
pub(crate) struct Recorded<'a, W> {
    work: W,
    part: Option<Part<'a>>,
    monitor: &'a Monitor,
    /// Paths of this round.
    total: u64,
    /// The key under which to record the batch that was tracked last.
    new: Cell<Option<Key>>,
}

impl<'a, W: Recordable> Recorded<'a, W> {
    pub(crate) fn new(work: W, part: Option<Part<'a>>, monitor: &'a Monitor) -> Self {
        Recorded { work, part, monitor, total: 0, new: Cell::new(None) }
    }

    pub(crate) fn into_inner(self) -> W {
        self.work
    }
}

impl<W: Recordable> Work for Recorded<'_, W> {
    type Batch = W::Batch;
    type Memory = W::Memory;

    fn begin(&mut self, round: Round, count: usize) {
        self.total = count as u64;
        if let Some(part) = self.part {
            part.record(part.key(round, 0, 0), self.total, self.work.solutions(), &());
        }
        self.work.begin(round, count);
    }

    fn ahead(&self, numbers: &[usize]) {
        self.work.ahead(numbers);
    }

    fn batch(&self, memory: &mut W::Memory, numbers: &[usize], round: Round, batch: &mut W::Batch) {
        if let (Some(part), Some(&first)) = (self.part, numbers.first()) {
            let key = part.key(round, first, numbers.len());
            if let Some(recorded) = part.take(key, |batch| W::is_of(batch, numbers)) {
                *batch = recorded;
                return;
            }
            self.new.set(Some(key));
        }
        self.work.batch(memory, numbers, round, batch);
    }

    fn absorb(&mut self, batch: &mut W::Batch, round: Round) -> Flow {
        self.work.absorb(batch, round)
    }

    fn close(&mut self, memory: &mut W::Memory, batch: &mut W::Batch, round: Round) -> Flow {
        let flow = self.work.close(memory, batch, round);
        let Some(part) = self.part else { return flow };
        // What was cancelled half way is no batch.
        if let Some(key) = self.new.take()
            && !(self.monitor.is_cancelled() || self.work.is_broken())
        {
            part.record(key, self.total, self.work.solutions(), batch);
        }
        if part.checkpoint.failure().is_some() { Flow::Abandoned } else { flow }
    }

    fn doubtful(&mut self, memory: &mut W::Memory, which: &mut Vec<usize>) {
        self.work.doubtful(memory, which);
    }

    fn is_hopeless(&mut self, level: u32, before: usize, after: usize) -> bool {
        self.work.is_hopeless(level, before, after)
    }
}
