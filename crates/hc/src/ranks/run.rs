//! The ranks of a run, and how it ends.

use super::error::RanksError;
use super::exchange::{Exchange, ExchangeError};
use super::message::{Order, Report, decoded, encoded};
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// How long one waits for a message before looking whether the work has ended.
pub(super) const TICK: Duration = Duration::from_millis(20);

/// Settings of work on ranks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct RanksOptions {
    /// Time after which paths that a rank has not sent back are given to another rank; the first
    /// answer counts. Default 600 s.
    pub patience: Duration,
}

impl Default for RanksOptions {
    fn default() -> Self {
        RanksOptions { patience: Duration::from_secs(600) }
    }
}

impl RanksOptions {
    /// The defaults.
    pub fn new() -> RanksOptions {
        RanksOptions::default()
    }

    /// Sets [`patience`](Self::patience).
    #[must_use]
    pub fn patience(self, patience: Duration) -> Self {
        RanksOptions { patience }
    }
}

/// The ranks of a run, as one of them sees them. They do the same jobs one after the other.
pub struct Ranks<'a> {
    pub(super) exchange: &'a dyn Exchange,
    pub(super) options: RanksOptions,
    /// Jobs that have begun.
    jobs: AtomicU64,
    /// Whether rank 0 has said that there are no more jobs.
    pub(super) ended: AtomicBool,
    answered: Mutex<Vec<Answered>>,
}

/// A portion of paths, or other items, that another rank has sent back to rank 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Answered {
    /// That rank.
    pub rank: usize,
    /// Number of paths.
    pub paths: usize,
    /// Seconds that the rank took for them, on all its threads.
    pub seconds: f64,
    /// Length of the answer, without a head of a few bytes.
    pub bytes: usize,
}

impl fmt::Debug for Ranks<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ranks").field("rank", &self.exchange.rank()).field("count", &self.exchange.count()).finish()
    }
}

impl<'a> Ranks<'a> {
    /// The ranks between which `exchange` carries messages.
    pub fn new(exchange: &'a dyn Exchange, options: &RanksOptions) -> Ranks<'a> {
        Ranks {
            exchange,
            options: options.clone(),
            jobs: AtomicU64::new(0),
            ended: AtomicBool::new(false),
            answered: Mutex::default(),
        }
    }

    /// Whether this is rank 0, which has the results.
    pub fn is_lead(&self) -> bool {
        self.exchange.rank() == 0
    }

    /// The portions that other ranks have sent back to this rank, rank 0, in the order of arrival.
    /// They show how the work was divided, and a [`Desk`](super::Desk) of more ranks can be
    /// simulated from them. Each takes 32 bytes of memory.
    pub fn answered(&self) -> Vec<Answered> {
        self.answered.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub(super) fn note(&self, answered: Answered) {
        self.answered.lock().unwrap_or_else(PoisonError::into_inner).push(answered);
    }

    /// Ends the run: rank 0 releases the other ranks, which wait for this. `failure` says why this
    /// rank can do no more, if so; rank 0 then fails too, if it needs this rank.
    pub fn finish(&self, failure: Option<&str>) {
        if self.is_lead() {
            self.to_all(&Order::End);
            return;
        }
        if let Some(message) = failure {
            self.fail(self.jobs.load(Ordering::Relaxed) + 1, message);
        }
        while !self.ended.load(Ordering::Relaxed) {
            match self.exchange.receive(TICK) {
                Ok(Some((from, bytes))) => self.ended.store(self.is_end(from, &bytes), Ordering::Relaxed),
                Ok(None) => {}
                // Rank 0 is gone.
                Err(_) => return,
            }
        }
    }

    fn is_end(&self, from: usize, bytes: &[u8]) -> bool {
        decoded(from, bytes) == Ok(Order::End)
    }

    /// Tells rank 0 that this one cannot do a job.
    pub(super) fn fail(&self, job: u64, message: &str) {
        // Nobody is there to be told of a failure in this.
        let _ = self.send(0, &Report::Failed { job, message: message.to_owned() });
    }

    pub(super) fn send(&self, to: usize, message: &impl serde::Serialize) -> Result<(), RanksError> {
        let bytes = encoded(message).ok_or_else(|| ExchangeError("a message is too long".to_owned()))?;
        Ok(self.exchange.send(to, bytes)?)
    }

    /// Sends an order to all others; one that is gone needs none.
    pub(super) fn to_all(&self, order: &Order) {
        for rank in 1..self.exchange.count() {
            let _ = self.send(rank, order);
        }
    }

    /// The number of the job that begins.
    pub(super) fn begin(&self) -> u64 {
        self.jobs.fetch_add(1, Ordering::Relaxed) + 1
    }
}
