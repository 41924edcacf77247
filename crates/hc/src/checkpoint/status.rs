//! The progress of a run, from its checkpoint.

use super::error::CheckpointError;
use super::header::{FORMAT, Header};
use super::keeper::{HEADER, Head, LOCK, LOG};
use super::log::scan;
use serde::Serialize;
use std::fs::{File, TryLockError};
use std::path::Path;

/// The progress of a run that records its work.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Status {
    /// The kind of work: `solve`, `track` or `monodromy`.
    pub what: String,
    /// Whether a process records in the directory now.
    pub running: bool,
    /// The part of the work, from 1. For a solve this is the start system. For monodromy 1 is the
    /// search, 10 a start system for the same parameters, 2 the search with the solutions that it
    /// lacked, and from 3 on comes the trace test. Zero before the first part.
    pub part: u32,
    /// The round of this part, from 1: a solve first tracks all paths, then doubtful paths again.
    /// Zero before the first round.
    pub round: u32,
    /// Recorded paths of this round; or targets; or loops of this part, or steps of the trace test.
    pub done: u64,
    /// The total of these; `None` where it is not known.
    pub total: Option<u64>,
    /// Paths of this part that have ended at a solution so far; or solutions of all targets, or of
    /// the fibre.
    pub solutions: u64,
    /// Seconds of work up to the last record, including those of earlier processes.
    pub seconds: f64,
    /// Number of complete records.
    pub records: u64,
    /// Bytes of the log.
    pub bytes: u64,
}

/// The progress of the run that records its work in a directory. Nothing in the directory is
/// changed.
///
/// # Errors
/// If the directory has no checkpoint, or the checkpoint cannot be read.
pub fn status(directory: impl AsRef<Path>) -> Result<Status, CheckpointError> {
    let directory = directory.as_ref();
    let running = is_locked(directory)?;
    let (header, bytes) = Header::read(&directory.join(HEADER))?;
    let path = directory.join(LOG);
    let mut file = File::open(&path).map_err(|error| CheckpointError::io(&path, &error))?;
    let (mut last, mut done, mut round): (Option<Head>, u64, u32) = (None, 0, 0);
    let scan = scan(&path, &mut file, FORMAT, crc32fast::hash(&bytes), |_, record| {
        let Some((head, _)) = Head::of(record) else { return false };
        if !last.is_some_and(|last| last.key.is_of_round(head.key)) {
            done = 0;
            round = if last.is_some_and(|last| last.key.part() == head.key.part()) { round + 1 } else { 1 };
        }
        done += head.key.count;
        last = Some(head);
        true
    })?;
    Ok(Status {
        what: header.job.what,
        running,
        part: last.map_or(0, |last| last.key.part() + 1),
        round,
        done,
        total: last.map(|last| last.total).filter(|&total| total > 0),
        solutions: last.map_or(0, |last| last.solutions),
        seconds: last.map_or(0.0, |last| last.seconds),
        records: scan.records,
        bytes: scan.end,
    })
}

/// Whether somebody holds the lock of a directory.
fn is_locked(directory: &Path) -> Result<bool, CheckpointError> {
    let path = directory.join(LOCK);
    let file = File::open(&path).map_err(|error| CheckpointError::io(&path, &error))?;
    match file.try_lock_shared() {
        Ok(()) => Ok(false),
        Err(TryLockError::WouldBlock) => Ok(true),
        Err(TryLockError::Error(error)) => Err(CheckpointError::io(&path, &error)),
    }
}
