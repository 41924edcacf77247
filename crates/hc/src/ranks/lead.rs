//! Rank 0: it hands out portions, and receives the results.

use super::desk::Desk;
use super::error::RanksError;
use super::message::{Order, Portion, Report, decoded};
use super::run::{Answered, Ranks, TICK};
use crate::runner::Round;
use crate::threads::current_num_threads;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Rank 0 while it works at a job.
pub(crate) struct Lead<'a> {
    ranks: &'a Ranks<'a>,
    job: u64,
    fingerprint: &'a str,
    state: Mutex<LeadState>,
    changed: Condvar,
}

struct LeadState {
    desk: Desk,
    /// Parts that have begun.
    parts: u32,
    arrived: Vec<Arrived>,
    failure: Option<RanksError>,
}

/// What a rank has sent back.
pub(super) struct Arrived {
    pub(super) rank: usize,
    /// The paths that it was to track.
    pub(super) paths: Vec<usize>,
    pub(super) content: Vec<u8>,
}

impl<'a> Lead<'a> {
    /// Works at a job of this fingerprint with all other ranks. Another thread takes in messages
    /// meanwhile.
    pub(crate) fn at<T>(ranks: &'a Ranks<'a>, fingerprint: &'a str, work: impl FnOnce(&Lead<'a>) -> T) -> T {
        let desk = Desk::new(ranks.exchange.count(), current_num_threads(), ranks.options.patience);
        let state = LeadState { desk, parts: 0, arrived: Vec::new(), failure: None };
        let lead = Lead { ranks, job: ranks.begin(), fingerprint, state: Mutex::new(state), changed: Condvar::new() };
        let over = AtomicBool::new(false);
        std::thread::scope(|scope| {
            // The others go on to the next job, and the thread ends, after a panic too.
            let _end = OverAtEnd { lead: &lead, over: &over };
            scope.spawn(|| lead.listen(&over));
            work(&lead)
        })
    }

    fn state(&self) -> MutexGuard<'_, LeadState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a part of the job, which this describes to the others; each of its numbers stands for so
    /// many paths.
    pub(crate) fn begin_part(&self, content: &impl Serialize, weight: usize) {
        let Ok(content) = postcard::to_stdvec(content) else { return };
        let part = {
            let mut state = self.state();
            state.parts += 1;
            state.arrived.clear();
            state.desk.begin_part(weight);
            state.parts
        };
        self.ranks.to_all(&Order::Begin { job: self.job, part, content });
    }

    /// Begins a round of the part.
    pub(super) fn begin_round(&self, round: Round) {
        let mut state = self.state();
        state.arrived.clear();
        state.desk.begin_round(round);
    }

    /// Paths that are to be tracked, ascending, and those that will be next.
    pub(super) fn offer(&self, paths: &[usize], next: &[usize]) {
        let mut state = self.state();
        state.desk.offer(paths);
        let known = state.desk.horizon().min(next.len());
        state.desk.offer(&next[..known]);
        for rank in 1..self.ranks.exchange.count() {
            self.feed(&mut state, rank);
        }
    }

    /// How many paths to come are worth telling of.
    pub(super) fn horizon(&self) -> usize {
        self.state().desk.horizon()
    }

    /// A portion for this rank.
    pub(super) fn take(&self) -> Option<Portion> {
        self.state().desk.take(0, Instant::now())
    }

    /// Notes that this rank has tracked a portion; whether it was still wanted.
    pub(super) fn done(&self, portion: &Portion) -> bool {
        self.state().desk.answer(0, portion.number).is_some()
    }

    /// What has come back since the last call.
    pub(super) fn arrived(&self) -> Vec<Arrived> {
        std::mem::take(&mut self.state().arrived)
    }

    /// Waits until something has come back or is late, but not long.
    pub(super) fn wait(&self) {
        let state = self.state();
        if state.arrived.is_empty() && state.failure.is_none() {
            let late = state.desk.due().map_or(TICK, |due| due.saturating_duration_since(Instant::now()));
            // Nothing can be done at once about what is late and held by others.
            let wait = late.clamp(Duration::from_millis(1), TICK);
            drop(self.changed.wait_timeout(state, wait).unwrap_or_else(PoisonError::into_inner));
        }
    }

    /// Ends the work for this reason, unless there was one before.
    pub(super) fn fail(&self, error: RanksError) {
        self.state().failure.get_or_insert(error);
        self.changed.notify_all();
    }

    /// Why the work has to end.
    pub(crate) fn failure(&self) -> Option<RanksError> {
        self.state().failure.clone()
    }

    /// Sends a rank what it has room for.
    fn feed(&self, state: &mut LeadState, rank: usize) {
        while let Some(portion) = state.desk.take(rank, Instant::now()) {
            let order = Order::Track { job: self.job, part: state.parts, portion };
            if let Err(error) = self.ranks.send(rank, &order) {
                state.failure.get_or_insert(error);
                return;
            }
        }
    }

    fn listen(&self, over: &AtomicBool) {
        while !over.load(Ordering::Relaxed) {
            let result = match self.ranks.exchange.receive(TICK) {
                Ok(Some((rank, bytes))) => decoded(rank, &bytes).and_then(|report| self.hear(rank, report)),
                Ok(None) => Ok(()),
                Err(error) => {
                    self.fail(error.into());
                    return;
                }
            };
            if let Err(error) = result {
                self.fail(error);
            }
        }
    }

    /// Takes in a report. Those of earlier jobs and parts come too late.
    fn hear(&self, rank: usize, report: Report) -> Result<(), RanksError> {
        let mut state = self.state();
        match report {
            Report::Failed { job, message } if job >= self.job => return Err(RanksError::Failed { rank, message }),
            Report::Ready { job, part, threads, fingerprint } if (job, part) == (self.job, state.parts) => {
                if fingerprint != self.fingerprint {
                    return Err(RanksError::Differs { rank });
                }
                state.desk.ready(rank, threads);
                self.feed(&mut state, rank);
            }
            Report::Done { job, part, number, seconds, content } if (job, part) == (self.job, state.parts) => {
                if let Some(paths) = state.desk.answer(rank, number) {
                    self.ranks.note(Answered { rank, paths: paths.len(), seconds, bytes: content.len() });
                    state.arrived.push(Arrived { rank, paths, content });
                    self.changed.notify_all();
                }
                self.feed(&mut state, rank);
            }
            _ => {}
        }
        Ok(())
    }
}

/// Tells the others that a job is over.
struct OverAtEnd<'a> {
    lead: &'a Lead<'a>,
    over: &'a AtomicBool,
}

impl Drop for OverAtEnd<'_> {
    fn drop(&mut self) {
        self.over.store(true, Ordering::Relaxed);
        self.lead.ranks.to_all(&Order::Over { job: self.lead.job });
    }
}
