//! The transport of messages between ranks.

use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// The transport of messages between the processes (or threads) of one run, which are numbered:
/// MPI, or [channels](Local) within a process.
///
/// Messages from one rank to another arrive whole and in the order in which they were sent.
pub trait Exchange: Sync {
    /// The number of ranks, at least 1.
    fn count(&self) -> usize;

    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Sends a message, without waiting until it is received.
    ///
    /// # Errors
    /// If there is no such rank, or nothing more can be sent.
    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), ExchangeError>;

    /// The next message from any rank, with the number of that rank; `None` if none comes within
    /// this time. Called from one thread at a time.
    ///
    /// # Errors
    /// If nothing more can be received.
    fn receive(&self, wait: Duration) -> Result<Option<(usize, Vec<u8>)>, ExchangeError>;
}

/// Why messages are no longer carried.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ExchangeError(
    /// The reason.
    pub String,
);

/// Ranks in one process, each on a thread of its own.
#[derive(Debug)]
pub struct Local {
    rank: usize,
    others: Vec<Sender<(usize, Vec<u8>)>>,
    own: Mutex<Receiver<(usize, Vec<u8>)>>,
}

impl Local {
    /// This many ranks.
    pub fn ranks(count: usize) -> Vec<Local> {
        let (others, own): (Vec<_>, Vec<_>) = (0..count).map(|_| channel()).unzip();
        let local = |(rank, own)| Local { rank, others: others.clone(), own: Mutex::new(own) };
        own.into_iter().enumerate().map(local).collect()
    }
}

impl Exchange for Local {
    fn count(&self) -> usize {
        self.others.len()
    }

    fn rank(&self) -> usize {
        self.rank
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), ExchangeError> {
        let other = self.others.get(to).ok_or_else(|| ExchangeError(format!("there is no rank {to}")))?;
        other.send((self.rank, message)).map_err(|_| ExchangeError(format!("rank {to} is gone")))
    }

    fn receive(&self, wait: Duration) -> Result<Option<(usize, Vec<u8>)>, ExchangeError> {
        match self.own.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(wait) {
            Ok(message) => Ok(Some(message)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(ExchangeError("the other ranks are gone".to_owned())),
        }
    }
}
