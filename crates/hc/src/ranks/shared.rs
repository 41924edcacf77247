//! Work of the runner in which other ranks take part.

use super::error::RanksError;
use super::lead::{Arrived, Lead};
use crate::checkpoint::Recordable;
use crate::monitor::Monitor;
use crate::runner::{Flow, Round, Work};
use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// Work whose paths can be tracked anywhere.
pub(crate) trait Shareable: Work {
    /// What is sent back of a path.
    type End: DeserializeOwned;

    /// Tracks the paths with these numbers as far as can be: their ends in the same order, or none
    /// once the work is cancelled. The end of a path depends on its number and the round alone.
    fn ends(&self, numbers: &[usize], round: Round) -> Vec<Self::End>;

    /// Whether it is the end of a path with this number.
    fn is_end(&self, end: &Self::End, number: usize) -> bool;

    /// Makes a batch of ends, in the order of their paths.
    fn gather(&self, ends: Vec<Self::End>, batch: &mut Self::Batch);

    /// Told how many paths of a batch have ended.
    fn reached(&self, _paths: usize) {}
}

/// Work whose batches are tracked by all ranks, from the view of rank 0; as it is without others.
pub(crate) struct DividedWork<'a, W: Shareable> {
    work: W,
    lead: Option<&'a Lead<'a>>,
    monitor: &'a Monitor,
    /// Ends of paths of this batch and later ones.
    ends: RefCell<BTreeMap<usize, W::End>>,
    /// Paths that come after those of the batch.
    next: RefCell<Vec<usize>>,
}

impl<'a, W: Shareable> DividedWork<'a, W> {
    pub(crate) fn new(work: W, lead: Option<&'a Lead<'a>>, monitor: &'a Monitor) -> Self {
        DividedWork { work, lead, monitor, ends: RefCell::default(), next: RefCell::default() }
    }

    pub(crate) fn into_inner(self) -> W {
        self.work
    }

    /// The ends of these paths, in their order, by all ranks; those that there are when the work is
    /// cancelled, or a rank fails.
    fn collected(&self, lead: &Lead<'_>, numbers: &[usize], round: Round) -> Vec<W::End> {
        lead.offer(numbers, &self.next.borrow());
        let mut ends = self.ends.borrow_mut();
        loop {
            for arrived in lead.arrived() {
                if let Err(error) = self.accept(arrived, &mut ends) {
                    lead.fail(error);
                }
            }
            let there = numbers.iter().filter(|number| ends.contains_key(number)).count();
            self.work.reached(there);
            if there == numbers.len() || self.monitor.is_cancelled() || lead.failure().is_some() {
                return numbers.iter().filter_map(|number| ends.remove(number)).collect();
            }
            let Some(portion) = lead.take() else {
                lead.wait();
                continue;
            };
            let own = self.work.ends(&portion.paths, round);
            if lead.done(&portion) {
                ends.extend(portion.paths.iter().copied().zip(own));
            }
        }
    }

    /// Takes in what a rank has sent.
    fn accept(&self, arrived: Arrived, ends: &mut BTreeMap<usize, W::End>) -> Result<(), RanksError> {
        let Arrived { rank, paths, content } = arrived;
        let refused = |reason: String| RanksError::Message { rank, reason };
        let sent: Vec<W::End> = postcard::from_bytes(&content).map_err(|error| refused(error.to_string()))?;
        let fits = sent.len() == paths.len() && sent.iter().zip(&paths).all(|(end, &path)| self.work.is_end(end, path));
        if !fits {
            return Err(refused("ends of other paths than those that it was to track".to_owned()));
        }
        ends.extend(paths.into_iter().zip(sent));
        Ok(())
    }
}

impl<W: Shareable> Work for DividedWork<'_, W> {
    type Batch = W::Batch;
    type Memory = W::Memory;

    fn begin(&mut self, round: Round, count: usize) {
        if let Some(lead) = self.lead {
            lead.begin_round(round);
            self.ends.get_mut().clear();
        }
        self.work.begin(round, count);
    }

    fn ahead(&self, numbers: &[usize]) {
        if let Some(lead) = self.lead {
            let mut next = self.next.borrow_mut();
            next.clear();
            next.extend_from_slice(&numbers[..numbers.len().min(lead.horizon())]);
        }
    }

    fn batch(&self, memory: &mut W::Memory, numbers: &[usize], round: Round, batch: &mut W::Batch) {
        match self.lead {
            Some(lead) => self.work.gather(self.collected(lead, numbers, round), batch),
            None => self.work.batch(memory, numbers, round, batch),
        }
    }

    fn absorb(&mut self, batch: &mut W::Batch, round: Round) -> Flow {
        self.work.absorb(batch, round)
    }

    fn close(&mut self, memory: &mut W::Memory, batch: &mut W::Batch, round: Round) -> Flow {
        if self.has_failed() {
            return Flow::Abandoned;
        }
        self.work.close(memory, batch, round)
    }

    fn doubtful(&mut self, memory: &mut W::Memory, which: &mut Vec<usize>) {
        self.work.doubtful(memory, which);
    }

    fn is_hopeless(&mut self, level: u32, before: usize, after: usize) -> bool {
        self.work.is_hopeless(level, before, after)
    }
}

impl<W: Shareable> DividedWork<'_, W> {
    fn has_failed(&self) -> bool {
        self.lead.is_some_and(|lead| lead.failure().is_some())
    }
}

impl<W: Shareable + Recordable> Recordable for DividedWork<'_, W> {
    fn is_of(batch: &W::Batch, numbers: &[usize]) -> bool {
        W::is_of(batch, numbers)
    }

    fn solutions(&self) -> u64 {
        self.work.solutions()
    }

    fn is_broken(&self) -> bool {
        self.has_failed()
    }
}
