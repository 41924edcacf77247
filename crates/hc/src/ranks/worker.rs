//! All other ranks: they make start systems, and track the portions that they get.

use super::error::RanksError;
use super::message::{Order, Portion, Report, decoded};
use super::run::{Ranks, TICK};
use crate::monitor::Monitor;
use crate::runner::Round;
use crate::threads::current_num_threads;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::cell::RefCell;
use std::fmt::Display;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

/// How long a rank waits to hear why rank 0 takes no message any more.
const PARTING: Duration = Duration::from_secs(2);

/// A rank but the first while it works at a job.
pub(crate) struct Worker<'a> {
    ranks: &'a Ranks<'a>,
    job: u64,
    fingerprint: &'a str,
    monitor: Monitor,
    heard: Receiver<Result<Heard, RanksError>>,
    /// A part that began while another was worked at.
    next: RefCell<Option<Begun>>,
}

/// What the thread that listens to rank 0 passes on; nothing more once the job is over.
enum Heard {
    Begun(Begun),
    Portion(u32, Portion),
}

/// A part that has begun.
struct Begun {
    number: u32,
    content: Vec<u8>,
    /// Cancelled when the next part begins, or the job is over.
    monitor: Monitor,
}

/// A part of a job.
pub(crate) struct Task<T> {
    number: u32,
    /// What rank 0 says of it.
    pub(crate) content: T,
    /// Cancelled as soon as rank 0 needs nothing more of it.
    pub(crate) monitor: Monitor,
}

impl Worker<'_> {
    /// Works on the job with this fingerprint for rank 0, and reports errors to it.
    pub(crate) fn at<T, E: Display>(
        ranks: &Ranks<'_>,
        fingerprint: &str,
        work: impl FnOnce(&Worker<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        let (job, monitor, done) = (ranks.begin(), Monitor::watched(), AtomicBool::new(false));
        let (to, heard) = channel();
        let found = std::thread::scope(|scope| {
            let _end = Done(&done);
            let (done, whole) = (&done, monitor.clone());
            scope.spawn(move || Listener { ranks, job, whole, to }.listen(done));
            work(&Worker { ranks, job, fingerprint, monitor, heard, next: RefCell::new(None) })
        });
        if let Err(error) = &found {
            ranks.fail(job, &error.to_string());
        }
        found
    }

    /// Cancelled once the job is over.
    pub(crate) fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// Waits for the next part of the job; `None` once it is over.
    pub(crate) fn next<T: DeserializeOwned>(&self) -> Result<Option<Task<T>>, RanksError> {
        let mut begun = self.next.take();
        while begun.is_none() {
            match self.heard.recv() {
                Err(_) => return Ok(None),
                Ok(Ok(Heard::Begun(part))) => begun = Some(part),
                // This portion belongs to a part that is over.
                Ok(Ok(Heard::Portion(..))) => {}
                Ok(Err(error)) => return Err(error),
            }
        }
        let Some(Begun { number, content, monitor }) = begun else { return Ok(None) };
        let content = postcard::from_bytes(&content);
        let content = content.map_err(|error| RanksError::Message { rank: 0, reason: error.to_string() })?;
        Ok(Some(Task { number, content, monitor }))
    }

    /// Sends rank 0 a report; false where that is gone because the job is over: it needed no more.
    fn tell(&self, report: &Report) -> Result<bool, RanksError> {
        let Err(error) = self.ranks.send(0, report) else { return Ok(true) };
        loop {
            match self.heard.recv_timeout(PARTING) {
                Ok(heard) => drop(heard?),
                Err(RecvTimeoutError::Disconnected) => return Ok(false),
                Err(RecvTimeoutError::Timeout) => return Err(error),
            }
        }
    }

    /// Tracks the portions of a part that rank 0 sends, until it needs no more.
    pub(crate) fn serve<T, A: Serialize>(
        &self,
        task: &Task<T>,
        track: impl Fn(&[usize], Round) -> A,
    ) -> Result<(), RanksError> {
        let (job, part) = (self.job, task.number);
        let fingerprint = self.fingerprint.to_owned();
        let ready = Report::Ready { job, part, threads: current_num_threads(), fingerprint };
        if !self.tell(&ready)? {
            return Ok(());
        }
        while let Ok(heard) = self.heard.recv() {
            match heard? {
                Heard::Begun(next) => {
                    self.next.replace(Some(next));
                    return Ok(());
                }
                Heard::Portion(of, portion) if of == part => {
                    let begun = Instant::now();
                    let answer = track(&portion.paths, portion.round);
                    let seconds = begun.elapsed().as_secs_f64();
                    // What was cancelled half way is no answer.
                    if !task.monitor.is_cancelled() {
                        let content = postcard::to_stdvec(&answer).unwrap_or_default();
                        let number = portion.number;
                        if !self.tell(&Report::Done { job, part, number, seconds, content })? {
                            return Ok(());
                        }
                    }
                }
                Heard::Portion(..) => {}
            }
        }
        Ok(())
    }
}

/// Listens to rank 0.
struct Listener<'a> {
    ranks: &'a Ranks<'a>,
    job: u64,
    /// Cancels the whole job.
    whole: Monitor,
    to: Sender<Result<Heard, RanksError>>,
}

impl Listener<'_> {
    /// Passes on what concerns the job until that is over or `done`.
    fn listen(self, done: &AtomicBool) {
        let mut part = Monitor::watched();
        while !done.load(Ordering::Relaxed) {
            let order = match self.ranks.exchange.receive(TICK) {
                Ok(None) => continue,
                Ok(Some((rank, bytes))) => decoded(rank, &bytes),
                Err(error) => Err(error.into()),
            };
            let passed = match order {
                Ok(Order::End) => {
                    self.ranks.ended.store(true, Ordering::Relaxed);
                    break;
                }
                Ok(Order::Over { job }) if job == self.job => break,
                Ok(Order::Begin { job, part: number, content }) if job == self.job => {
                    part.cancel();
                    part = Monitor::watched();
                    self.to.send(Ok(Heard::Begun(Begun { number, content, monitor: part.clone() })))
                }
                Ok(Order::Track { job, part, portion }) if job == self.job => {
                    self.to.send(Ok(Heard::Portion(part, portion)))
                }
                Ok(_) => Ok(()),
                Err(error) => {
                    let _ = self.to.send(Err(error));
                    break;
                }
            };
            // The work has ended with an error of its own.
            if passed.is_err() {
                break;
            }
        }
        part.cancel();
        self.whole.cancel();
    }
}

/// Tells a thread that there is nothing more to listen for.
struct Done<'a>(&'a AtomicBool);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
