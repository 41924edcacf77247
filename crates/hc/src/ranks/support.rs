//! What tests of several ranks share.

use super::exchange::{Exchange, ExchangeError, Local};
use super::run::{Ranks, RanksOptions};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// An exchange of rank 0 that loses the first answers, and lets others overtake each other.
pub(crate) struct Faulty {
    local: Local,
    lost: AtomicUsize,
    answers: Arc<AtomicUsize>,
    held: Mutex<Vec<(Instant, usize, Vec<u8>)>>,
}

impl Faulty {
    pub(crate) fn new(local: Local, lost: usize) -> Faulty {
        Faulty { local, lost: AtomicUsize::new(lost), answers: Arc::default(), held: Mutex::default() }
    }
}

impl Faulty {
    /// How many answers have come, lost ones too.
    pub(crate) fn answers(&self) -> &Arc<AtomicUsize> {
        &self.answers
    }
}

impl Exchange for Faulty {
    fn count(&self) -> usize {
        self.local.count()
    }

    fn rank(&self) -> usize {
        self.local.rank()
    }

    fn send(&self, to: usize, message: Vec<u8>) -> Result<(), ExchangeError> {
        self.local.send(to, message)
    }

    fn receive(&self, wait: Duration) -> Result<Option<(usize, Vec<u8>)>, ExchangeError> {
        let mut held = self.held.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(k) = held.iter().position(|(due, ..)| *due <= Instant::now()) {
            let (_, rank, message) = held.swap_remove(k);
            return Ok(Some((rank, message)));
        }
        let received = self.local.receive(wait.min(Duration::from_millis(2)))?;
        let Some((rank, message)) = received else { return Ok(None) };
        // Answers are of the second kind of reports.
        if self.rank() > 0 || message.get(1) != Some(&1) {
            return Ok(Some((rank, message)));
        }
        self.answers.fetch_add(1, Ordering::Relaxed);
        if self.lost.load(Ordering::Relaxed) > 0 {
            self.lost.fetch_sub(1, Ordering::Relaxed);
        } else {
            let delay = Duration::from_millis(40 >> (held.len() % 4));
            held.push((Instant::now() + delay, rank, message));
        }
        Ok(None)
    }
}

/// Long enough that nothing is late.
pub(crate) const PATIENCE: Duration = Duration::from_secs(600);

/// Runs ranks, of one and two threads in turn.
pub(crate) fn on<X: Exchange, T: Send>(
    exchanges: &[X],
    patience: Duration,
    each: impl Fn(&Ranks<'_>) -> T + Sync,
) -> Vec<T> {
    std::thread::scope(|scope| {
        let rank = |exchange| {
            let each = &each;
            move || {
                let ranks = Ranks::new(exchange, &RanksOptions::new().patience(patience));
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1 + exchange.rank() % 2).build().unwrap();
                let found = pool.install(|| each(&ranks));
                ranks.finish(None);
                found
            }
        };
        let threads: Vec<_> = exchanges.iter().map(|exchange| scope.spawn(rank(exchange))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}
