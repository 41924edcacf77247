//! Messages on their way between the work and MPI.

use hc::ranks::{Exchange, ExchangeError};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A message, and the rank that it goes to or comes from.
pub(super) type Addressed = (usize, Vec<u8>);

/// What the work sends to and receives from.
pub(super) struct Carrier {
    rank: usize,
    count: usize,
    out: Sender<Addressed>,
    arrived: Mutex<Receiver<Addressed>>,
}

/// What MPI takes messages from and brings them to.
pub(super) struct Station {
    pub(super) out: Receiver<Addressed>,
    pub(super) arrived: Sender<Addressed>,
}

/// Both sides, for a rank of so many.
pub(super) fn both(rank: usize, count: usize) -> (Carrier, Station) {
    let (to_station, out) = channel();
    let (arrived, from_station) = channel();
    (Carrier { rank, count, out: to_station, arrived: Mutex::new(from_station) }, Station { out, arrived })
}

impl Exchange for Carrier {
    fn count(&self) -> usize {
        self.count
    }

    fn rank(&self) -> usize {
        self.rank
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), ExchangeError> {
        if to >= self.count {
            return Err(ExchangeError(format!("there is no rank {to}")));
        }
        self.out.send((to, message)).map_err(|_| gone())
    }

    fn receive(&self, wait: Duration) -> Result<Option<Addressed>, ExchangeError> {
        match self.arrived.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(wait) {
            Ok(message) => Ok(Some(message)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(gone()),
        }
    }
}

fn gone() -> ExchangeError {
    ExchangeError("MPI has ended".to_owned())
}
